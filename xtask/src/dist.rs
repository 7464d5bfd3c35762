//! `cargo xtask dist`: everything that people use, laid out as it is installed. Nothing in it knows where it lies.

use crate::root;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What libtenon.a needs of the system, as `rustc --print native-static-libs` says it for Linux.
const SYSTEM: &str = "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc";

const PKG_CONFIG: &str = "\
prefix=${pcfiledir}/../..
libdir=${prefix}/lib
includedir=${prefix}/include/tenon

Name: tenon
Description: Graphs for free-form timber in other programs
Version: @VERSION@
Cflags: -I${includedir}
Libs: -L${libdir} -ltenon
Libs.private: @SYSTEM@
";

const CMAKE: &str = "\
# tenon::tenon is the shared library, tenon::static the other one.
get_filename_component(tenon_prefix \"${CMAKE_CURRENT_LIST_DIR}/../../..\" ABSOLUTE)
foreach(kind SHARED STATIC)
  if(kind STREQUAL SHARED)
    set(tenon_target tenon::tenon)
    set(tenon_file \"${CMAKE_SHARED_LIBRARY_PREFIX}tenon${CMAKE_SHARED_LIBRARY_SUFFIX}\")
  else()
    set(tenon_target tenon::static)
    set(tenon_file \"${CMAKE_STATIC_LIBRARY_PREFIX}tenon${CMAKE_STATIC_LIBRARY_SUFFIX}\")
  endif()
  if(NOT TARGET ${tenon_target})
    add_library(${tenon_target} ${kind} IMPORTED)
    set_target_properties(${tenon_target} PROPERTIES
      IMPORTED_LOCATION \"${tenon_prefix}/lib/${tenon_file}\"
      IMPORTED_NO_SONAME TRUE
      INTERFACE_INCLUDE_DIRECTORIES \"${tenon_prefix}/include/tenon\")
  endif()
endforeach()
if(UNIX)
  set_target_properties(tenon::static PROPERTIES INTERFACE_LINK_LIBRARIES \"@SYSTEM@\")
endif()
unset(tenon_prefix)
unset(tenon_target)
unset(tenon_file)
set(tenon_FOUND TRUE)
";

const CMAKE_VERSION: &str = "\
set(PACKAGE_VERSION \"@VERSION@\")
if(PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
  set(PACKAGE_VERSION_EXACT TRUE)
endif()
";

/// Where cargo builds.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Calls cargo in the repository.
pub fn cargo(arguments: &[&str]) -> Result<(), String> {
    call(Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())).args(arguments))
}

fn call(command: &mut Command) -> Result<(), String> {
    match command.current_dir(root()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(e) => Err(format!("{command:?}: {e}")),
    }
}

/// Builds and lays out `target/dist/tenon-VERSION`, anew; without the editor if `editor` is false.
pub fn run(editor: bool) -> Result<(), String> {
    // With what builds it: the features of what they share are then those of this program, and nothing is built twice.
    let mut build = vec!["build", "--release", "--quiet", "-p", "tenon", "-p", "tenon-capi", "-p", "xtask"];
    if editor {
        build.extend(["-p", "tenon-editor"]);
    }
    cargo(&build)?;
    let place = target().join("dist").join(format!("tenon-{VERSION}"));
    if place.exists() {
        fs::remove_dir_all(&place).map_err(|e| format!("{}: {e}", place.display()))?;
    }
    let from = target().join("release");
    let library = |prefix: &str, suffix: &str| format!("{prefix}tenon{suffix}");
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX, EXE_SUFFIX};
    let archive = if cfg!(windows) { library("", ".lib") } else { library("lib", ".a") };
    copy(&from.join(library("", EXE_SUFFIX)), &place.join("bin"))?;
    if editor {
        copy(&from.join(format!("tenon-editor{EXE_SUFFIX}")), &place.join("bin"))?;
    }
    for file in [library(DLL_PREFIX, DLL_SUFFIX), archive] {
        copy(&from.join(file), &place.join("lib"))?;
    }
    for header in ["capi/include/tenon.h", "plugin-sdk/include/tenon_value.h", "plugin-sdk/include/tenon_plugin.h"] {
        copy(&root().join(header), &place.join("include/tenon"))?;
    }
    for (file, text) in [
        ("lib/pkgconfig/tenon.pc", PKG_CONFIG),
        ("lib/cmake/tenon/tenon-config.cmake", CMAKE),
        ("lib/cmake/tenon/tenon-config-version.cmake", CMAKE_VERSION),
    ] {
        let system = if file.ends_with(".cmake") { SYSTEM.replace(' ', ";") } else { SYSTEM.to_owned() };
        write(&place.join(file), &text.replace("@VERSION@", VERSION).replace("@SYSTEM@", &system))?;
    }
    let share = place.join("share/tenon");
    copy_all(&root().join("docs"), &share.join("docs"))?;
    copy_all(&root().join("graphs"), &share.join("graphs"))?;
    crate::sdk::lay_out(&share.join("plugin-sdk"))?;
    // The wheel holds the same library.
    let mut wheel = Command::new("python3");
    let library = place.join("lib").join(library(DLL_PREFIX, DLL_SUFFIX));
    call(wheel.arg("python/build_wheel.py").arg(share.join("python")).arg(library))?;
    println!("{}", place.display());
    Ok(())
}

/// Writes a file, and the folder around it.
pub fn write(file: &Path, text: &str) -> Result<(), String> {
    let make = || {
        fs::create_dir_all(file.parent().unwrap_or(file))?;
        fs::write(file, text)
    };
    make().map_err(|e| format!("{}: {e}", file.display()))
}

/// Copies a file into a folder.
fn copy(file: &Path, folder: &Path) -> Result<(), String> {
    let name = file.file_name().ok_or_else(|| format!("{} is no file", file.display()))?;
    let make = || {
        fs::create_dir_all(folder)?;
        fs::copy(file, folder.join(name)).map(|_| ())
    };
    make().map_err(|e: std::io::Error| format!("{} into {}: {e}", file.display(), folder.display()))
}

/// Copies what is in a folder, folders in it included.
pub fn copy_all(from: &Path, to: &Path) -> Result<(), String> {
    let at = |e: std::io::Error| format!("{}: {e}", from.display());
    for entry in fs::read_dir(from).map_err(at)? {
        let path = entry.map_err(at)?.path();
        match (path.is_dir(), path.file_name()) {
            (true, Some(name)) => copy_all(&path, &to.join(name))?,
            _ => copy(&path, to)?,
        }
    }
    Ok(())
}
