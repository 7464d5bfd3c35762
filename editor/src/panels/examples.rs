//! In which of the example graphs a node is used, and what it stands among there: to be opened, or put into the graph.

use crate::model::beside::Beside;
use crate::model::file;
use eframe::egui::{CollapsingHeader, Ui};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tenon_engine::{Cluster, Document};

/// Most examples that are offered of one node.
const MOST: usize = 6;

/// The folder of the examples: beside the program, above it, or where it was started.
#[must_use]
pub fn folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let above = program.iter().flat_map(|p| p.ancestors().skip(1).take(4)).map(Path::to_owned);
    above
        .chain(std::env::current_dir().ok())
        .map(|p| p.join("graphs"))
        .find(|p| file::find(&p.join("shell-256")).is_ok())
}

/// What is to be done with an example.
#[derive(Debug)]
pub enum Shown {
    /// It is opened.
    Open(PathBuf),
    /// A piece of it is put into the graph.
    Insert(Box<Document>),
}

/// A node of an example.
#[derive(Clone, Debug, PartialEq)]
struct Place {
    /// The example's file.
    path: PathBuf,
    /// The node's id there.
    node: String,
    /// How many nodes the example has.
    nodes: usize,
}

/// Where nodes of each type are used.
type Places = BTreeMap<String, Vec<Place>>;

/// The same, read beside the window when it is first asked for.
#[derive(Default)]
pub struct Examples {
    found: Beside<Places>,
}

impl Place {
    /// What the example is called.
    fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        name.strip_suffix(file::ENDING).unwrap_or(&name).to_owned()
    }
}

/// What lies in a folder; nothing if it cannot be read.
fn inside(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    folder.read_dir().into_iter().flatten().flatten().map(|e| e.path())
}

/// The graphs in the folders of a folder: one by one, or many small ones together.
fn read(folder: Option<PathBuf>) -> Places {
    let mut found = Places::new();
    let is_graph = |p: &PathBuf| p.to_str().is_some_and(|p| p.ends_with(file::ENDING));
    for path in folder.iter().flat_map(|f| inside(f)).flat_map(|f| inside(&f)).filter(is_graph) {
        let Ok((document, _)) = file::load(&path) else { continue };
        let nodes = document.nodes().len();
        for (id, node) in document.nodes() {
            let all = found.entry(node.type_name.to_string()).or_default();
            // One node of a type per example is enough.
            if all.last().is_none_or(|p| p.path != path) {
                all.push(Place { path: path.clone(), node: id.clone(), nodes });
            }
        }
    }
    // Small ones are understood first.
    found.values_mut().for_each(|all| all.sort_by(|a, b| (a.nodes, &a.path).cmp(&(b.nodes, &b.path))));
    found
}

/// A node of an example with the nodes that lead directly to it, and what they have from others left out.
fn piece(place: &Place) -> Option<Document> {
    let (document, _) = file::load(&place.path).ok()?;
    let node = document.nodes().get(&place.node)?;
    let sources = node.inputs.values().flat_map(|w| &w.from).filter_map(|f| f.split_once('.')).map(|(id, _)| id);
    let mut ids: Vec<&str> = sources.filter(|id| document.nodes().contains_key(*id)).collect();
    ids.push(&place.node);
    ids.sort_unstable();
    ids.dedup();
    // Definitions of other files would not be found from here.
    let linked = |c: &Cluster| matches!(c, Cluster::File(_));
    document.copy(&ids).ok().filter(|fragment| !fragment.clusters.values().any(linked))
}

impl Examples {
    /// Takes what was read.
    pub fn poll(&mut self) {
        self.found.poll();
    }

    /// Whether nothing is being read.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.found.settled()
    }

    /// Offers the examples of a type; gives what was chosen.
    pub fn show(&mut self, ui: &mut Ui, type_name: &str) -> Option<Shown> {
        let mut chosen = None;
        let header = CollapsingHeader::new("Examples").id_salt("examples of a node").default_open(false);
        header.show(ui, |ui| {
            let ctx = ui.ctx().clone();
            self.found.want(0, move || ctx.request_repaint(), || read(folder()));
            if self.found.failed() {
                ui.weak("The example graphs could not be read.");
                return;
            }
            let Some(found) = self.found.now() else {
                ui.weak("The example graphs are being read …");
                return;
            };
            let all = found.get(type_name).map_or(&[][..], Vec::as_slice);
            if all.is_empty() {
                ui.weak("None of the example graphs uses it.");
            }
            for place in all.iter().take(MOST) {
                let name = place.name();
                ui.horizontal(|ui| {
                    ui.label(format!("{} in {name}, {} nodes", place.node, place.nodes));
                    if ui.small_button("Open").on_hover_text(format!("open {name}")).clicked() {
                        chosen = Some(Shown::Open(place.path.clone()));
                    }
                    let hint = "put it into this graph with the nodes that lead to it";
                    if ui.small_button("Insert").on_hover_text(hint).clicked() {
                        chosen = piece(place).map(|fragment| Shown::Insert(Box::new(fragment)));
                    }
                });
            }
        });
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graphs() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs")
    }

    #[test]
    fn examples_are_found_by_node_and_give_a_piece_of_themselves() {
        let found = read(Some(graphs()));
        let all = &found["thicken"];
        assert!(all.windows(2).all(|w| w[0].nodes <= w[1].nodes));
        assert!(all[0].path.ends_with("nodes/joints.tenon.json"), "small ones stand first: {all:?}");
        let shell = all.iter().find(|p| p.name() == "shell-256").unwrap();
        let piece = piece(shell).unwrap();
        assert!(piece.nodes().contains_key("thicken") && piece.nodes().len() > 1, "{:?}", piece.nodes().keys());
        assert!(read(None).is_empty());
    }

    #[test]
    fn every_node_has_an_example_and_a_piece_of_it() {
        let found = read(Some(graphs()));
        for node in tenon_nodes::registry().iter() {
            let name = node.type_name();
            let place = found.get(name).and_then(|all| all.first()).unwrap_or_else(|| panic!("{name} has no example"));
            let piece = piece(place).unwrap_or_else(|| panic!("{name}: nothing of {place:?} can be put into a graph"));
            let there = &piece.nodes()[&place.node];
            assert_eq!(there.type_name.as_str(), name);
            assert!(there.inputs.is_empty() || piece.nodes().len() > 1, "{name}: what leads to it comes along");
        }
    }
}
