//! The board while it is cut, on a thread of its own: forward step by step, backward from what it was earlier. What is shown
//! is the last state that is done; the window only says which moment it wants.

use crate::model::play::{Kind, Play};
use crate::scene::{Drawing, Kind as Shape, Part, Vertex};
use eframe::egui::{Color32, ColorImage};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tenon_geometry::board::Board;
use tenon_geometry::machine::Revolved;
use tenon_geometry::stock::{Column, Region, Stock};
use tenon_geometry::{DVec2, DVec3};

/// Vertical lines of a board.
const LINES: usize = 300_000;
/// States that are kept of a program to come back to.
const KEPT: usize = 32;
/// Lines along the side of a piece that is drawn as one.
const PIECE: usize = 64;
/// So long it works before it looks whether another moment is wanted, and shows how far it is.
const SLICE: Duration = Duration::from_millis(60);
/// Colours of cuts by their depth.
const SHADES: usize = 16;
/// Turns of the head are taken in so many poses.
const TURN: usize = 6;

/// A moment of a program.
#[derive(Clone)]
pub struct Moment {
    /// The programs.
    pub plays: Arc<Vec<Play>>,
    /// Which of them.
    pub program: usize,
    /// The board that is cut.
    pub board: Board,
    /// The step that runs.
    pub step: usize,
    /// How much of it is done, 0 to 1.
    pub part_way: f64,
    /// It is looked at in space, not from above.
    pub solid: bool,
}

impl Moment {
    fn same_program(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.plays, &other.plays) && self.program == other.program && self.board == other.board
    }

    fn same(&self, other: &Self) -> bool {
        let now = |m: &Self| (m.step, m.part_way.to_bits(), m.solid);
        self.same_program(other) && now(self) == now(other)
    }
}

/// The board at a moment.
#[derive(Clone, Default)]
pub struct Carved {
    /// Counts states, of all programs one after another, so that what did not change is not brought to the card anew.
    pub count: u64,
    /// Seen from above: what was cut in brown, darker the deeper; everything else is clear. Rows from the far side.
    pub image: Option<Arc<ColorImage>>,
    /// In space: pieces of the surface.
    pub solid: Vec<Arc<Drawing>>,
}

#[derive(Default)]
struct Shared {
    carved: Carved,
    /// The moment that `carved` is of; none while it is on its way.
    done: Option<Moment>,
}

/// The thread. It ends when this is dropped.
pub struct Carver {
    moments: Sender<Moment>,
    shared: Arc<Mutex<Shared>>,
    wanted: Option<Moment>,
}

impl Carver {
    /// Starts the thread; `wake` is called from it when there is something new. None if the system gives no thread.
    pub fn start(wake: impl Fn() + Send + 'static) -> Option<Self> {
        let (moments, inbox) = channel();
        let shared = Arc::new(Mutex::new(Shared::default()));
        let to = shared.clone();
        let thread = std::thread::Builder::new().name("carving".into());
        thread.spawn(move || run(&inbox, &to, &wake)).ok()?;
        Some(Self { moments, shared, wanted: None })
    }

    /// Says which moment is looked at.
    pub fn want(&mut self, moment: Moment) {
        if self.wanted.as_ref().is_none_or(|w| !w.same(&moment)) {
            self.wanted = Some(moment.clone());
            // It fails only if the thread has ended by a fault of its own.
            let _ = self.moments.send(moment);
        }
    }

    /// The board as far as it is cut.
    pub fn carved(&self) -> Carved {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).carved.clone()
    }

    /// Whether the board is as it is at the moment that is wanted.
    pub fn settled(&self) -> bool {
        let shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |(w, d): (&Moment, &Moment)| w.same(d);
        self.wanted.is_none() || self.wanted.as_ref().zip(shared.done.as_ref()).is_some_and(same)
    }
}

