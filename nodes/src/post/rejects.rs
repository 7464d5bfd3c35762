//! The proof through text: a good chain passes, and every way of spoiling its programs is found.

use super::*;
use tenon_geometry::DVec3;
use tenon_geometry::board::{Board, Goods, Layout, MapParams, Packer, PartSet, RowPacker, map_parts};
use tenon_geometry::joint::{FastenerRule, lay_fasteners};
use tenon_geometry::machine::Machine;
use tenon_geometry::mesh::{Address, Mesh};
use tenon_geometry::motion::{PathParams, Place, cut_parts, place_paths};
use tenon_geometry::panel::{BorderCut, BorderRule, ThickenParams, thicken};
use tenon_geometry::proof::{Body, Fault, Obstacle, Program, ProofError, ProofParams, ProofReport, prove};

/// An arc swept along a rough fold: nodes are not conical, chamfers lean both ways.
fn shell(columns: usize, rows: usize) -> Mesh {
    let point = |i: usize, j: usize| {
        let (u, v) = (i as f64 / columns as f64 - 0.5, j as f64);
        let arc = DVec3::new(280.0 * columns as f64 * u, 0.0, 300.0 * columns as f64 / 4.0 * (0.25 - u * u));
        arc + DVec3::new(30.0 * (2.1 * v).sin(), 170.0 * v, 60.0 * (1.7 * v + 0.4).sin())
    };
    let index = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| point(i, j))).collect();
    let cells = || (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let faces: Vec<_> =
        cells().map(|(i, j)| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]).collect();
    let addresses = cells().map(|(i, j)| Address { patch: 0, row: j as u32, column: i as u32 }).collect();
    Mesh { addresses, ..Mesh::from_faces(points, &faces) }
}

struct Chain {
    file: MachineFile,
    parts: PartSet,
    layout: Layout,
    programs: Vec<PostedProgram>,
}

/// Shell to posted text: panels, toe screws, marks, layout, paths, programs.
fn chain(columns: usize, rows: usize, thickness: f64) -> Chain {
    chain_on("maka-mm7s", columns, rows, thickness)
}

fn chain_on(machine: &str, columns: usize, rows: usize, thickness: f64) -> Chain {
    let file = machine_preset(machine).unwrap();
    let mut params = ThickenParams::new(thickness);
    params.border = BorderRule { bottom: BorderCut::Angle(0.2), left: BorderCut::Angle(-0.15), ..params.border };
    let (panels, issues) = thicken(&shell(columns, rows), &params).unwrap();
    assert!(issues.iter().all(|i| !i.is_fatal()), "{issues:?}");
    let map = MapParams::default();
    // 21 mm take toe screws as well here: their pilots enter from above on either board.
    let (features, _) = lay_fasteners(&panels, &FastenerRule::toe_screws(map.up)).unwrap();
    let path_params = PathParams::default();
    let (mut parts, _) = map_parts(&panels, &features, &map, &|| true);
    // What no tool reaches is made by hand.
    let tried = cut_parts(&parts, &file.machine, &path_params, &|_| true).unwrap();
    let out_of_reach = |k: u32| tried.issues.iter().any(|i| i.place == Place::Feature(k));
    let mut index = 0..;
    parts.features.features.retain(|_| !out_of_reach(index.next().unwrap()));
    let paths = cut_parts(&parts, &file.machine, &path_params, &|_| true).unwrap();
    assert!(paths.issues.is_empty(), "{:?}", paths.issues);
    let goods = Goods::of_parts(&parts, &paths, &file.machine, &|| true);
    let board = Board { size: tenon_geometry::DVec2::new(1500.0, 3000.0), thickness, margin: 10.0 };
    let packed = RowPacker::default().pack(&goods, &board, &|_| true).unwrap();
    assert!(packed.left_out.is_empty(), "{:?}", packed.left_out);
    let (placed, issues) = place_paths(&paths, &packed.layout, &file.machine, &|| true);
    assert!(issues.is_empty(), "{issues:?}");
    let params = PostParams { name: "board", addresses: &parts.panels.address, header: &[] };
    let programs = post(&placed, &file.machine, &file.words, &params, &|| true).unwrap();
    Chain { file, parts, layout: packed.layout, programs }
}

impl Chain {
    fn prove(&self) -> ProofReport {
        self.prove_on(&self.file.machine)
    }

    fn prove_on(&self, machine: &Machine) -> ProofReport {
        self.prove_laid(machine, &self.layout, &|_| true).unwrap()
    }

