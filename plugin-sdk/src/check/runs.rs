//! Checks of what a plugin does.

use super::Check;
use super::hosts::{Host, Laid};
use super::instance::another_instance;
use super::old_nodes::{old_nodes, strange_nodes};
use super::pages::Touched;
use super::samples::{Day, Inputs, inputs};
use crate::abi::plugin::{TENON_ITEM, TENON_TREE};
use crate::abi::value::*;
use crate::load::{EvaluateError, Message, Plugin, PluginNode, Sink, Views, Watch, late_calls};
use crate::value::{Branch, Items};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What an evaluation came to.
struct Ran {
    end: Result<(), EvaluateError>,
    /// Each output as text that tells every bit; empty: not set.
    outputs: Vec<String>,
    infinite: bool,
    faults: Vec<String>,
    messages: Vec<Message>,
    progress: Vec<f64>,
    /// What it did with memory that it may only read, where another host than ours gives it.
    touched: Touched,
    time: Duration,
}

struct Outputs<'a> {
    node: &'a PluginNode,
    inputs: &'a Inputs,
    outputs: Vec<String>,
    infinite: bool,
    faults: Vec<String>,
    messages: Vec<Message>,
    /// What looking at the outputs has taken, which is not the plugin's.
    own: Duration,
}

fn kind(items: &Items<'_>) -> tenon_kind {
    match items {
        Items::Boolean(_) => TENON_BOOLEAN,
        Items::Integer(_) => TENON_INTEGER,
        Items::Number(_) => TENON_NUMBER,
        Items::Text(_) => TENON_TEXT,
        Items::Point(_) => TENON_POINT,
        Items::Vector(_) => TENON_VECTOR,
        Items::Plane(_) => TENON_PLANE,
        Items::Curve(_) => TENON_CURVE,
        Items::Mesh(_) => TENON_MESH,
        Items::Panels(_) => TENON_PANELS,
        Items::Features(_) => TENON_FEATURES,
        Items::File(_) => TENON_FILE,
        Items::Table(_) => TENON_TABLE,
        Items::Edges(_) => TENON_EDGES,
        Items::Opaque { .. } => TENON_OPAQUE,
    }
}

/// Every bit of a value: `{:?}` of floats is exact.
fn bits(value: &[Branch<'_>]) -> String {
    format!("{value:?}")
}

/// Whether every item that is there is finite; what stands in a gap means nothing. Meshes, panel sets and features with
/// such numbers are refused before they come here.
fn is_finite(items: &Items<'_>, valid: Option<&[bool]>) -> bool {
    fn all<T>(v: &[T], valid: Option<&[bool]>, finite: impl Fn(&T) -> bool) -> bool {
        let there = |i: usize| valid.and_then(|valid| valid.get(i)).is_none_or(|there| *there);
        v.iter().enumerate().all(|(i, x)| !there(i) || finite(x))
    }
    let finite = |v: &tenon_vec3| v.x.is_finite() && v.y.is_finite() && v.z.is_finite();
    match items {
        Items::Number(v) => all(v, valid, |x| x.is_finite()),
        Items::Point(v) | Items::Vector(v) => all(v, valid, finite),
        Items::Plane(v) => all(v, valid, |p| finite(&p.normal) && p.offset.is_finite()),
        Items::Curve(v) => {
            let sum = |p: &tenon_vec4| p.x + p.y + p.z + p.w;
            all(v, valid, |c| c.points.iter().all(|p| sum(p).is_finite()))
        }
        Items::Table(v) => all(v, valid, |t| t.attributes.iter().all(|a| is_finite(&a.items, a.valid.as_deref()))),
        _ => true,
    }
}

impl Outputs<'_> {
    fn declared(&self, output: u32) -> Option<(tenon_kind, u32, String)> {
        if self.node.fastener {
            return (output == 0).then(|| (TENON_FEATURES, TENON_ITEM, "features".to_owned()));
        }
        self.node.outputs.get(output as usize).map(|p| (p.kind, p.access, p.name.clone()))
    }

    fn take(&mut self, output: u32, value: &[Branch<'_>]) -> Result<(), String> {
        let Some((wanted, access, name)) = self.declared(output) else {
            self.faults.push(format!("it sets output {output}, which it does not declare"));
            return Err("no such output".into());
        };
        self.infinite |= !value.iter().all(|b| is_finite(&b.items, b.valid.as_deref()));
        for branch in value {
            if kind(&branch.items) != wanted && !branch.items.is_empty() {
                self.faults.push(format!("\"{name}\" is set to another type than declared"));
            }
            if access == TENON_ITEM && branch.items.len() != 1 {
                self.faults.push(format!("\"{name}\" is one item, but set to {}", branch.items.len()));
            }
        }
        if access != TENON_TREE && value.len() != 1 {
            self.faults.push(format!("\"{name}\" is no tree, but set to {} branches", value.len()));
        }
        if let Some(place) = self.outputs.get_mut(output as usize) {
            *place = bits(value);
        }
        Ok(())
    }
}

impl Sink for Outputs<'_> {
    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        let start = Instant::now();
        let taken = self.take(output, &value);
        self.own += start.elapsed();
        taken
    }
    fn forward(&mut self, output: u32, input: u32) -> Result<(), String> {
        let inputs = self.inputs;
        match inputs.get(input as usize) {
            Some(value) => self.take(output, value),
            None => Err(format!("there is no input {input}")),
        }
    }
    fn tell(&mut self, message: Message) {
        self.messages.push(message);
    }
}

