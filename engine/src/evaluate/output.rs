//! Where a node's lanes put their results, and how lanes become branches.

use crate::diagnostic::Fail;
use crate::port::{Access, Port};
use crate::stop;
use crate::value::{Column, Item, Path, Tree};
use smallvec::SmallVec;
use std::any::Any;

/// What the pieces of one branch have set at one output; most branches are one piece.
pub(super) type Pieces = SmallVec<[Output; 1]>;

/// One output over a run of lanes.
pub(crate) struct Output {
    lanes: usize,
    kind: Kind,
    /// Some lanes set an item, others a list: a fault of the node.
    mixed: bool,
}

enum Kind {
    Unset,
    /// One lane only; true: it was set as a list.
    One(Column, bool),
    Items(Box<dyn Builder>),
    Lists(Vec<Option<Column>>),
    Trees(Vec<Option<Tree>>),
}

trait Builder: Send + Sync {
    fn as_any_mut(&mut self) -> &mut dyn Any;
    fn truncate(&mut self, len: usize);
    /// An empty one for as many lanes.
    fn fresh(&self, lanes: usize) -> Box<dyn Builder>;
    /// Puts what another has set in `lanes` lanes behind the first `at` lanes; false if its items are of another type.
    fn append(&mut self, at: usize, other: Box<dyn Builder>, lanes: usize) -> bool;
    /// As [`Builder::append`] with items that are a column already.
    fn append_column(&mut self, at: usize, column: &Column) -> bool;
    fn finish(self: Box<Self>, lanes: usize) -> Column;
}

struct Typed<T> {
    items: Vec<T>,
    /// Empty as long as there is no gap.
    valid: Vec<bool>,
}

impl<T: Item> Typed<T> {
    fn pad(&mut self, len: usize) {
        if self.items.len() < len {
            self.valid.resize(self.items.len(), true);
            self.items.resize(len, T::default());
            self.valid.resize(len, false);
        }
    }

    /// Where validity is told from here on, if there are gaps before or in what comes.
    fn follow(&mut self, valid: Option<&[bool]>) {
        if let Some(valid) = valid {
            self.valid.resize(self.items.len(), true);
            self.valid.extend_from_slice(valid);
        }
    }
}

impl<T: Item> Builder for Typed<T> {
    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn truncate(&mut self, len: usize) {
        self.items.truncate(len);
        self.valid.truncate(len);
    }

    fn fresh(&self, lanes: usize) -> Box<dyn Builder> {
        Box::new(Self { items: Vec::with_capacity(lanes), valid: Vec::new() })
    }

    fn append(&mut self, at: usize, mut other: Box<dyn Builder>, lanes: usize) -> bool {
        let Some(other) = other.as_any_mut().downcast_mut::<Self>() else { return false };
        self.pad(at);
        other.pad(lanes);
        other.valid.resize(if other.valid.is_empty() { 0 } else { lanes }, true);
        self.follow((!other.valid.is_empty()).then_some(&other.valid));
        self.items.append(&mut other.items);
        if !self.valid.is_empty() {
            self.valid.resize(self.items.len(), true);
        }
        true
    }

    fn append_column(&mut self, at: usize, column: &Column) -> bool {
        let Some(items) = column.slice::<T>() else { return false };
        self.pad(at);
        self.follow(column.valid());
        self.items.extend_from_slice(items);
        if !self.valid.is_empty() {
            self.valid.resize(self.items.len(), true);
        }
        true
    }

    fn finish(mut self: Box<Self>, lanes: usize) -> Column {
        self.pad(lanes);
        let Typed { items, mut valid } = *self;
        if !valid.is_empty() {
            valid.resize(lanes, true);
        }
        Column::build(items, (!valid.is_empty()).then_some(valid))
    }
}

impl Output {
    #[inline]
    pub fn new(lanes: usize) -> Self {
        Self { lanes, kind: Kind::Unset, mixed: false }
    }

    /// The number, if that is all that was set.
    #[inline]
    pub fn as_number(&self) -> Option<f64> {
        match &self.kind {
            Kind::One(column, _) if !self.mixed => column.as_number(),
            _ => None,
        }
    }

    #[inline]
    pub fn set_item<T: Item>(&mut self, lane: usize, value: T) {
        if self.lanes == 1 {
            self.kind = Kind::One(Column::single(value), false);
            return;
        }
        if let Kind::Unset = self.kind {
            self.kind = Kind::Items(Box::new(Typed::<T> { items: Vec::with_capacity(self.lanes), valid: Vec::new() }));
        }
        let Kind::Items(builder) = &mut self.kind else {
            self.mixed = true;
            return;
        };
        let Some(typed) = builder.as_any_mut().downcast_mut::<Typed<T>>() else {
            self.mixed = true;
            return;
        };
        typed.truncate(lane);
        typed.pad(lane);
        typed.items.push(value);
        if !typed.valid.is_empty() {
            typed.valid.push(true);
        }
    }

    pub fn set_list(&mut self, lane: usize, column: Column) {
        if self.lanes == 1 {
            self.kind = Kind::One(column, true);
            return;
        }
        if let Kind::Unset = self.kind {
            self.kind = Kind::Lists(vec![None; self.lanes]);
        }
        match &mut self.kind {
            Kind::Lists(lists) if lane < lists.len() => lists[lane] = Some(column),
            _ => self.mixed = true,
        }
    }