    /// Reads the text back and proves what was read.
    fn prove_laid(
        &self,
        machine: &Machine,
        layout: &Layout,
        progress: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<ProofReport, ProofError> {
        let programs: Vec<Program> = self.programs.iter().map(|p| p.read(machine)).collect();
        prove(&programs, machine, &self.parts, layout, &ProofParams::default(), progress)
    }

    /// Changes the first program's text line by line.
    fn edit(&mut self, change: impl Fn(&str) -> String) {
        let text: Vec<String> = self.programs[0].text.lines().map(change).collect();
        self.programs[0].text = text.join("\n") + "\n";
    }
}

/// Adds to every word of an axis.
fn add(line: &str, letter: char, by: f64) -> String {
    let word = |w: &str| match w.strip_prefix(letter).and_then(|v| v.parse::<f64>().ok()) {
        Some(v) if !line.starts_with('(') => format!("{letter}{:.3}", v + by),
        _ => w.to_owned(),
    };
    line.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

fn say(report: &ProofReport) -> String {
    let lines = report.programs.iter().flat_map(|p| p.reasons.iter().map(ToString::to_string));
    format!("gouge {} leftover {}\n{}", report.gouge(), report.leftover(), lines.collect::<Vec<_>>().join("\n"))
}

#[test]
fn good_programs_pass_in_10_and_21_mm() {
    for (machine, thickness) in [("maka-mm7s", 10.0), ("maka-mm7s", 21.0), ("linuxcnc-xyzbc", 10.0)] {
        let mut c = chain_on(machine, 3, 3, thickness);
        let report = c.prove();
        assert!(report.passed(), "{}", say(&report));
        assert_eq!(report.parts.iter().flatten().count(), 9);
        assert!(report.gouge() <= 0.005 && report.gouge() > 0.0 && report.leftover() <= 0.05, "{}", say(&report));
        let leaning = |sign: f64| {
            let p = &c.parts.panels;
            p.chamfer.iter().any(|plane| plane.normal.z * sign > 0.05)
        };
        assert!(leaning(1.0) && leaning(-1.0), "the test needs chamfers that lean both ways");
        // The verdict is written into the head without moving a line.
        let lines = c.programs[0].text.lines().count();
        c.programs[0].set_status(&c.file.words, "proven");
        assert_eq!(c.programs[0].text.lines().nth(1), Some("(status: proven)"));
        assert_eq!(c.programs[0].text.lines().count(), lines);
        assert!(c.prove().passed());
    }
}

#[test]
fn the_sign_of_a_flipped_is_found() {
    let mut c = chain(2, 2, 10.0);
    c.edit(|line| {
        let word = |w: &str| match w.strip_prefix('A').and_then(|v| v.parse::<f64>().ok()) {
            Some(v) if !line.starts_with('(') => format!("A{:.3}", -v),
            _ => w.to_owned(),
        };
        line.split(' ').map(word).collect::<Vec<_>>().join(" ")
    });
    let report = c.prove();
    assert!(!report.passed());
    assert!(report.gouge() > 0.5, "{}", say(&report));
}

#[test]
fn one_millimetre_too_deep_is_found() {
    for by in [-1.0, 1.0] {
        let mut c = chain(2, 2, 10.0);
        c.edit(|line| add(line, 'Z', by));
        let report = c.prove();
        assert!(!report.passed());
        let faults = |f: fn(&Fault) -> bool| report.programs[0].reasons.iter().any(|r| f(&r.fault));
        assert!(faults(|f| matches!(f, Fault::Leftover(_))), "{}", say(&report));
        if by < 0.0 {
            assert!(faults(|f| *f == Fault::Gouge), "{}", say(&report));
        } else {
            assert!(faults(|f| matches!(f, Fault::MissingHole { .. })), "{}", say(&report));
        }
    }
}

#[test]
fn a_wrong_tool_radius_is_found() {
    let c = chain(2, 2, 10.0);
    let with = |diameter: f64| {
        let mut machine = c.file.machine.clone();
        machine.tools.iter_mut().filter(|t| t.number == 10).for_each(|t| t.diameter = diameter);
        c.prove_on(&machine)
    };
    let (thin, thick) = (with(19.0), with(21.0));
    assert!(!thin.passed() && (thin.leftover() - 0.5).abs() < 0.01, "{}", say(&thin));
    assert!(!thick.passed() && (thick.gouge() - 0.5).abs() < 0.01, "{}", say(&thick));
    let mut machine = c.file.machine.clone();
    machine.tools.iter_mut().filter(|t| t.number == 3).for_each(|t| t.diameter = 2.0);
    let report = c.prove_on(&machine);
    let missing = |r: &tenon_geometry::proof::Reason| matches!(r.fault, Fault::MissingHole { .. });
    assert!(report.programs[0].reasons.iter().any(missing), "{}", say(&report));
}

#[test]
fn a_tool_too_short_is_found() {
    let c = chain(2, 2, 10.0);
    let mut machine = c.file.machine.clone();
    machine.tools.iter_mut().filter(|t| t.number == 10).for_each(|t| t.cutting_length = 8.0);
    let report = c.prove_on(&machine);
    let shank =
        |f: &Fault| matches!(f, Fault::Collision { body: Body::Shank, obstacle: Obstacle::Stock, rapid: false });
    assert!(report.programs[0].reasons.iter().any(|r| shank(&r.fault)), "{}", say(&report));
    // Shorter still: the holder dives in.
    let mut machine = c.file.machine.clone();
    for t in machine.tools.iter_mut().filter(|t| t.number == 10) {
        let up = t.length - 9.0;
        (t.cutting_length, t.length) = (8.0, 9.0);
        t.holder.iter_mut().for_each(|h| (h.from, h.to) = (h.from - up, h.to - up));
    }
    let report = c.prove_on(&machine);
    let holder = |f: &Fault| matches!(f, Fault::Collision { body: Body::Holder, .. });
    assert!(report.programs[0].reasons.iter().any(|r| holder(&r.fault)), "{}", say(&report));
}

#[test]
fn two_parts_swapped_are_found() {
    let mut c = chain(2, 2, 10.0);
    let (a, b) = (c.layout.placements[0].part, c.layout.placements[1].part);
    c.layout.placements[0].part = b;
    c.layout.placements[1].part = a;
    let report = c.prove();
    assert!(!report.passed());
    assert!(report.gouge() > 0.1 || report.leftover() > 0.1, "{}", say(&report));
}

#[test]
fn a_rapid_at_cutting_height_is_found() {
    let mut c = chain(2, 2, 10.0);
    // The first cut of the contour tool, run at full speed.
    let start = c.programs[0].text.find("T10 M6").unwrap();
    let cut = c.programs[0].text[start..].find("F3000").unwrap() + start;
    let line_start = c.programs[0].text[..cut].rfind('\n').unwrap() + 1;
    let line = c.programs[0].text[line_start..].lines().next().unwrap().to_owned();
    let rapid = format!("G0 {}", line.trim_start_matches("G1 "));
    let number = 1 + c.programs[0].text[..line_start].matches('\n').count() as u32;
    c.programs[0].text.replace_range(line_start..line_start + line.len(), &rapid);
    let report = c.prove();
    let rapid = |r: &tenon_geometry::proof::Reason| {
        r.line == Some(number)
            && matches!(r.fault, Fault::Collision { rapid: true, body: Body::Cutter, obstacle: Obstacle::Stock })
    };
    assert!(report.programs[0].reasons.iter().any(rapid), "line {number}\n{}", say(&report));
}

#[test]
fn spindle_tool_table_clamps_and_order_are_watched() {
    let found = |change: &dyn Fn(&mut Chain), fault: &dyn Fn(&Fault) -> bool| {
        let mut c = chain(2, 2, 10.0);
        change(&mut c);
        let report = c.prove();
        assert!(!report.passed());
        assert!(report.programs[0].reasons.iter().any(|r| fault(&r.fault)), "{}", say(&report));
    };
    let replace = |from: &'static str, to: &'static str| {
        move |c: &mut Chain| {
            assert!(c.programs[0].text.contains(from), "{from}");
            c.programs[0].text = c.programs[0].text.replace(from, to);
        }
    };
    found(&replace("S18000 M3", "S18000"), &|f| *f == Fault::SpindleStopped);
    found(&replace("S18000 M3", "S1800 M3"), &|f| matches!(f, Fault::Speed { .. }));
    found(&replace("T10 M6", "T11 M6"), &|f| *f == Fault::UnknownTool(11));
    found(&replace("T10 M6", "T3 M6"), &|f| matches!(f, Fault::Leftover(_)));
    found(&replace("M30", ""), &|f| matches!(f, Fault::Unreadable(_)));
    found(&|c| c.programs.clear(), &|f| *f == Fault::NoProgram);
    found(&|c| c.file.machine.table.sacrificial = 0.5, &|f| {
        matches!(f, Fault::Collision { obstacle: Obstacle::Table, body: Body::Cutter, .. })
    });
    let clamp = |c: &mut Chain| {
        let at = c.layout.placements[0].offset.extend(15.0) + DVec3::new(-40.0, -40.0, 0.0);
        let clamp =
            tenon_geometry::machine::Clamp { name: "stop".into(), min: at, max: at + DVec3::new(60.0, 60.0, 20.0) };
        c.file.machine.clamps.push(clamp);
    };
    found(&clamp, &|f| matches!(f, Fault::Collision { obstacle: Obstacle::Clamp(_), .. }));
    found(&replace("G0 Z60.000", "G0 Z-20.000"), &|f| matches!(f, Fault::Limit { axis: 'Z', .. }));
    // The first position, and a tool changed in the wood.
    found(&replace("T2 M6", "G1 Z5.000\nT2 M6"), &|f| *f == Fault::ToolChange);
    found(&replace("S12000 M3", "S12000 M3\nG0 X500 Y500 Z5 A0 B0"), &|f| *f == Fault::FirstMove);
    // A pilot drill pushed sideways.
    let sideways = |c: &mut Chain| {
        let start = c.programs[0].text.find("fixing)").unwrap();
        let at = start + c.programs[0].text[start..].find("F1500\n").unwrap() + 6;
        c.programs[0].text.insert_str(at, "X100.000\n");
    };
    found(&sideways, &|f| *f == Fault::DrillSideways);
    // A sign of the machine itself.
    found(&|c| c.file.machine.secondary.sign = 1.0, &|f| *f == Fault::Gouge);
    // A contour left out.
    let skip = |c: &mut Chain| {
        let start = c.programs[0].text.rfind("contour)").unwrap();
        let end = c.programs[0].text.rfind("G0 Z60.000\nM5").unwrap();
        c.programs[0].text.replace_range(start + 9..end, "");
    };
    found(&skip, &|f| matches!(f, Fault::Leftover(_)));
    // Engraving left out.
    let engraving = |c: &mut Chain| {
        let start = c.programs[0].text.find("engraving)").unwrap();
        let end = start + c.programs[0].text[start..].find("\n(").unwrap();
        c.programs[0].text.replace_range(start + 10..end, "");
    };
    found(&engraving, &|f| matches!(f, Fault::MissingEngraving { .. }));
}

#[test]
fn the_report_is_the_same_for_any_number_of_threads() {
    let c = chain(2, 3, 10.0);
    let reports: Vec<ProofReport> = [1, 2, 5]
        .iter()
        .map(|n| rayon::ThreadPoolBuilder::new().num_threads(*n).build().unwrap().install(|| c.prove()))
        .collect();
    assert_eq!(reports[0], reports[1]);
    assert_eq!(reports[0], reports[2]);
}

#[test]
fn a_proof_can_be_cancelled() {
    let c = chain(2, 2, 10.0);
    assert_eq!(c.prove_laid(&c.file.machine, &c.layout, &|_| false), Err(ProofError::Cancelled));
}

/// A part that lies elsewhere than the program thinks: what is cut into it and what is left are the shift seen along
/// the normals of its chamfers.
#[test]
fn gouge_and_leftover_of_a_shifted_part_are_those_of_its_chamfers() {
    let c = chain(2, 2, 10.0);
    let part = c.layout.placements[0].part;
    for k in 0..24 {
        let heading = f64::from(k) * 0.26;
        let shift = tenon_geometry::DVec2::new(heading.cos(), heading.sin()) * (0.1 + 0.04 * f64::from(k));
        let mut layout = c.layout.clone();
        layout.placements[0].offset += shift;
        let report = c.prove_laid(&c.file.machine, &layout, &|_| true).unwrap();
        let verdict = report.parts[part as usize].as_ref().unwrap();
        let solid = c.parts.panels.solid(part as usize);
        // Front, back, four chamfers, then node facets, which the cuts beside them may clear as well.
        let along = |sign: f64, faces: usize| {
            let normals = solid.planes.iter().take(faces).map(|p| layout.placements[0].vector(p.normal));
            normals.map(|n| sign * n.truncate().dot(shift)).fold(0.0, f64::max)
        };
        assert!(verdict.leftover > along(-1.0, 6) - 0.005 && verdict.leftover < along(-1.0, 99) + 0.005, "{verdict:?}");
        assert!(verdict.gouge > along(1.0, 6) - 0.005 && verdict.gouge < shift.length() + 0.005, "{verdict:?}");
        let others = report.parts.iter().flatten().filter(|p| p.part != part);
        assert!(others.clone().count() == 3 && others.into_iter().all(|p| p.passed));
    }
}