fn run(inbox: &Receiver<Moment>, shared: &Mutex<Shared>, wake: &dyn Fn()) {
    let (mut work, mut count): (Option<Work>, u64) = (None, 0);
    while let Ok(mut moment) = inbox.recv() {
        loop {
            while let Ok(newer) = inbox.try_recv() {
                moment = newer;
            }
            let work = match &mut work {
                Some(w) if w.of.same_program(&moment) => w,
                other => {
                    // It goes on counting, so that no state of another program bears the same number.
                    let changes = other.as_ref().map_or(0, |w| w.changes + 1);
                    other.insert(Work::new(moment.clone(), changes))
                }
            };
            let done = work.go_on(&moment);
            count += 1;
            let carved = work.show(moment.solid, count);
            let mut to = shared.lock().unwrap_or_else(PoisonError::into_inner);
            *to = Shared { carved, done: done.then(|| moment.clone()) };
            drop(to);
            wake();
            if done {
                break;
            }
        }
    }
}

/// A board being cut.
struct Work {
    of: Moment,
    stock: Stock,
    /// Cutters by tool.
    cutters: Vec<Vec<Revolved>>,
    /// Steps that are done, and how much of the next one.
    done: usize,
    part_way: f64,
    /// Earlier states: steps that were done, and the lines that were not whole.
    kept: Vec<(usize, Vec<(u32, Column)>)>,
    /// Pieces of the surface that have changed.
    stale: Vec<bool>,
    solid: Vec<Arc<Drawing>>,
    image: Option<(u64, Arc<ColorImage>)>,
    changes: u64,
}

impl Work {
    fn new(of: Moment, changes: u64) -> Self {
        let stock = Stock::new(&of.board, LINES);
        let machine = of.plays.get(of.program).map(|p| &p.machine.machine);
        let cutters = machine.iter().flat_map(|m| m.tools.iter().map(|t| m.body(t).cutter)).collect();
        let pieces = stock.count.map(|c| c.div_ceil(PIECE));
        let stale = vec![true; pieces[0] * pieces[1]];
        let (kept, solid, image) = (Vec::new(), Vec::new(), None);
        Self { of, stock, cutters, done: 0, part_way: 0.0, kept, stale, solid, image, changes }
    }

    /// Works towards a moment; false if it is not there yet.
    fn go_on(&mut self, to: &Moment) -> bool {
        let plays = self.of.plays.clone();
        let Some(play) = plays.get(self.of.program) else { return true };
        let step = to.step.min(play.steps.len());
        if step < self.done || (step == self.done && to.part_way < self.part_way) {
            self.come_back(step);
        }
        let start = Instant::now();
        let every = play.steps.len() / KEPT + 1;
        while self.done < step {
            self.cut(play, self.done, 1.0);
            (self.done, self.part_way) = (self.done + 1, 0.0);
            if self.done.is_multiple_of(every) && self.kept.last().is_none_or(|(at, _)| *at < self.done) {
                self.kept.push((self.done, self.stock.touched()));
            }
            if start.elapsed() > SLICE {
                return false;
            }
        }
        if to.part_way > self.part_way {
            self.cut(play, step, to.part_way);
            self.part_way = to.part_way;
        }
        true
    }

    /// Takes the last state that was kept before a step.
    fn come_back(&mut self, step: usize) {
        let kept = self.kept.iter().rev().find(|(at, _)| *at <= step);
        let (done, touched): (usize, &[_]) = kept.map_or((0, &[]), |(at, t)| (*at, t));
        self.stock.come_back(touched);
        (self.done, self.part_way) = (done, 0.0);
        self.stale.fill(true);
        self.changes += 1;
    }

    fn cut(&mut self, play: &Play, step: usize, until: f64) {
        let Some(step) = play.steps.get(step).filter(|s| s.kind != Kind::Rapid) else { return };
        let Some(cutter) = step.tool.and_then(|t| self.cutters.get(t)) else { return };
        let poses = if play.turns(step) { TURN } else { 1 };
        for i in 0..poses {
            let [a, b] = [i, i + 1].map(|k| play.pose(step, until * k as f64 / poses as f64));
            if let Some(region) = self.stock.cut(cutter, a, b) {
                self.changes += 1;
                mark(&mut self.stale, &self.stock, region);
            }
        }
    }

