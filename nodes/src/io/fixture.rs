//! Two joined panels on two boards, made by hand, for the tests of this folder.

use tenon_geometry::board::{Board, Layout, PartSet, Placement, Up};
use tenon_geometry::joint::{Feature, FeatureSet, Hardware, Machining};
use tenon_geometry::mesh::Address;
use tenon_geometry::panel::{EdgeRef, PanelSet, Side};
use tenon_geometry::{DAffine3, DVec2, DVec3, Plane};

/// Thickness, mm.
pub const D: f64 = 10.0;

/// Two parallelograms, 200 × 80 with 20 of shear, front up at z = 10. Chamfers lean by (0.2, -0.1, 0.3, 0) (slope, back
/// larger if positive); the third corner of panel 0 is voided: its back ends stand 4 mm and 6 mm from the lines' crossing.
/// Panel 1 could not be made; panel 2 equals panel 0 without the void.
pub fn panels() -> PanelSet {
    let mut set = PanelSet { thickness: D, corner_start: vec![0].into(), ..PanelSet::default() };
    for (column, void) in [(0, true), (1, false), (2, false)] {
        set.address.to_mut().push(Address { patch: 0, row: 3, column });
        set.normal.to_mut().push(DVec3::Z);
        if column != 1 {
            panel(&mut set, if void { [4.0, 6.0] } else { [0.0, 0.0] });
        }
        set.corner_start.to_mut().push(set.front.len() as u32);
    }
    set.neighbour.to_mut()[1] = Some(EdgeRef { panel: 2, edge: 3 }).into();
    set.neighbour.to_mut()[7] = Some(EdgeRef { panel: 0, edge: 1 }).into();
    set
}

fn panel(set: &mut PanelSet, void: [f64; 2]) {
    let front =
        [DVec3::new(0.0, 0.0, D), DVec3::new(200.0, 0.0, D), DVec3::new(220.0, 80.0, D), DVec3::new(20.0, 80.0, D)];
    let slope = [0.2, -0.1, 0.3, 0.0];
    let along: Vec<_> = (0..4).map(|k| (front[(k + 1) % 4] - front[k]).normalize()).collect();
    let normals: Vec<_> = (0..4).map(|k| (along[k].cross(DVec3::Z) + DVec3::Z * slope[k]).normalize()).collect();
    // Where chamfers k - 1 and k cross in the back plane z = 0.
    let corner = |k: usize| {
        let v = normals[(k + 3) % 4].cross(normals[k]);
        front[k] - v * (D / v.z)
    };
    let first = set.front.len() as u32;
    for k in 0..4 {
        let next = (k + 1) % 4;
        set.front.to_mut().push(front[k]);
        set.vertex.to_mut().push(first + k as u32);
        set.chamfer.to_mut().push(Plane::through(front[k], normals[k]));
        set.neighbour.to_mut().push(None.into());
        set.side.to_mut().push([Side::Bottom, Side::Right, Side::Top, Side::Left][k]);
        set.voided.to_mut().push(k == 2 && void[0] > 0.0);
        set.back_start.to_mut().push(corner(k) + along[k] * if k == 2 { void[1] } else { 0.0 });
        set.back_end.to_mut().push(corner(next) - along[k] * if next == 2 { void[0] } else { 0.0 });
    }
}

/// The panels as parts, with a toe hole, a fixing hole, an address and a slot.
pub fn parts() -> PartSet {
    let feature = |panel, edge, purpose: &'static str, machining| Feature {
        panel,
        edge,
        joint: edge,
        purpose: purpose.into(),
        machining,
    };
    let toe = Machining::Drill {
        entry: DVec3::new(100.0, 5.0, D),
        axis: DVec3::new(0.0, -0.5_f64.sqrt(), -0.5_f64.sqrt()),
        depth: 14.0,
        diameter: 3.0,
    };
    let fixing = Machining::Drill { entry: DVec3::new(50.0, 40.0, D), axis: DVec3::NEG_Z, depth: D, diameter: 4.0 };
    let address = Machining::Engraving {
        origin: DVec3::new(90.0, 30.0, D),
        along: DVec3::X,
        axis: DVec3::NEG_Z,
        height: 15.0,
        depth: 0.5,
        text: "3.0".into(),
    };
    let slot = Machining::Slot {
        from: DVec3::new(150.0, 40.0, D - 3.0),
        to: DVec3::new(180.0, 40.0, D - 3.0),
        axis: DVec3::NEG_Z,
        width: 8.0,
        depth: 3.0,
    };
    let features = vec![
        feature(0, Some(0), "toe screw", toe.clone()),
        feature(0, None, "fixing", fixing),
        feature(0, None, "address", address),
        feature(0, None, "slot", slot),
    ];
    let hardware = vec![Hardware { name: "Screw 3.5 x 40, \"toe\"".into(), count: 7 }];
    PartSet {
        panels: panels(),
        features: FeatureSet { features, by_hand: vec![feature(2, Some(3), "toe screw", toe)], hardware },
        frame: vec![DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0)); 3],
        up: Up::Front,
    }
}

/// Panel 0 on the first board, panel 2 turned by 90° on the second.
pub fn layout() -> Layout {
    let rectangle = |m: f64| {
        vec![DVec2::new(-m, -m), DVec2::new(222.0 + m, -m), DVec2::new(222.0 + m, 83.0 + m), DVec2::new(-m, 83.0 + m)]
    };
    Layout {
        board: Board { size: DVec2::new(400.0, 300.0), thickness: D, margin: 10.0 },
        boards: 2,
        placements: vec![
            Placement { part: 0, board: 0, offset: DVec2::new(40.0, 50.0), turn: 0.0 },
            Placement { part: 2, board: 1, offset: DVec2::new(150.0, 40.0), turn: std::f64::consts::FRAC_PI_2 },
        ],
        piece: vec![rectangle(0.0), Vec::new(), rectangle(0.0)],
        cleared: vec![rectangle(20.0), Vec::new(), rectangle(20.0)],
    }
}
