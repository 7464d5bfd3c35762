//! Looking for a node of the graph: by its name, its type, what stands there, or its remark. What is chosen is gone to.

use super::chooser::{Chooser, Chosen, Entries};
use crate::model::Model;
use crate::model::catalog::letters_in_order;
use crate::theme;
use eframe::egui::{Pos2, Rect, Response, RichText, Sense, Ui, vec2};

/// So many letters of a text are looked at.
const WORDS: usize = 300;

/// What came of a frame of the search.
pub enum Sought {
    /// It stays open.
    Open,
    /// It was closed.
    Closed,
    /// The node of this name.
    Node(String),
}

/// A search that is open.
#[derive(Default)]
pub struct Search {
    chooser: Chooser,
}

/// A node that has what was typed.
struct Hit<'a> {
    id: &'a str,
    title: String,
    category: String,
    /// Its remark or its text.
    words: &'a str,
}

struct Hits<'a>(Vec<Hit<'a>>);

impl Entries for Hits<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn row(&self, ui: &mut Ui, entry: usize, chosen: bool) -> Response {
        let hit = &self.0[entry];
        let row = ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
            ui.painter().circle_filled(
                rect.center(),
                4.0,
                theme::category_colour(&hit.category, &theme::Theme::of(ui)),
            );
            let label = ui.selectable_label(chosen, hit.id);
            ui.label(RichText::new(&hit.title).weak().small());
            label
        });
        row.inner
    }

    fn about(&self, entry: usize) -> Option<&str> {
        self.0.get(entry).map(|hit| hit.words).filter(|words| !words.is_empty())
    }
}

/// How far a node is from what was typed, in small letters; none if it has nothing of it.
fn rank(hit: &Hit<'_>, type_name: &str, typed: &str) -> Option<u32> {
    let (id, title) = (hit.id.to_lowercase(), hit.title.to_lowercase());
    match typed {
        _ if id == typed => Some(0),
        _ if id.starts_with(typed) => Some(1),
        _ if id.contains(typed) => Some(2),
        _ if title.contains(typed) || type_name.contains(typed) => Some(3),
        _ if hit.words.to_lowercase().contains(typed) => Some(4),
        _ if letters_in_order(typed, &id) => Some(5),
        _ => None,
    }
}

impl Search {
    /// The nodes on the canvas that have what was typed, the nearest first; all of them before anything is. O(nodes).
    fn hits<'a>(&self, model: &'a Model) -> Hits<'a> {
        let typed = self.chooser.typed.trim().to_lowercase();
        let all = model.document().nodes().iter().filter_map(|(id, node)| {
            let info = model.catalog.of(node);
            // Of notes and of texts what they say.
            let text = ["text", "value"].into_iter().find_map(|port| node.params.get(port)?.as_str());
            let words = node.more.note.as_deref().or(text).unwrap_or_default();
            // A whole program may stand there.
            let end = words.char_indices().nth(WORDS).map_or(words.len(), |(end, _)| end);
            let words = &words[..end];
            let hit = Hit { id, title: info.title.clone(), category: info.category.clone(), words };
            rank(&hit, &info.type_name.to_lowercase(), &typed).map(|rank| (rank, hit))
        });
        let mut all: Vec<_> = all.collect();
        // Equally near ones stay in the order of their names.
        all.sort_by_key(|(rank, _)| *rank);
        Hits(all.into_iter().map(|(_, hit)| hit).collect())
    }

    /// Shows it in the middle of the canvas.
    pub fn show(&mut self, ui: &Ui, area: Rect, model: &Model) -> Sought {
        let hits = self.hits(model);
        let at = Pos2::new(area.center().x - 160.0, area.top() + 40.0);
        match self.chooser.show(ui, area, at, "look for a node of this graph", &hits) {
            Chosen::Open => Sought::Open,
            Chosen::Closed => Sought::Closed,
            Chosen::Entry(i) => hits.0.get(i).map_or(Sought::Closed, |hit| Sought::Node(hit.id.to_owned())),
        }
    }
}
