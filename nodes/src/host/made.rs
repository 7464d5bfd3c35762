//! The files that a graph makes: where they go, and which of them may have their final names.

use super::output::{self, Staged, WriteError};
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use tenon_engine::{Diagnostic, File};

/// Ending of a file that may not have its final name.
const WITHHELD: &str = ".unproven";

/// Ending of an earlier run's file that does not belong to this one.
const STALE: &str = ".stale";

/// Names of the files that the last run has left in a folder under their final names, one per line.
const MANIFEST: &str = ".tenon-files";

/// A file that a node has made.
#[derive(Debug)]
pub struct Made {
    /// `node.port` of the writer.
    pub from: String,
    /// What it made.
    pub file: File,
    /// Its final name in the output folder, if there is one.
    target: Option<PathBuf>,
    /// Whether it may not have that name.
    pub withheld: bool,
}

impl Made {
    /// Where it is written.
    #[must_use]
    pub fn path(&self) -> Option<PathBuf> {
        let target = self.target.clone()?;
        Some(if self.withheld { with_ending(&target, WITHHELD) } else { target })
    }

    /// Why it does not get its final name, if it does not.
    #[must_use]
    pub fn diagnostic(&self) -> Option<Diagnostic> {
        let why = self.file.withheld.as_deref().filter(|_| self.withheld)?;
        let (node, port) = self.from.split_once('.').unwrap_or((&self.from, ""));
        let message = format!("{} does not get its final name: {why}", self.file.name);
        let hint = "--unproven gives it its name all the same";
        Some(Diagnostic::error("withheld", message).at(node).port(port).hint(hint))
    }
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Stages the writers' files in the folder `out`, withheld ones under a name that says so, unless the user insists.
///
/// # Errors
/// A name that leads out of the folder, two files of one name, a folder that cannot be written.
pub fn stage(
    staged: &mut Staged,
    files: Vec<(String, File)>,
    out: Option<&Path>,
    insist: bool,
) -> Result<Vec<Made>, WriteError> {
    let mut taken: HashMap<PathBuf, String> = HashMap::new();
    let mut all = Vec::with_capacity(files.len());
    for (from, file) in files {
        let withheld = file.withheld.is_some() && !insist;
        let target = out.map(|dir| output::inside(dir, &file.name)).transpose()?;
        let made = Made { from, file, target, withheld };
        if let Some(path) = made.path() {
            if let Some(other) = taken.insert(path.clone(), made.from.clone()) {
                return Err(WriteError::SameName { path, first: other, second: made.from });
            }
            staged.add(&path, &made.file.bytes)?;
        }
        all.push(made);
    }
    Ok(all)
}

/// Gives everything staged its name. Files in the folder `out` that an earlier run has left and this one does not
/// make, or may not give their final names, belong to another design and must not pass for this one's: they are set
/// aside under another name. A file that has its final name needs no unproven one beside it.
///
/// Earlier files that this run makes anew are set aside first, too, and removed at the end: whenever the program is
/// killed, all files under final names are of one run. Half of a new set of boards among the other half of the old one
/// looks like a set.
///
/// Returns what was set aside, by its old name.
///
/// # Errors
/// If a file cannot be renamed.
pub fn commit(mut staged: Staged, made: &[Made], out: Option<&Path>) -> Result<Vec<PathBuf>, WriteError> {
    let final_names: BTreeSet<&Path> =
        made.iter().filter(|m| !m.withheld).filter_map(|m| m.target.as_deref()).collect();
    let mut others: BTreeSet<PathBuf> = made.iter().filter(|m| m.withheld).filter_map(|m| m.target.clone()).collect();
    if let Some(dir) = out {
        others.extend(earlier(dir));
        let names: Vec<&str> = made.iter().filter(|m| !m.withheld).map(|m| &*m.file.name).collect();
        staged.add(&dir.join(MANIFEST), format!("{}\n", names.join("\n")).as_bytes())?;
    }
    others.retain(|path| path.is_file() && !final_names.contains(path.as_path()));
    // A file alone is no set: it is replaced in one step.
    let replaced: Vec<&Path> =
        if final_names.len() > 1 { final_names.iter().copied().filter(|p| p.is_file()).collect() } else { Vec::new() };
    for path in others.iter().map(PathBuf::as_path).chain(replaced.iter().copied()) {
        let io = |error| WriteError::Io { path: path.to_owned(), error };
        std::fs::rename(path, with_ending(path, STALE)).map_err(io)?;
    }
    staged.commit()?;
    for path in replaced {
        let _ = std::fs::remove_file(with_ending(path, STALE));
    }
    for target in final_names {
        // Usually there is none.
        let _ = std::fs::remove_file(with_ending(target, WITHHELD));
    }
    Ok(others.into_iter().collect())
}

/// The files that the last run has left in the folder `dir` under their final names, as its manifest says.
fn earlier(dir: &Path) -> Vec<PathBuf> {
    let manifest = std::fs::read_to_string(dir.join(MANIFEST)).unwrap_or_default();
    manifest.lines().filter_map(|name| output::inside(dir, name).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("tenon-files-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        dir
    }

    fn program(text: &str, withheld: Option<&str>) -> Vec<(String, File)> {
        let file = File { name: "b.ngc".into(), bytes: text.as_bytes().into(), withheld: withheld.map(Into::into) };
        vec![("gcode.files".to_owned(), file)]
    }

    fn write(dir: &Path, files: Vec<(String, File)>, insist: bool) -> Vec<Made> {
        let mut staged = Staged::default();
        let made = stage(&mut staged, files, Some(dir), insist).unwrap();
        commit(staged, &made, Some(dir)).unwrap();
        made
    }

    fn names(dir: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|n| n != MANIFEST);
        names.sort();
        names
    }

    #[test]
    fn a_withheld_program_has_another_name_and_says_why() {
        let dir = folder("withheld");
        let made = write(&dir, program("G0", Some("part 1.2 is gouged by 0.3 mm")), false);
        assert_eq!(names(&dir), ["b.ngc.unproven"]);
        let diagnostic = made[0].diagnostic().unwrap();
        assert_eq!((diagnostic.node.as_deref(), diagnostic.port.as_deref()), (Some("gcode"), Some("files")));
        assert!(diagnostic.message.contains("gouged by 0.3 mm"));
        // An earlier unproven one goes when the program has been proven.
        let made = write(&dir, program("G1", None), false);
        assert_eq!(names(&dir), ["b.ngc"]);
        assert!(made[0].diagnostic().is_none());
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn who_insists_gets_the_name() {
        let dir = folder("insist");
        let made = write(&dir, program("G0", Some("no proof")), true);
        assert_eq!(names(&dir), ["b.ngc"]);
        assert!(made[0].diagnostic().is_none());
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn an_earlier_proven_program_does_not_pass_for_the_new_one() {
        let dir = folder("stale");
        write(&dir, program("old", None), false);
        write(&dir, program("new", Some("no proof")), false);
        assert_eq!(names(&dir), ["b.ngc.stale", "b.ngc.unproven"]);
        assert_eq!(fs::read(dir.join("b.ngc.stale")).unwrap(), b"old");
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn what_an_earlier_run_has_left_does_not_pass_for_this_one() {
        let dir = folder("fewer");
        let named = |name: &str| {
            let file = File { name: name.into(), bytes: name.as_bytes().into(), withheld: None };
            ("gcode.files".to_owned(), file)
        };
        fs::write(dir.join("notes.txt"), "of a person").unwrap();
        write(&dir, vec![named("a"), named("b")], false);
        write(&dir, vec![named("a")], false);
        assert_eq!(names(&dir), ["a", "b.stale", "notes.txt"]);
        // A manifest that names what is not ours moves nothing outside.
        fs::write(dir.join(MANIFEST), "../b\n/etc/hostname\n\nnever\n").unwrap();
        write(&dir, vec![named("a")], false);
        assert_eq!(names(&dir), ["a", "b.stale", "notes.txt"]);
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn two_files_of_one_name_are_refused_and_nothing_is_written() {
        let dir = folder("twice");
        let twice = [program("a", None), program("b", None)].concat();
        let mut staged = Staged::default();
        let wrong = stage(&mut staged, twice, Some(&dir), false).unwrap_err();
        assert!(matches!(wrong, WriteError::SameName { .. }), "{wrong}");
        drop(staged);
        assert!(names(&dir).is_empty());
        fs::remove_dir_all(&dir).unwrap();
    }
}
