//! `tenon sweep`: one graph, many values of its inputs. A plan says which; each of its rows is evaluated once, here or on
//! any machine that sees the plan, and its result appears whole or not at all.

mod all;
mod plan;
mod vary;

use crate::args::{SweepCommand, SweepRowArgs};
use crate::words::{Voice, Wrong, print, print_json};
use crate::{End, cache, interrupt, output};
use tenon_engine::{Control, Json, Progress};
use tenon_nodes::host::sweep::{self, Bench, Found, Inputs, Lock};

/// Whether the result is asked for as JSON.
pub fn json(command: &SweepCommand) -> bool {
    match command {
        SweepCommand::Plan(_) => false,
        SweepCommand::RunRow(a) => a.json,
        SweepCommand::Run(a) => a.json,
    }
}

/// Does one step of a sweep.
pub fn sweep(command: &SweepCommand) -> Result<End, Wrong> {
    match command {
        SweepCommand::Plan(a) => plan::make(a),
        SweepCommand::RunRow(a) => run_row(a),
        SweepCommand::Run(a) => all::run(a),
    }
}

/// Evaluates one row, unless its result is there.
fn run_row(args: &SweepRowArgs) -> Result<End, Wrong> {
    let rows = plan::read(&args.plan)?;
    let Some(row) = rows.iter().find(|planned| planned.row.key == args.key) else {
        let message = format!("{} has no row {}", args.plan.display(), args.key);
        return Err(Wrong::new("unknown-row", message).hint("a row's key stands in its \"key\""));
    };
    output::prepare_folder(&args.out)?;
    let _lock = Lock::shared(&args.out)?;
    let mut bench =
        Bench::new(crate::plugins::sources()?, args.threads.into(), crate::run::CACHE, cache::store(&args.cache));
    // A plan of another graph is refused even where the result is there.
    bench.load(row)?;
    let found = sweep::found(&args.out, row, &mut Inputs::default());
    if let Found::Damaged(file) = &found {
        Voice::new().say(&sweep::damage(row, file));
    }
    let result = if let Found::Finished(done) = found {
        Voice::new().say(&format!("{} is finished already", args.key));
        done
    } else {
        let bar = crate::progress::Bar::new(args.json);
        let show = |p: &Progress| bar.show(p.fraction, &p.node);
        let control = Control { cancel: interrupt::flag(), on_progress: Some(&show) };
        let made = bench.evaluate(row, &control, &args.out);
        bar.clear();
        let Some(made) = made? else {
            Voice::new().say("interrupted: nothing was written");
            return Ok(End::Interrupted);
        };
        Voice::new().diagnostics(&made.diagnostics);
        Voice::new().diagnostics(&made.cache);
        made.result
    };
    if args.json {
        print_json(&result)?;
    } else {
        print(&format!("{}\n", args.out.join(&args.key).display()))?;
    }
    Ok(if result["ok"] == Json::Bool(true) { End::Done } else { End::Errors })
}