    pub fn set_tree(&mut self, lane: usize, tree: Tree) {
        if let Kind::Unset | Kind::One(..) = self.kind {
            self.kind = Kind::Trees(vec![None; self.lanes]);
        }
        match &mut self.kind {
            Kind::Trees(trees) if lane < trees.len() => trees[lane] = Some(tree),
            _ => self.mixed = true,
        }
    }

    /// Forgets what a lane that failed has set.
    pub fn clear(&mut self, lane: usize) {
        match &mut self.kind {
            Kind::Unset => {}
            Kind::One(..) => self.kind = Kind::Unset,
            Kind::Items(builder) => builder.truncate(lane),
            Kind::Lists(lists) => lists.iter_mut().skip(lane).for_each(|l| *l = None),
            Kind::Trees(trees) => trees.iter_mut().skip(lane).for_each(|t| *t = None),
        }
    }
}

/// The tree of a node that ran in a single lane.
pub(crate) fn alone(output: Output, port: &Port, path: &Path) -> Result<Tree, Fail> {
    if output.mixed {
        return Err(mixed(port));
    }
    let column = match output.kind {
        Kind::Trees(mut trees) => match trees.pop().flatten() {
            Some(tree) => return Ok(tree),
            None => gaps(port, 1),
        },
        Kind::One(column, _) => column,
        _ => items(SmallVec::from([output]), port, 1)?,
    };
    Ok(Tree::branch(path.clone(), column))
}

/// Puts the pieces of one branch together and adds its branches to `out`.
pub(super) fn join(
    pieces: Pieces,
    port: &Port,
    path: &Path,
    lanes: usize,
    out: &mut Vec<(Path, Column)>,
) -> Result<(), Fail> {
    if pieces.iter().any(|p| p.mixed) {
        return Err(mixed(port));
    }
    let lists = pieces.iter().any(|p| matches!(p.kind, Kind::Lists(_) | Kind::Trees(_) | Kind::One(_, true)));
    let trees = pieces.iter().any(|p| matches!(p.kind, Kind::Trees(_)));
    if !trees && (lanes == 1 || (!lists && port.access == Access::Item)) {
        let column = items(pieces, port, lanes)?;
        out.push((path.clone(), column));
        return Ok(());
    }
    if pieces.iter().any(|p| matches!(p.kind, Kind::Items(_))) {
        return Err(mixed(port));
    }
    let mut lane = 0;
    for piece in pieces {
        let end = lane + piece.lanes;
        let place = |l: usize| if lanes == 1 { path.clone() } else { path.child(l) };
        match piece.kind {
            Kind::One(column, _) => out.push((place(lane), column)),
            Kind::Lists(lists) => {
                out.extend(
                    lists.into_iter().enumerate().map(|(i, l)| (place(lane + i), l.unwrap_or_else(|| gaps(port, 1)))),
                );
            }
            Kind::Trees(trees) => {
                for (i, tree) in trees.into_iter().enumerate() {
                    let base = place(lane + i);
                    match tree {
                        None => out.push((base, gaps(port, 1))),
                        Some(tree) => {
                            out.extend(tree.branches().iter().map(|(p, c)| (base.below(p.steps()), c.clone())))
                        }
                    }
                }
            }
            Kind::Unset | Kind::Items(_) => out.extend((lane..end).map(|l| (place(l), gaps(port, 1)))),
        }
        lane = end;
    }
    Ok(())
}

fn mixed(port: &Port) -> Fail {
    Fail::new(
        "node-bug",
        format!("the node sets \"{}\" in some lanes to an item and in others to something else", port.name),
    )
}

/// A column of gaps of the port's type.
fn gaps(port: &Port, count: usize) -> Column {
    (port.item_type.empty)().pick(&vec![None; count])
}

/// The items of one branch as a column: those of all pieces are put in one list, which is digested once.
fn items(mut pieces: Pieces, port: &Port, lanes: usize) -> Result<Column, Fail> {
    // An item that nobody set is a gap, a list that nobody set is empty.
    let unset = |n: usize| if port.access == Access::Item { gaps(port, n) } else { (port.item_type.empty)() };
    if pieces.len() == 1
        && let Some(piece) = pieces.pop()
    {
        return Ok(match piece.kind {
            Kind::One(column, _) => column,
            Kind::Items(builder) => builder.finish(piece.lanes),
            _ => unset(lanes),
        });
    }
    let sample = pieces.iter().find_map(|p| if let Kind::Items(builder) = &p.kind { Some(builder) } else { None });
    let Some(mut all) = sample.map(|builder| builder.fresh(lanes)) else { return singles(pieces, &unset, port, lanes) };
    let mut at = 0;
    for piece in pieces {
        // A piece has as many lanes as are worked on between two looks.
        stop::check();
        let same = match piece.kind {
            Kind::Items(builder) => all.append(at, builder, piece.lanes),
            Kind::One(column, _) => all.append_column(at, &column),
            _ => true,
        };
        if !same {
            return Err(mixed(port));
        }
        at += piece.lanes;
    }
    Ok(all.finish(lanes))
}

/// As [`items`] where no piece has more than one item.
fn singles(pieces: Pieces, unset: &dyn Fn(usize) -> Column, port: &Port, lanes: usize) -> Result<Column, Fail> {
    let columns = || pieces.iter().map(|p| if let Kind::One(column, _) = &p.kind { Ok(column) } else { Err(p.lanes) });
    let Some(sample) = columns().find_map(Result::ok) else { return Ok(unset(lanes)) };
    let gaps = |n: usize| sample.pick(&vec![None; n]);
    Column::concat(&columns().map(|c| c.map_or_else(gaps, Column::clone)).collect::<Vec<_>>())
        .ok_or_else(|| mixed(port))
}
