//! The same scripts given to a `Live`: edits come while it evaluates, evaluations are stopped midway, and whenever somebody
//! waits, the snapshot has to be what a fresh session comes to. Nothing is frozen here: which revisions are evaluated, and
//! so what a frozen node has had last, is up to the threads.

use super::oracle::{Came, Expected, expected};
use super::script::{Dice, Step};
use super::world::{Calls, Disk, LIBRARY, library, registry};
use std::collections::BTreeMap;
use std::sync::Arc;
use tenon_engine::*;

/// One document under way, and how many snapshots were compared.
struct Watched {
    live: Live,
    calls: Arc<Calls>,
    disk: Arc<Disk>,
    compared: usize,
}

/// Takes a script through a `Live`; gives how many snapshots were compared, or says at which step it went wrong.
pub fn run(steps: &[Step], seed: i64) -> Result<usize, String> {
    let (calls, disk) = (Arc::new(Calls::slow()), Arc::new(Disk::default()));
    let options = Options {
        threads: 2,
        cache_bytes: [1 << 30, 1500][(seed & 1) as usize],
        host: disk.clone(),
        ..Options::default()
    };
    let live = Live::new(registry(&calls, Vec::new()), Document::new(), options, || {}).map_err(|e| e.to_string())?;
    let mut watched = Watched { live, calls, disk, compared: 0 };
    let mut dice = Dice::new(seed);
    for (i, step) in steps.iter().enumerate() {
        watched.step(step, &mut dice).map_err(|e| format!("step {i}, live: {e}"))?;
    }
    watched.look(&[]).map_err(|e| format!("the end, live: {e}"))?;
    Ok(watched.compared)
}

impl Watched {
    fn step(&mut self, step: &Step, dice: &mut Dice) -> Result<(), String> {
        match step {
            Step::Edit(operation) => self.apply(operation)?,
            Step::Paste(ids) => {
                let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
                if let Ok(fragment) = self.live.document().copy(&ids) {
                    let paste = self.live.document().paste(&fragment, OuterWires::Keep, [0.0, 0.0]).operation;
                    self.apply(&paste)?;
                }
            }
            Step::Gather(ids, name, instance) => {
                let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
                if let Ok(operation) = self.live.document().gather(&ids, name, instance) {
                    self.apply(&operation)?;
                }
            }
            Step::Explode(id) => {
                if let Ok(paste) = self.live.document().explode(id, self.live.registry()) {
                    self.apply(&paste.operation)?;
                }
            }
            Step::Set(name, value) => {
                let before = self.live.document().clone();
                if self.live.set(name, value.clone()).is_err() && *self.live.document() != before {
                    return Err("a value was refused, but something has changed".into());
                }
            }
            Step::Room(_) => {}
            Step::Begin => self.live.begin_step(),
            Step::Commit => self.live.end_step(),
            Step::Undo => drop(self.live.undo().map_err(|e| e.to_string())?),
            Step::Redo => drop(self.live.redo().map_err(|e| e.to_string())?),
            Step::File(name, content) => {
                let mut files = self.disk.0.lock().map_err(|e| e.to_string())?;
                match content {
                    Some(n) => files.insert(name.clone(), vec![b'.'; *n]),
                    None => files.remove(name),
                };
            }
            Step::Library(b) => {
                let mut files = self.disk.0.lock().map_err(|e| e.to_string())?;
                match b {
                    Some(b) => files.insert(LIBRARY.into(), library(*b)),
                    None => files.remove(LIBRARY),
                };
                drop(files);
                self.live.evaluate_now();
            }
            Step::Reload => {
                let document = self.live.document().clone();
                self.live.replace(document).map_err(|e| e.to_string())?;
            }
            Step::Cancel(after, targets) => {
                self.aim(targets);
                // Not before some nodes have run, if there are any to run.
                let goal = self.calls.total() + after;
                while self.live.is_busy() && self.calls.total() < goal {
                    std::thread::yield_now();
                }
                self.live.cancel();
            }
            // Half of the time the next edits come while this is under way.
            Step::Evaluate(targets) => match dice.below(2) {
                0 => self.look(targets)?,
                _ => drop(self.aim(targets)),
            },
        }
        Ok(())
    }

    fn apply(&mut self, operation: &Operation) -> Result<(), String> {
        let operation = thawed(operation);
        let before = self.live.document().clone();
        match self.live.apply(operation) {
            Err(refused) if *self.live.document() != before => Err(format!("{refused}, but something has changed")),
            _ => Ok(()),
        }
    }

    fn aim(&mut self, targets: &[String]) -> u64 {
        self.live.set_goals(&targets.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Waits for what is asked for and compares it with what a fresh session comes to.
    fn look(&mut self, targets: &[String]) -> Result<(), String> {
        let revision = self.aim(targets);
        let snapshot = self.live.wait(revision).ok_or("a snapshot never comes")?;
        let Some(Expected { nodes, diagnostics, files, .. }) =
            expected(self.live.document(), &BTreeMap::new(), targets, &self.disk)
        else {
            return Ok(());
        };
        self.compared += 1;
        let told: Vec<String> = snapshot.report().diagnostics.iter().map(ToString::to_string).collect();
        if told != diagnostics {
            return Err(format!("it tells\n  {told:#?}\nfresh\n  {diagnostics:#?}"));
        }
        for (id, Came { type_name, outputs, .. }) in &nodes {
            let Some(t) = self.live.registry().get(type_name) else { continue };
            for (port, fresh) in t.outputs().iter().zip(outputs) {
                let name = format!("{id}.{}", port.name());
                let found = snapshot.value(&name);
                let same = found.map(Tree::to_json) == fresh.as_ref().map(Tree::to_json);
                // What nobody asked for by name may have been dropped from memory.
                if !same && (found.is_some() || targets.contains(&name)) {
                    return Err(format!("{name} is {found:?}, fresh {fresh:?}"));
                }
            }
        }
        let text = |all: &[(String, File)]| format!("{all:?}");
        if targets.is_empty() && text(snapshot.files()) != text(&files) {
            return Err(format!("the files are {:?}, fresh {files:?}", snapshot.files()));
        }
        Ok(())
    }
}

/// The same with nothing frozen.
fn thawed(operation: &Operation) -> Operation {
    let on = |state: NodeState| if state == NodeState::Frozen { NodeState::On } else { state };
    let mut operation = operation.clone();
    match &mut operation {
        Operation::All(all) => all.iter_mut().for_each(|o| *o = thawed(o)),
        Operation::AddNode { node, .. } | Operation::PutNode { node: Some(node), .. } => node.state = on(node.state),
        Operation::SetState { state, .. } => *state = on(*state),
        Operation::InCluster { operation, .. } => **operation = thawed(operation),
        _ => {}
    }
    operation
}
