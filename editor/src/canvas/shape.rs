//! How large nodes are and where their ports stand, in canvas points. Made anew when the document changes, not per frame.

use crate::model::Model;
use crate::model::catalog::{Catalog, PortInfo, TypeInfo};
use crate::model::param::{self, Widget};
use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};
use std::collections::HashMap;
use std::sync::Arc;
use tenon_engine::{InterfaceInput, Literal, Node, NodeState};

/// Width of every node.
pub const WIDTH: f32 = 190.0;
/// Height of the bar with the title.
pub const HEADER: f32 = 26.0;
/// Height of a port's row.
pub const ROW: f32 = 20.0;
/// Width of a note.
pub const NOTE: f32 = 230.0;
/// Size of a sheet that shows data.
pub const SHEET: Vec2 = vec2(230.0, 176.0);
/// Room below the last row.
pub const FOOT: f32 = 6.0;

/// How a node is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// As a box with rows.
    Node,
    /// As a sheet with a text.
    Note,
    /// As a point that wires are led through.
    Reroute,
    /// As a sheet with what a wire brings.
    Sheet,
}

/// One row of a node.
#[derive(Clone, Debug, PartialEq)]
pub enum Row {
    /// An output, by its number.
    Output(usize),
    /// An input, by its number, with its widget if no wire comes to it.
    Input(usize, Option<Widget>),
    /// So many inputs that keep their defaults are not shown; or all are, and can be folded again.
    More(usize),
}

/// A node as it is drawn.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its id.
    pub id: String,
    /// Its type.
    pub info: Arc<TypeInfo>,
    /// Where it stands.
    pub rect: Rect,
    /// How it is drawn.
    pub kind: Kind,
    /// Its rows from top to bottom.
    pub rows: Vec<Row>,
    /// On, frozen or disabled.
    pub state: NodeState,
    /// Its inputs, those that only the file knows included.
    pub inputs: Vec<PortInfo>,
    /// Its outputs, those that only wires speak of included.
    pub outputs: Vec<PortInfo>,
}

impl Shape {
    /// The middle of a row.
    #[must_use]
    pub fn row_y(&self, row: usize) -> f32 {
        match self.kind {
            Kind::Reroute => return self.rect.center().y,
            Kind::Sheet => return self.rect.top() + HEADER / 2.0,
            Kind::Node | Kind::Note => {}
        }
        self.rect.top() + HEADER + (row as f32 + 0.5) * ROW
    }

    /// The area of a row.
    #[must_use]
    pub fn row_rect(&self, row: usize) -> Rect {
        match self.kind {
            Kind::Reroute | Kind::Note => return self.rect,
            Kind::Sheet => return Rect::from_min_size(self.rect.min, vec2(self.rect.width(), HEADER)),
            Kind::Node => {}
        }
        let top = self.rect.top() + HEADER + row as f32 * ROW;
        Rect::from_min_size(pos2(self.rect.left(), top), vec2(self.rect.width(), ROW))
    }

    /// Where wires to an input end; an input that is folded away ends at the header.
    #[must_use]
    pub fn input(&self, port: usize) -> Pos2 {
        let row = self.rows.iter().position(|r| matches!(r, Row::Input(p, _) if *p == port));
        let more = || self.rows.iter().position(|r| matches!(r, Row::More(_)));
        let y = row.or_else(more).map_or(self.rect.top() + HEADER / 2.0, |r| self.row_y(r));
        pos2(self.rect.left(), y)
    }

    /// Where wires from an output begin.
    #[must_use]
    pub fn output(&self, port: usize) -> Pos2 {
        let row = self.rows.iter().position(|r| matches!(r, Row::Output(p) if *p == port));
        pos2(self.rect.right(), row.map_or(self.rect.top() + HEADER / 2.0, |r| self.row_y(r)))
    }
}

/// One wire.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// `node.port` that it comes from.
    pub from: String,
    /// The shape and output that it comes from; none if the node is not there.
    pub source: Option<(usize, usize)>,
    /// The shape that it goes to.
    pub to: usize,
    /// The input there.
    pub port: usize,
}

/// All nodes and wires of a document.
#[derive(Default)]
pub struct Shapes {
    /// Nodes by id.
    pub nodes: Vec<Shape>,
    /// Wires in order of the nodes that they go to.
    pub wires: Vec<Wire>,
    /// There are nodes without a place.
    pub homeless: bool,
    number: HashMap<String, usize>,
    made_for: Option<u64>,
}

impl Shapes {
    /// The number of a node.
    #[must_use]
    pub fn find(&self, id: &str) -> Option<usize> {
        self.number.get(id).copied()
    }

    /// Everything that is drawn, or none if nothing is.
    #[must_use]
    pub fn bounds(&self) -> Option<Rect> {
        self.nodes.iter().map(|s| s.rect).reduce(Rect::union)
    }

    /// Brings all up to the document, if it has changed. O(nodes + wires).
    pub fn update(&mut self, model: &Model) {
        if self.made_for == Some(model.revision()) {
            return;
        }
        self.made_for = Some(model.revision());
        let document = model.document();
        let mut bound: HashMap<&str, &InterfaceInput> = HashMap::new();
        for input in document.inputs.values() {
            bound.extend(input.ports.iter().map(|p| (p.as_str(), input)));
        }
        self.nodes.clear();
        self.number.clear();
        self.homeless = false;
        for (id, node) in document.nodes() {
            self.number.insert(id.clone(), self.nodes.len());
            let place = model.position(id);
            self.homeless |= place.is_none();
            let at = place.unwrap_or_default().map(|v| v as f32);
            let info = model.catalog.of(node);
            let range = |port: &str| bound.get(format!("{id}.{port}").as_str()).copied();
            self.nodes.push(shape(id, node, info, pos2(at[0], at[1]), document.look(id).open, range));
        }
        self.wires.clear();
        for (id, node) in document.nodes() {
            let Some(to) = self.find(id) else { continue };
            for (name, wires) in &node.inputs {
                let Some(port) = self.nodes[to].inputs.iter().position(|p| p.name == *name) else { continue };
                for from in &wires.from {
                    let source = self.source(from);
                    self.wires.push(Wire { from: from.to_string(), source, to, port });
                }
            }
        }
    }