/// How an evaluation is watched.
#[derive(Clone, Copy, Default)]
struct Wish {
    /// Polls of `cancelled` that are answered with no before it is yes.
    cancel_after: Option<u64>,
    /// How long it may work before `cancelled` says yes.
    cancel_at: Option<Duration>,
    refuse_buffer: Option<u64>,
    /// Who lays out the inputs.
    host: Host,
}

fn run_with(node: &PluginNode, inputs: &Inputs, wish: Wish) -> Ran {
    let count = if node.fastener { 1 } else { node.outputs.len() };
    let mut sink = Outputs {
        node,
        inputs,
        outputs: vec![String::new(); count],
        infinite: false,
        faults: Vec::new(),
        messages: Vec::new(),
        own: Duration::ZERO,
    };
    let (polls, progress) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let began = Instant::now();
    let cancelled = || {
        wish.cancel_after.is_some_and(|n| polls.fetch_add(1, Ordering::Relaxed) >= n)
            || wish.cancel_at.is_some_and(|at| began.elapsed() >= at)
    };
    let hear = |fraction: f64| {
        if let Ok(mut all) = progress.lock() {
            all.push(fraction);
        }
    };
    let watch = Watch { cancelled: &cancelled, progress: &hear, refuse_buffer: wish.refuse_buffer, room: None };
    let views = Views::new(inputs);
    // SAFETY: views that were just made.
    let mut laid = (wish.host != Host::Ours).then(|| unsafe { Laid::new(wish.host, views.trees()) });
    let start = Instant::now();
    let end = node.evaluate_at(&views, watch, &mut sink, |call, trees| match &mut laid {
        Some(laid) => (laid.call(call), laid.trees()),
        None => (call, trees),
    });
    let time = start.elapsed() - sink.own;
    let touched = laid.map(|laid| laid.touched()).unwrap_or_default();
    let (outputs, infinite, faults, messages) = (sink.outputs, sink.infinite, sink.faults, sink.messages);
    let progress = progress.into_inner().unwrap_or_default();
    Ran { end, outputs, infinite, faults, messages, progress, touched, time }
}

fn run(node: &PluginNode, day: Day) -> Ran {
    run_by(Host::Ours, node, day)
}

fn run_by(host: Host, node: &PluginNode, day: Day) -> Ran {
    run_with(node, &inputs(node, day), Wish { host, ..Wish::default() })
}

/// The days of an ordinary life; those that may crash a node have checks of their own.
const DAYS: [Day; 10] = [
    Day::Good,
    Day::Other,
    Day::Smallest,
    Day::Largest,
    Day::Degenerate,
    Day::Empty,
    Day::Sparse,
    Day::Choice(0),
    Day::Choice(1),
    Day::Choice(2),
];

/// So soon a node ends that is told to.
const AT_ONCE: Duration = Duration::from_millis(100);

/// The best of three: on a busy machine the process may be put aside.
fn soonest(run: impl Fn() -> Duration) -> Duration {
    (0..3).map(|_| run()).min().unwrap_or_default()
}

/// What is wrong with nodes, by node.
fn each(plugin: &Plugin, wrong: impl Fn(&PluginNode) -> Option<String>) -> Vec<String> {
    plugin.nodes.iter().filter_map(|n| Some(format!("{}: {}", n.id, wrong(n)?))).collect()
}

/// Whether a fault is that of a thread that may not call back, for which there is a check of its own.
fn is_stray(why: &str) -> bool {
    why.contains("calls back from a thread")
}

