//! Groups: fields behind their nodes, with a title that is taken, typed and coloured.

use super::paint::Paint;
use super::shape::Shapes;
use crate::model::Model;
use crate::theme;
use eframe::egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, StrokeKind, Ui, vec2};
use tenon_engine::{Document, Json, Operation};

/// Height of the strip with the title, canvas points.
const STRIP: f32 = 26.0;

/// Colours that the menu offers.
pub const COLOURS: [(&str, &str); 7] = [
    ("Violet", "#a082be"),
    ("Blue", "#569cd6"),
    ("Green", "#78be5a"),
    ("Yellow", "#d6c04e"),
    ("Orange", "#de9e50"),
    ("Red", "#d65c5c"),
    ("Grey", "#969aa2"),
];

/// The operation that groups the selected nodes.
pub fn group(model: &Model) -> Operation {
    let taken = |n: &str| model.document().groups.contains_key(n);
    let name = (1u64..).map(|n| format!("group {n}")).find(|n| !taken(n)).unwrap_or_default();
    Operation::SetGroup { name, nodes: Some(model.selection.iter().cloned().collect()) }
}

/// A group that consists of just what is selected.
pub fn of_selection(model: &Model) -> Option<String> {
    let is_it = |name: &&String| {
        let members: std::collections::BTreeSet<&str> = members(model.document(), name).collect();
        !members.is_empty()
            && members.len() == model.selection.len()
            && members.iter().all(|m| model.selection.contains(*m))
    };
    model.document().groups.keys().find(is_it).cloned()
}

/// The operation that takes the selected nodes out of all groups; a group that is left without nodes is dissolved. None if
/// there is nothing to do.
pub fn ungroup(model: &Model) -> Option<Operation> {
    let document = model.document();
    let all = document.groups.keys().filter_map(|name| {
        let all: Vec<&str> = members(document, name).collect();
        let left: Vec<String> =
            all.iter().filter(|m| !model.selection.contains(**m)).map(|m| (*m).to_owned()).collect();
        let nodes = (!left.is_empty()).then_some(left.clone());
        (left.len() < all.len()).then(|| Operation::SetGroup { name: name.clone(), nodes })
    });
    let all: Vec<Operation> = all.collect();
    (!all.is_empty()).then_some(Operation::All(all))
}

/// Ids of the nodes of a group.
pub fn members<'a>(document: &'a Document, name: &str) -> impl Iterator<Item = &'a str> {
    let nodes = document.groups.get(name).and_then(|g| g.get("nodes")).and_then(Json::as_array);
    nodes.into_iter().flatten().filter_map(Json::as_str)
}

/// What is written over a group.
pub fn title<'a>(document: &'a Document, name: &'a str) -> &'a str {
    document.groups.get(name).and_then(|g| g.get("title")).and_then(Json::as_str).unwrap_or(name)
}

fn colour(document: &Document, name: &str) -> Color32 {
    let said = document.groups.get(name).and_then(|g| g.get("colour")).and_then(Json::as_str);
    said.and_then(|c| Color32::from_hex(c).ok()).unwrap_or(theme::type_colour("layout"))
}

/// The field of a group around its nodes, as `rect` says where they are; none if none of them is there.
fn field<'a>(members: impl Iterator<Item = &'a str>, rect: impl Fn(&str) -> Option<Rect>) -> Option<Rect> {
    let bounds = members.filter_map(rect).reduce(Rect::union)?;
    Some(Rect::from_min_max(bounds.min - vec2(14.0, 14.0 + STRIP), bounds.max + vec2(14.0, 14.0)))
}

/// The strip with the title of a group, canvas points.
pub fn strip(document: &Document, shapes: &Shapes, name: &str) -> Option<Rect> {
    let rect = |id: &str| shapes.find(id).map(|n| shapes.nodes[n].rect);
    let mut field = field(members(document, name), rect)?;
    field.set_height(STRIP);
    Some(field)
}

/// The group whose strip lies under a place. O(nodes in groups).
pub fn at(document: &Document, shapes: &Shapes, p: Pos2) -> Option<usize> {
    document.groups.keys().position(|name| strip(document, shapes, name).is_some_and(|r| r.contains(p)))
}

/// Paints all groups.
pub fn paint(p: &Paint, shapes: &Shapes) {
    let document = p.model.document();
    for name in document.groups.keys() {
        let rect = |id: &str| shapes.find(id).map(|n| p.moved(&shapes.nodes[n]));
        let Some(bounds) = field(members(document, name), rect) else { continue };
        let rect = p.view.rect_to_screen(p.area, bounds);
        if !rect.intersects(p.area) {
            continue;
        }
        let colour = colour(document, name);
        p.painter.rect(rect, 6.0, colour.gamma_multiply(0.18), Stroke::new(1.0, colour), StrokeKind::Inside);
        let mut strip = rect;
        strip.set_height(STRIP * p.view.zoom);
        p.painter.rect_filled(strip.shrink(1.0), 5.0, colour.gamma_multiply(0.25));
        let size = 14.0 * p.view.zoom;
        if size > 4.0 {
            let at = strip.left_center() + vec2(8.0, 0.0) * p.view.zoom;
            let clip = p.painter.with_clip_rect(strip.intersect(p.painter.clip_rect()));
            let font = FontId::proportional(size.round());
            clip.text(at, Align2::LEFT_CENTER, title(document, name), font, p.theme.text);
        }
    }
}

/// The menu of a group; gives what is to be done.
pub fn menu(ui: &mut Ui, model: &mut Model, name: &str, rename: &mut bool) -> Option<Operation> {
    let mut operation = None;
    ui.strong(title(model.document(), name));
    if ui.button("Title …").clicked() {
        *rename = true;
        ui.close();
    }
    ui.menu_button("Colour", |ui| {
        for (words, hex) in COLOURS {
            let button = ui.horizontal(|ui| {
                let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), eframe::egui::Sense::hover());
                ui.painter().rect_filled(rect, 3.0, Color32::from_hex(hex).unwrap_or_default());
                ui.button(words)
            });
            if button.inner.clicked() {
                operation = Some(model.set_in_group(name, "colour", Some(hex.into())));
                ui.close();
            }
        }
    });
    if ui.button("Select its nodes").clicked() {
        model.selection = members(model.document(), name).map(str::to_owned).collect();
        ui.close();
    }
    if !model.selection.is_empty() && ui.button("Add what is selected").clicked() {
        let mut nodes: Vec<String> = members(model.document(), name).map(str::to_owned).collect();
        nodes.extend(model.selection.iter().filter(|id| !nodes.contains(id)).cloned().collect::<Vec<_>>());
        operation = Some(Operation::SetGroup { name: name.to_owned(), nodes: Some(nodes) });
        ui.close();
    }
    if ui.button("Dissolve").clicked() {
        operation = Some(Operation::SetGroup { name: name.to_owned(), nodes: None });
        ui.close();
    }
    operation
}