    /// The output that an address names; a node of unknown type gets it by being asked for it.
    fn source(&mut self, address: &str) -> Option<(usize, usize)> {
        let (id, name) = address.split_once('.')?;
        let n = self.find(id)?;
        let shape = &mut self.nodes[n];
        if let Some(o) = shape.outputs.iter().position(|p| p.name == name) {
            return Some((n, o));
        }
        if shape.info.known {
            return None;
        }
        shape.outputs.push(Catalog::unknown_port(name));
        shape.rows.insert(shape.outputs.len() - 1, Row::Output(shape.outputs.len() - 1));
        shape.rect.set_height(shape.rect.height() + ROW);
        Some((n, shape.outputs.len() - 1))
    }

    /// Both ends of all wires of a port. O(wires).
    pub fn wires_at<'a>(&'a self, n: usize, port: &'a str, output: bool) -> impl Iterator<Item = (Pos2, Pos2)> + 'a {
        let named = move |ports: &[PortInfo], p: usize| ports.get(p).is_some_and(|info| info.name == port);
        let is_at = move |w: &&Wire| match (output, w.source) {
            (true, Some((s, o))) => s == n && named(&self.nodes[s].outputs, o),
            (true, None) => false,
            (false, _) => w.to == n && named(&self.nodes[n].inputs, w.port),
        };
        self.wires.iter().filter(is_at).filter_map(|w| {
            let (s, o) = w.source?;
            Some((self.nodes[s].output(o), self.nodes[w.to].input(w.port)))
        })
    }

    /// How large a node would be, for arranging.
    #[must_use]
    pub fn size(&self, id: &str) -> [f64; 2] {
        let size = self.find(id).map_or(Vec2::ZERO, |n| self.nodes[n].rect.size());
        [f64::from(size.x), f64::from(size.y)]
    }
}

fn shape<'a>(
    id: &str,
    node: &Node,
    info: Arc<TypeInfo>,
    at: Pos2,
    open: bool,
    bound: impl Fn(&str) -> Option<&'a InterfaceInput>,
) -> Shape {
    let mut rows: Vec<Row> = (0..info.outputs.len()).map(Row::Output).collect();
    let inputs: Vec<PortInfo> = info.inputs.iter().map(|p| param::at(node, p, bound(&p.name))).collect();
    let outputs = info.outputs.clone();
    let whole = |kind, size, rows| Shape {
        id: id.to_owned(),
        kind,
        rect: Rect::from_min_size(at, size),
        rows,
        state: node.state,
        inputs: info.inputs.clone(),
        outputs: info.outputs.clone(),
        info: info.clone(),
    };
    match node.type_name.as_str() {
        "note" => return whole(Kind::Note, note_size(&note_text(node)), Vec::new()),
        "reroute" => {
            rows.push(Row::Input(0, None));
            return whole(Kind::Reroute, vec2(28.0, 18.0), rows);
        }
        "text_panel" => {
            rows.push(Row::Input(0, None));
            return whole(Kind::Sheet, SHEET, rows);
        }
        _ => {}
    }
    let (mut folded, one) = (0, shows_one(node));
    for (p, port) in inputs.iter().enumerate() {
        let wired = node.inputs.get(&port.name).is_some_and(|w| !w.from.is_empty());
        let set = node.params.contains_key(&port.name);
        let needed = port.default.is_none() && !port.optional;
        let few = info.inputs.len() <= 3;
        let says = match one {
            Some(name) => port.name == name,
            None => set || needed || few,
        };
        if !(wired || says || open || bound(&port.name).is_some()) {
            folded += 1;
            continue;
        }
        let widget = (!wired).then(|| {
            let set = node.params.get(&port.name).map(Literal::json);
            param::widget(port, set.as_deref())
        });
        rows.push(Row::Input(p, widget));
    }
    if folded > 0 {
        rows.push(Row::More(folded));
    } else if open && (info.inputs.len() > 3 || one.is_some()) {
        rows.push(Row::More(0));
    }
    let size = vec2(WIDTH, HEADER + rows.len() as f32 * ROW + FOOT);
    let (id, rect) = (id.to_owned(), Rect::from_min_size(at, size));
    Shape { id, kind: Kind::Node, rect, rows, state: node.state, inputs, outputs, info }
}

/// The one input that a node is there for: what else is set shows when it is unfolded.
fn shows_one(node: &Node) -> Option<&'static str> {
    match node.type_name.as_str() {
        "slider" | "integer_slider" => Some("value"),
        "value_list" => Some("chosen"),
        _ => None,
    }
}

/// The text of a note.
pub fn note_text(node: &Node) -> String {
    let text = node.params.get("text").map(Literal::to_json);
    text.as_ref().and_then(tenon_engine::Json::as_str).unwrap_or_default().to_owned()
}

/// Room for the text of a note: about so many letters to a line.
fn note_size(text: &str) -> Vec2 {
    let lines = text.split('\n').map(|l| l.chars().count().div_ceil(34).max(1)).sum::<usize>();
    vec2(NOTE, 16.0 + lines as f32 * 18.0)
}
