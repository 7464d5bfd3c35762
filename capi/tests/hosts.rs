//! Hosts in C and C++ against the library that was just built, plain, under AddressSanitizer and under valgrind. Each checks
//! everything itself.

use std::env::consts::{DLL_EXTENSION, EXE_EXTENSION};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, Once, PoisonError};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The folder that holds the shared library: that of this test or one above it.
fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let name = format!("{}tenon{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let folder = test.ancestors().skip(1).take(2).find(|f| f.join(&name).exists());
    folder.unwrap_or_else(|| panic!("no {name} near {}", test.display())).to_owned()
}

/// Compiles a host with all warnings as errors, once however many tests run it, and gives the program.
#[track_caller]
fn compile(source: &str, extra: &[&str]) -> PathBuf {
    let (compiler, standard) = if source.ends_with(".cpp") { ("c++", "-std=c++17") } else { ("cc", "-std=c11") };
    let name = format!("{}{}", source.replace('.', "_"), extra.join(""));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    if made.contains(&program) {
        return program;
    }
    let library = library();
    let done = Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-g", "-O1"])
        .args(extra)
        .arg("-I")
        .arg(root().join("capi/include"))
        .arg("-I")
        .arg(root().join("plugin-sdk/include"))
        .arg(root().join("tests/hosts").join(source))
        .arg("-o")
        .arg(&program)
        .arg("-L")
        .arg(&library)
        .args(["-ltenon", "-lm", "-lpthread"])
        .arg(format!("-Wl,-rpath,{}", library.display()))
        .output()
        .unwrap();
    assert!(done.status.success(), "{source}: {}", String::from_utf8_lossy(&done.stderr));
    made.push(program.clone());
    program
}

/// Compiles an example of a plugin in C.
#[track_caller]
fn plugin(source: &str, library: &Path, extra: &[&str]) {
    let done = Command::new("cc")
        .args(["-std=c11", "-shared", "-fPIC", "-pthread"])
        .args(extra)
        .arg("-I")
        .arg(root().join("plugin-sdk/include"))
        .arg(root().join("plugin-sdk/examples").join(source))
        .arg("-o")
        .arg(library)
        .arg("-lm")
        .output()
        .unwrap();
    assert!(done.status.success(), "{source}: {}", String::from_utf8_lossy(&done.stderr));
}

/// The plugins that a host looks for, and the program that runs them in processes of their own.
fn prepare(command: &mut Command) {
    static MADE: Once = Once::new();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("host-plugins");
    let [hinges, doomed] = ["hinges/hinges", "doomed"].map(|n| folder.join(n).with_extension(DLL_EXTENSION));
    // Beside the library that is tested.
    let place = library();
    let place = place.ancestors().take(2).find(|f| f.ends_with("debug") || f.ends_with("release")).unwrap().to_owned();
    MADE.call_once(|| {
        std::fs::create_dir_all(folder.join("hinges")).unwrap();
        plugin("fastener-c/hinge.c", &hinges, &[]);
        plugin("misbehaving-c/misbehaving.c", &doomed, &["-DLOADABLE"]);
        // Tests of the whole workspace have built it before; those of this package alone have not.
        if !place.join("tenon").with_extension(EXE_EXTENSION).exists() {
            let mut cargo = Command::new(env!("CARGO"));
            cargo.args(["build", "--quiet", "-p", "tenon", "--target-dir"]).arg(place.parent().unwrap());
            cargo.args(place.ends_with("release").then_some("--release"));
            assert!(cargo.current_dir(root()).status().unwrap().success());
        }
    });
    command.env("HINGES", hinges).env("DOOMED", doomed).env("FOLDER", folder.join("hinges"));
    command.env("TENON_PLUGIN_HOST", place.join("tenon").with_extension(EXE_EXTENSION));
    // What the user's own folders hold is of no matter here.
    command.env_remove("TENON_PLUGIN_PATH").env_remove("TENON_PLUGIN_ISOLATION");
}

/// Runs a host on the graph of 256 panels; it checks everything itself and gives 0 when all is well.
#[track_caller]
fn run(mut command: Command) -> String {
    // cargo names a folder before this one in which an older library may lie, and that goes before what is linked.
    command.env("LD_LIBRARY_PATH", library());
    let done = command.arg(root().join("graphs/shell-256/shell-256.tenon.json")).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{command:?}: {}\n{out}\n{err}", done.status);
    out.into_owned()
}

#[test]
fn a_c_host_moves_a_control_point_a_hundred_times() {
    let out = run(Command::new(compile("host.c", &[])));
    assert!(out.contains("256 panels"), "{out}");
}

#[test]
fn a_cpp_host_owns_what_it_gets() {
    let out = run(Command::new(compile("host.cpp", &[])));
    assert!(out.contains("256 panels"), "{out}");
}

#[test]
fn jobs_are_of_the_graph_as_it_was() {
    assert!(run(Command::new(compile("jobs.c", &[]))).contains("in order"));
}

#[test]
fn values_go_in_and_out_without_a_copy() {
    let out = run(Command::new(compile("values.c", &[])));
    assert!(out.contains("for 256 panels"), "{out}");
}

#[test]
fn plugins_are_as_each_graph_requires_them() {
    let mut command = Command::new(compile("plugins.c", &[]));
    prepare(&mut command);
    assert!(run(command).contains("where they should be"));
}

const HOSTS: [&str; 5] = ["host.c", "host.cpp", "jobs.c", "plugins.c", "values.c"];

#[test]
fn all_hosts_are_clean_under_address_sanitizer() {
    for source in HOSTS {
        let mut command = Command::new(compile(source, &["-fsanitize=address,undefined"]));
        prepare(&mut command);
        command.env("ASAN_OPTIONS", "detect_leaks=1:halt_on_error=1").env("UBSAN_OPTIONS", "halt_on_error=1");
        run(command);
    }
}

#[test]
fn all_hosts_are_clean_under_valgrind() {
    for source in HOSTS {
        let mut command = Command::new("valgrind");
        command.args(["--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=definite,indirect"]);
        // Its threads take turns, or one that waits for another may wait for minutes.
        command.args(["--errors-for-leak-kinds=definite,indirect", "--fair-sched=try"]);
        // Few moves, if nobody asks for more: every instruction is watched.
        command.arg(compile(source, &[])).env("MOVES", std::env::var("TENON_MOVES").unwrap_or_else(|_| "5".into()));
        prepare(&mut command);
        // It refuses to seal shared memory, through which plugins in processes of their own are spoken to.
        command.env_remove("TENON_PLUGIN_HOST");
        run(command);
    }
}
