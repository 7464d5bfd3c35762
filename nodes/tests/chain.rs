//! The chain of rooms from a mesh to proven programs, without the graph: panels, joints, parts, boards, tool paths, text,
//! proof.

use tenon_geometry::board::{Board, Bounds, Goods, Grain, MapParams, Packer, RowPacker, Up, check_layout, map_parts};
use tenon_geometry::joint::{FastenerRule, lay_fasteners};
use tenon_geometry::mesh::{Address, Mesh};
use tenon_geometry::motion::{PathParams, cut_parts, place_paths};
use tenon_geometry::panel::{ThickenParams, thicken};
use tenon_geometry::proof::{Program, ProofParams, prove};
use tenon_geometry::{DVec2, DVec3};
use tenon_nodes::post::{PostParams, machine_preset, post};

fn go(_: f64) -> bool {
    true
}

/// A vector sum of an arc in x and a folded line in y: no node is conical.
fn shell(n: usize, span: f64, rise: f64, step: f64, depth: f64) -> Mesh {
    let radius = (span * span / 4.0 + rise * rise) / (2.0 * rise);
    let half = (span / 2.0 / radius).asin();
    let arc = |i: usize| {
        let t = half * (2.0 * i as f64 / n as f64 - 1.0);
        DVec3::new(radius * t.sin(), 0.0, radius * (t.cos() - half.cos()))
    };
    let fold = |j: usize| {
        let t = j as f64;
        DVec3::new(0.5 * depth * (2.1 * t).sin(), step * t, depth * (1.7 * t + 0.4).sin())
    };
    let w = n as u32 + 1;
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| arc(i) + fold(j)).collect();
    let cells = || (0..n as u32).flat_map(|j| (0..n as u32).map(move |i| (i, j)));
    let faces: Vec<[u32; 4]> =
        cells().map(|(i, j)| [j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i]).collect();
    let addresses = cells().map(|(i, j)| Address { patch: 0, row: j, column: i }).collect();
    Mesh { addresses, ..Mesh::from_faces(points, &faces) }
}

/// Panels, joints, parts, paths, boards, programs, proof; holes that the machine cannot reach are left to the hand.
/// Returns how many holes the machine makes and how many boards it takes.
fn prove_shell(mesh: &Mesh, thickness: f64, rule: &FastenerRule, up: Up, grain: Grain) -> (usize, u32) {
    let (panels, _) = thicken(mesh, &ThickenParams::new(thickness)).unwrap();
    let (features, _) = lay_fasteners(&panels, rule).unwrap();
    let (mut parts, issues) = map_parts(&panels, &features, &MapParams { up, ..MapParams::default() }, &|| true);
    assert!(issues.is_empty(), "{}", issues[0]);
    let file = machine_preset("maka-mm7s").unwrap();
    let params = PathParams::default();
    let paths = cut_parts(&parts, &file.machine, &params, &go).unwrap();
    assert!(!paths.failed.contains(&true), "{}", paths.issues[0]);
    parts.leave_to_hand(paths.unmade_features());
    let goods = Goods { grain, ..Goods::of_parts(&parts, &paths, &file.machine, &|| true) };
    let board = Board { size: DVec2::new(1500.0, 3000.0), thickness, margin: 5.0 };
    let packed = RowPacker::default().pack(&goods, &board, &go).unwrap();
    assert!(packed.left_out.is_empty());
    assert_eq!(check_layout(&packed.layout, Bounds::Cleared, 1e-7), []);
    let (placed, issues) = place_paths(&paths, &packed.layout, &file.machine, &|| true);
    assert!(issues.is_empty(), "{}", issues[0]);
    let params = PostParams { name: "shell", addresses: &parts.panels.address, header: &[] };
    let programs = post(&placed, &file.machine, &file.words, &params, &|| true).unwrap();
    let read: Vec<Program> = programs.iter().map(|p| p.read(&file.machine)).collect();
    let report = prove(&read, &file.machine, &parts, &packed.layout, &ProofParams::default(), &go).unwrap();
    for p in &report.programs {
        assert!(p.passed, "{}: {}", p.name, p.reasons[0]);
    }
    assert!(report.gouge() <= 0.005 && report.leftover() <= 0.05);
    assert_eq!(report.parts.iter().flatten().count(), mesh.face_count());
    let made = parts.features.features.iter().filter(|f| f.joint.is_some()).count();
    (made, packed.layout.boards)
}

#[test]
fn thin_shell_with_toe_screws_is_proven_with_either_face_up_and_parts_turned() {
    for (up, grain) in [(Up::Back, Grain::Directed), (Up::Front, Grain::Axis), (Up::Back, Grain::Free)] {
        let mesh = shell(16, 4500.0, 1200.0, 105.0, 40.0);
        let (holes, boards) = prove_shell(&mesh, 10.0, &FastenerRule::toe_screws(up), up, grain);
        assert!(holes > 1500 && boards <= 4, "{holes} holes, {boards} boards");
    }
}

#[test]
fn thick_shell_with_dowels_is_proven() {
    let mesh = shell(12, 4500.0, 1600.0, 300.0, 110.0);
    let (holes, _) = prove_shell(&mesh, 21.0, &FastenerRule::toe_dowels(Up::Back), Up::Back, Grain::Directed);
    assert!(holes > 1000, "{holes} holes");
}
