//! A machine like that of 000 §7.3.1, for the tests of this crate.

use super::{Axis, Feeds, Machine, Revolved, Rotary, Table, Tool, ToolKind};
use glam::DVec3;

fn tool(number: u32, kind: ToolKind, diameter: f64, cutting_length: f64, length: f64, holder: f64) -> Tool {
    Tool {
        number,
        name: format!("Tool {number}"),
        kind,
        diameter,
        cutting_length,
        length,
        shank_diameter: diameter,
        holder: vec![
            Revolved { from: length, to: length + 45.0, radius_from: holder, radius_to: holder + 3.0 },
            Revolved { from: length + 45.0, to: length + 75.0, radius_from: 25.0, radius_to: 25.0 },
        ],
        speed: 18000.0,
        feeds: Feeds { approach: 5000.0, plunge: 1500.0, cut: 3000.0, lift: 4000.0 },
    }
}

/// A gantry with A about Z (clockwise from above) and B tilting from +Z towards +Y, tools T1 drill 4, T2 engraver,
/// T3 drill 3 long, T10 end mill 20.
pub(crate) fn test_machine() -> Machine {
    let drill = ToolKind::Drill { point_angle: 118.0 };
    Machine {
        name: "Test machine".into(),
        linear: [
            Axis { letter: 'X', min: -150.0, max: 1650.0 },
            Axis { letter: 'Y', min: -150.0, max: 3150.0 },
            Axis { letter: 'Z', min: -19.0, max: 1181.0 },
        ],
        primary: Rotary { letter: 'A', about: DVec3::Z, sign: -1.0, min: -360.0, max: 360.0 },
        secondary: Rotary { letter: 'B', about: DVec3::X, sign: -1.0, min: -120.0, max: 120.0 },
        tip_control: true,
        pivot: 210.0,
        safe_height: 60.0,
        headroom: 1200.0,
        table: Table {
            min: DVec3::new(-200.0, -200.0, -119.0),
            max: DVec3::new(1700.0, 3200.0, -19.0),
            sacrificial: 19.0,
        },
        clamps: Vec::new(),
        spindle: vec![Revolved { from: 0.0, to: 300.0, radius_from: 60.0, radius_to: 60.0 }],
        tools: vec![
            tool(1, drill, 4.0, 45.0, 65.0, 9.0),
            tool(2, ToolKind::Engraver { tip_angle: 45.0 }, 6.0, 7.0, 50.0, 9.0),
            tool(3, drill, 3.0, 70.0, 85.0, 9.0),
            tool(10, ToolKind::EndMill, 20.0, 65.0, 95.0, 20.0),
        ],
    }
}
