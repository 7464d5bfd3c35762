//! Reading the files that clusters are linked from, and the paths between them. Files come through the host; links in
//! linked files are followed without recursion, each file once.

use super::cluster::{Cluster, LinkedFile};
use super::model::Document;
use crate::evaluate::session::Host;
use crate::value::digest_bytes;
use std::collections::BTreeMap;
use std::sync::Arc;

/// No graph links to more files than this, directly and through others.
const MOST_FILES: usize = 1000;

impl Document {
    /// Reads the files that clusters are linked from, and those that they link to. What cannot be read is told when the
    /// graph is validated or evaluated, and keeps only instances of those clusters from running. Files whose bytes are
    /// the same as before are not parsed again. O(bytes of all linked files).
    pub fn read_links(&mut self, host: &dyn Host) {
        let old = std::mem::take(&mut self.linked.0);
        let mut open: Vec<String> = self.links("");
        let mut read = BTreeMap::new();
        while let Some(path) = open.pop() {
            if read.contains_key(&path) {
                continue;
            }
            let file = if read.len() < MOST_FILES {
                read_file(&path, host, old.get(&path).and_then(|f| f.as_ref().ok()))
            } else {
                Err(format!("the graph links to more than {MOST_FILES} files"))
            };
            if let Ok(file) = &file {
                open.extend(file.document.links(folder_of(&path)));
            }
            read.insert(path, file);
        }
        self.linked.0 = read;
    }

    /// Paths of the files that this document links to; it lies in `folder`.
    fn links(&self, folder: &str) -> Vec<String> {
        let links = self.clusters.values().filter_map(|cluster| match cluster {
            Cluster::File(link) => Some(join(folder, &link.file)),
            Cluster::Here(_) => None,
        });
        links.collect()
    }

    /// Pins every link of this document to the version and the digest of the file as it was last read; gives the names
    /// of the clusters whose pins have changed. Links to files that could not be read stay as they are.
    pub fn update_links(&mut self) -> Vec<String> {
        let mut changed = Vec::new();
        for (name, cluster) in &mut self.clusters {
            let Cluster::File(link) = cluster else { continue };
            let Some(Ok(file)) = self.linked.0.get(&join("", &link.file)) else { continue };
            let pins = (Some(file.document.interface_version()), Some(file.digest.clone()));
            if (link.version, &link.digest) != (pins.0, &pins.1) {
                (link.version, link.digest) = pins;
                changed.push(name.clone());
            }
        }
        changed
    }

    /// The linked files that could not be read, and why.
    pub fn unread_links(&self) -> impl Iterator<Item = (&str, &str)> {
        self.linked.0.iter().filter_map(|(path, file)| Some((path.as_str(), file.as_ref().err()?.as_str())))
    }
}

fn read_file(path: &str, host: &dyn Host, before: Option<&Arc<LinkedFile>>) -> Result<Arc<LinkedFile>, String> {
    let bytes = host.read(path).map_err(|e| e.to_string())?;
    let digest = digest_bytes(&bytes);
    if let Some(same) = before.filter(|f| f.bytes == digest) {
        return Ok(same.clone());
    }
    let document = Document::from_slice(&bytes).map_err(|wrong| {
        let first = wrong.first().map_or_else(String::new, |d| d.message.clone());
        let more = if wrong.len() > 1 { format!(", and {} more faults", wrong.len() - 1) } else { String::new() };
        format!("it is not a readable graph: {first}{more}")
    })?;
    Ok(Arc::new(LinkedFile { bytes: digest, digest: document.digest(), document }))
}

/// The folder of a file, with a slash at its end; empty if it names none.
pub(crate) fn folder_of(file: &str) -> &str {
    file.rfind('/').map_or("", |slash| &file[..=slash])
}

/// A path as seen from `folder`, without `.` and with as few `..` as can be.
pub(crate) fn join(folder: &str, file: &str) -> String {
    let drive = file.get(1..3).is_some_and(|c| c == ":/" || c == ":\\");
    let whole = if file.starts_with('/') || drive { file.to_owned() } else { format!("{folder}{file}") };
    let mut parts: Vec<&str> = Vec::new();
    for part in whole.split('/') {
        match part {
            "." => {}
            "" if !parts.is_empty() => {}
            ".." if parts.last().is_some_and(|p| !p.is_empty() && *p != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_joined_from_the_folder_of_the_file_that_names_them() {
        assert_eq!(join("", "./a.json"), "a.json");
        assert_eq!(join("lib/", "../b/./c.json"), "b/c.json");
        assert_eq!(join("../lib/", "../c.json"), "../c.json");
        assert_eq!(join("lib/", "/abs//c.json"), "/abs/c.json");
        assert_eq!(join("lib/", "C:/c.json"), "C:/c.json");
        assert_eq!((folder_of("lib/a.json"), folder_of("a.json")), ("lib/", ""));
    }
}