/// A node may compute or say why it cannot; breaking the contract is neither.
fn survives(plugin: &Plugin, day: Day) -> Vec<String> {
    let absurd = matches!(day, Day::NotANumber | Day::Huge);
    each(plugin, |n| match run(n, day).end {
        Err(EvaluateError::Fault(why)) if is_stray(&why) => None,
        // What comes of absurd numbers is refused by the host, which is no harm.
        Err(EvaluateError::Fault(why)) if absurd && why.contains("not finite") => None,
        Err(EvaluateError::Fault(why)) => Some(why),
        _ => None,
    })
}

/// What all runs of all days come to, if one of them is wrong.
fn on_any_day(plugin: &Plugin, wrong: impl Fn(&Ran) -> Option<String>) -> Vec<String> {
    each(plugin, |n| DAYS.iter().find_map(|day| Some(format!("{}, inputs \"{day:?}\"", wrong(&run(n, *day))?))))
}

fn differs(a: &Ran, b: &Ran) -> Option<String> {
    let same = a.outputs == b.outputs && a.end == b.end && a.messages == b.messages;
    (!same).then(|| "the same inputs gave other outputs or messages".into())
}

fn across_threads(node: &PluginNode) -> Option<String> {
    let first = run(node, Day::Good);
    let other = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (first, other) = (&first, &other);
            scope.spawn(move || {
                for turn in 0..8 {
                    // Every thread's turns differ, so that shared state shows.
                    if (turn + thread) % 2 == 0 {
                        run(node, Day::Other);
                    }
                    if differs(first, &run(node, Day::Good)).is_some() {
                        other.store(true, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    other.into_inner().then(|| "other threads at work change its outputs".into())
}

macro_rules! day_checks {
    ($($name:literal $day:expr, $about:literal;)*) => {
        vec![$(Check { name: $name, about: $about, run: |p| survives(p, $day) }),*]
    };
}

pub(super) fn checks() -> Vec<Check> {
    let mut all = vec![
        Check {
            name: "computes",
            about: "With its defaults and small clean geometry every node computes, or says why it cannot.",
            run: |p| {
                each(p, |n| match run(n, Day::Good) {
                    Ran { end: Err(EvaluateError::Fault(why)), .. } if !is_stray(&why) => Some(why),
                    Ran { end: Err(EvaluateError::Failed), messages, .. } if messages.is_empty() => {
                        Some("it fails without a word".into())
                    }
                    _ => None,
                })
            },
        },
        Check {
            name: "sets-every-output",
            about: "A node that ends well has set every output that it declares.",
            run: |p| {
                on_any_day(p, |r| {
                    let missing = r.outputs.iter().position(String::is_empty)?;
                    r.end.is_ok().then(|| format!("output {missing} is not set"))
                })
            },
        },
        Check {
            name: "sets-what-it-declares",
            about: "Outputs have the type and access that the node declares.",
            run: |p| on_any_day(p, |r| r.faults.first().cloned()),
        },
        Check {
            name: "finite-outputs",
            about: "From finite inputs come finite outputs, or an error.",
            run: |p| {
                each(p, |n| {
                    DAYS.iter().map(|day| (day, run(n, *day))).find_map(|(day, r)| {
                        (r.end.is_ok() && r.infinite)
                            .then(|| format!("an output is NaN or infinite, inputs \"{day:?}\""))
                    })
                })
            },
        },
        Check {
            name: "same-again",
            about: "The same inputs give the same bytes, ten times over.",
            run: |p| {
                each(p, |n| {
                    let first = run(n, Day::Good);
                    (0..10).find_map(|_| differs(&first, &run(n, Day::Good)))
                })
            },
        },
        Check {
            name: "same-after-others",
            about: "What a node computed before does not show in what it computes now.",
            run: |p| {
                each(p, |n| {
                    let first = run(n, Day::Good);
                    DAYS.iter().find_map(|day| {
                        run(n, *day);
                        differs(&first, &run(n, Day::Good)).map(|why| format!("{why}, after inputs \"{day:?}\""))
                    })
                })
            },
        },
        Check {
            name: "same-in-another-instance",
            about: "A second instance of the library, loaded from a copy of its file and so with memory of its own, computes the same bytes as one that has computed other things before.",
            run: |p| match another_instance(p) {
                Ok(other) => p
                    .nodes
                    .iter()
                    .zip(&other.nodes)
                    .filter_map(|(a, b)| {
                        run(a, Day::Other);
                        Some(format!("{}: {}", a.id, differs(&run(a, Day::Good), &run(b, Day::Good))?))
                    })
                    .collect(),
                Err(why) => vec![why],
            },
        },
        Check {
            name: "same-on-many-threads",
            about: "Several threads may evaluate a node at once, and each gets the same bytes.",
            run: |p| each(p, across_threads),
        },
        Check {
            name: "leaves-inputs-alone",
            about: "Inputs are borrowed and read-only: they lie in memory that cannot be written to, so that a write that is undone is noticed too.",
            run: |p| {
                each(p, |n| {
                    DAYS.iter().find_map(|day| {
                        let touched = run_by(Host::ReadOnly, n, *day).touched;
                        touched.written.then(|| format!("it wrote to an input, inputs \"{day:?}\""))
                    })
                })
            },
        },
        Check {
            name: "calls-from-its-own-thread",
            about: "The host's functions, but for cancelled, are called from the thread that evaluate runs on: others would be refused.",
            run: |p| {
                each(p, |n| {
                    DAYS.iter().find_map(|day| match run(n, *day).end {
                        Err(EvaluateError::Fault(why)) if is_stray(&why) => Some(format!("{why}, inputs \"{day:?}\"")),
                        _ => None,
                    })
                })
            },
        },
        Check {
            name: "older-host",
            about: "An older host's structs end where those of version 1.0 did, and nothing behind them can be read: a plugin asks their sizes before it takes what is newer, and does the same without it or says why it cannot.",
            run: |p| {
                each(p, |n| {
                    [Day::Good, Day::Other].into_iter().find_map(|day| {
                        let old = run_by(Host::Older, n, day);
                        let says_why = old.end == Err(EvaluateError::Failed)
                            && old.messages.iter().any(|m| m.severity == TENON_ERROR);
                        let reads_on = old.touched.passed.then(|| "it reads behind what it is given".to_owned());
                        reads_on.or_else(|| if says_why { None } else { differs(&run(n, day), &old) })
                    })
                })
            },
        },
        Check {
            name: "newer-host",
            about: "A newer host's structs have grown at their ends: a plugin goes from one to the next by the stride given, and takes every size that is large enough.",
            run: |p| {
                each(p, |n| {
                    let grown = |day| differs(&run(n, day), &run_by(Host::Newer, n, day));
                    [Day::Good, Day::Other].into_iter().find_map(grown)
                })
            },
        },
        Check {
            name: "brings-nodes-forward",
            about: "Nodes of every older version that a node type takes become nodes of the next, or it says why not.",
            run: |p| each(p, old_nodes),
        },
        Check {
            name: "old-nodes-that-are-none",
            about: "Text that is no node of an older version does no harm: it is refused, or becomes a node.",
            run: |p| each(p, strange_nodes),
        },
        Check {
            name: "explains-failures",
            about: "A node that fails has told an error.",
            run: |p| {
                on_any_day(p, |r| {
                    let told = r.messages.iter().any(|m| m.severity == TENON_ERROR);
                    (r.end == Err(EvaluateError::Failed) && !told).then(|| "it fails without telling an error".into())
                })
            },
        },
        Check {
            name: "messages-are-for-people",
            about: "Messages have a sentence, a code in kebab-case, and name inputs that there are.",
            run: |p| {
                each(p, |n| {
                    let host: &[&str] = if n.fastener { &["panels", "edges", "up"] } else { &[] };
                    let known = |port: &str| host.contains(&port) || n.inputs.iter().any(|p| p.name == port);
                    let kebab = |c: &str| c.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-');
                    let good = |m: &Message| {
                        !m.message.trim().is_empty() && kebab(&m.code) && m.port.as_deref().is_none_or(known)
                    };
                    let told = DAYS.iter().flat_map(|day| run(n, *day).messages);
                    told.into_iter()
                        .find(|m| !good(m))
                        .map(|m| format!("it says {}: \"{}\" at {:?}", m.code, m.message, m.port))
                })
            },
        },
        Check {
            name: "stops-at-once",
            about: "A node that is cancelled before it begins ends within 100 ms.",
            run: |p| {
                each(p, |n| {
                    let given = inputs(n, Day::Largest);
                    let wish = Wish { cancel_after: Some(0), ..Wish::default() };
                    let time = soonest(|| run_with(n, &given, wish).time);
                    let late = time > AT_ONCE;
                    late.then(|| format!("it took {} ms", time.as_millis()))
                })
            },
        },
        Check {
            name: "stops-midway",
            about: "A node that is cancelled while it works ends within 100 ms and without breaking the contract.",
            run: |p| {
                each(p, |n| {
                    for at in [5, 40].map(Duration::from_millis) {
                        let (given, wish) = (inputs(n, Day::Largest), Wish { cancel_at: Some(at), ..Wish::default() });
                        let time = soonest(|| run_with(n, &given, wish).time);
                        if time > at + AT_ONCE {
                            return Some(format!("told after {} ms, it took {} ms", at.as_millis(), time.as_millis()));
                        }
                    }
                    let wishes = (1..20).map(|k| Wish { cancel_after: Some(k), ..Wish::default() });
                    wishes.map(|w| run_with(n, &inputs(n, Day::Other), w)).find_map(|r| match r.end {
                        Err(EvaluateError::Fault(why)) if !is_stray(&why) => Some(why),
                        _ => None,
                    })
                })
            },
        },
        Check {
            name: "lives-without-memory",
            about: "A node that is refused its k-th buffer ends with an error, for every k.",
            run: |p| {
                each(p, |n| {
                    (0..20).find_map(|k| {
                        let r = run_with(n, &inputs(n, Day::Good), Wish { refuse_buffer: Some(k), ..Wish::default() });
                        match r.end {
                            Err(EvaluateError::Fault(why)) if !is_stray(&why) => Some(format!("buffer {k}: {why}")),
                            _ => None,
                        }
                    })
                })
            },
        },
        Check {
            name: "progress-rises",
            about: "Progress lies between 0 and 1 and never falls.",
            run: |p| {
                on_any_day(p, |r| {
                    let falls = r.progress.windows(2).find(|w| w[0] > w[1])?;
                    Some(format!("it goes from {} to {}", falls[0], falls[1]))
                })
            },
        },
        Check {
            name: "keeps-quiet-afterwards",
            about: "Nothing calls the host after evaluate has returned: there is nobody to listen.",
            run: |p| {
                p.nodes.iter().for_each(|n| drop(run(n, Day::Good)));
                // A thread of its own may get its turn late on a busy machine.
                for _ in 0..20 {
                    std::thread::sleep(Duration::from_millis(10));
                    if late_calls() > 0 {
                        break;
                    }
                }
                match late_calls() {
                    0 => Vec::new(),
                    n => vec![format!("{n} calls came late")],
                }
            },
        },
        Check {
            name: "leaves-the-process-alone",
            about: "The working directory is what it was: it belongs to the host.",
            run: |p| {
                let before = std::env::current_dir().ok();
                p.nodes.iter().for_each(|n| drop(run(n, Day::Good)));
                if std::env::current_dir().ok() == before { Vec::new() } else { vec!["it changed".into()] }
            },
        },
    ];
    all.extend(day_checks! {
        "smallest-numbers" Day::Smallest, "With every number the smallest that is accepted, a node computes or says why not.";
        "largest-numbers" Day::Largest, "With every number the largest that is accepted, a node computes or says why not.";
        "not-a-number" Day::NotANumber, "NaN does no harm: a host that checks less than ours may let it pass.";
        "huge-numbers" Day::Huge, "Numbers and coordinates of 1e300 do no harm.";
        "degenerate-geometry" Day::Degenerate, "Geometry without extent does no harm: points that coincide, panels of a micrometre.";
        "nothing-at-all" Day::Empty, "Empty lists, meshes and panel sets do no harm.";
        "optional-inputs" Day::Sparse, "Optional inputs may stay without a value.";
        "first-choice" Day::Choice(0), "The first choice of every text works, and an empty text does no harm.";
        "second-choice" Day::Choice(1), "The second choice of every text works, and texts with zeros and emoji do no harm.";
        "long-texts" Day::Choice(2), "The third choice of every text works, and a text of a megabyte does no harm.";
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::value::{Attribute, Table};

    #[test]
    fn what_stands_in_a_gap_means_nothing() {
        let numbers = || Items::Number(vec![1.0, f64::NAN].into());
        assert!(!is_finite(&numbers(), None));
        assert!(!is_finite(&numbers(), Some(&[false, true])));
        assert!(is_finite(&numbers(), Some(&[true, false])));
        let table = |valid: Option<Vec<bool>>| {
            let attribute = Attribute { name: "x".into(), items: numbers(), valid: valid.map(Into::into) };
            Items::Table(vec![Table { rows: 2, attributes: vec![attribute] }])
        };
        assert!(!is_finite(&table(None), None));
        assert!(is_finite(&table(Some(vec![true, false])), None));
        assert!(is_finite(&table(None), Some(&[false])));
    }
}