    fn show(&mut self, solid: bool, count: u64) -> Carved {
        let changes = self.changes;
        if solid {
            let pieces = self.stock.count.map(|c| c.div_ceil(PIECE));
            self.solid.resize_with(pieces[0] * pieces[1], || Arc::new(Drawing::empty(Shape::Mesh)));
            for (i, drawing) in self.solid.iter_mut().enumerate() {
                if std::mem::take(&mut self.stale[i]) {
                    let low = [i % pieces[0] * PIECE, i / pieces[0] * PIECE];
                    *drawing = Arc::new(draw(&self.stock, [low, low.map(|c| c + PIECE)], count, i));
                }
            }
        } else if self.image.as_ref().is_none_or(|(of, _)| *of != changes) {
            self.image = Some((changes, Arc::new(image(&self.stock))));
        }
        Carved {
            count: changes,
            image: self.image.as_ref().map(|(_, i)| i.clone()),
            solid: if solid { self.solid.clone() } else { Vec::new() },
        }
    }
}

fn mark(stale: &mut [bool], stock: &Stock, [low, high]: Region) {
    let across = stock.count[0].div_ceil(PIECE);
    // One line more: its side towards what was cut is drawn with it.
    let [x, y] = [0, 1].map(|k| low[k] / PIECE..=(high[k] / PIECE));
    for y in y {
        for x in x.clone().filter(|x| *x < across) {
            if let Some(slot) = stale.get_mut(y * across + x) {
                *slot = true;
            }
        }
    }
}

/// Colour of wood that was cut down to a share of the board's thickness.
fn cut_colour(left: f64) -> Color32 {
    let mix = |a: f64, b: f64| (a + (b - a) * left.clamp(0.0, 1.0)).round() as u8;
    Color32::from_rgb(mix(84.0, 196.0), mix(58.0, 156.0), mix(34.0, 108.0))
}

/// Where nothing is left.
const HOLE: Color32 = Color32::from_rgb(34, 30, 28);

fn image(stock: &Stock) -> ColorImage {
    let [w, h] = stock.count;
    let mut pixels = Vec::with_capacity(w * h);
    for y in (0..h).rev() {
        for x in 0..w {
            let column = stock.column(x, y);
            pixels.push(match column.top() {
                _ if column == Column::WHOLE => Color32::TRANSPARENT,
                None => HOLE,
                // Wood that only an undercut has touched looks whole from above.
                Some(u16::MAX) => Color32::TRANSPARENT,
                Some(top) => cut_colour(f64::from(top) / f64::from(u16::MAX)),
            });
        }
    }
    ColorImage::new([w, h], pixels)
}

/// Colours of the surface by part: the board's own, then cuts from the deepest to the least.
pub fn colours() -> Vec<u32> {
    let bytes = |c: Color32| u32::from_le_bytes([c.r(), c.g(), c.b(), 255]);
    let shades = (0..SHADES).map(|i| bytes(cut_colour((i as f64 + 0.5) / SHADES as f64)));
    std::iter::once(bytes(Color32::from_rgb(226, 196, 150))).chain(shades).chain([0]).collect()
}

fn draw(stock: &Stock, region: Region, count: u64, piece: usize) -> Drawing {
    let mut d = Drawing::empty(Shape::Mesh);
    d.digest = u128::from(count) << 32 | piece as u128;
    stock.faces_in(region, |f| {
        let middle = f.corners.iter().map(|c| c.z).sum::<f64>() / 4.0 / stock.thickness;
        let shade = 1 + ((middle * SHADES as f64) as u32).min(SHADES as u32 - 1);
        let part = if f.cut { shade } else { 0 };
        let n = (f.normal * 127.0).round();
        let normal = [n.x as i8, n.y as i8, n.z as i8, 0];
        let [a, b, c, e] = f.corners.map(|p| Vertex { position: p.as_vec3().to_array(), normal, part });
        d.triangles.extend([a, b, c, a, c, e]);
    });
    d.parts = vec![Part::new("board".into(), DVec3::ZERO)];
    d.bounds =
        [DVec3::ZERO, (DVec2::new(stock.count[0] as f64, stock.count[1] as f64) * stock.cell).extend(stock.thickness)];
    d
}
