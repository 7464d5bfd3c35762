//! The solid that a machine moves: cutter, shank, holder and spindle as frustums about the tool axis, from the tip up.

use super::{Machine, Revolved, Tool, ToolKind};

/// A tool in its machine as frustums measured from the tip, mm: what cuts, and what must never touch wood.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolBody {
    /// What cuts.
    pub cutter: Vec<Revolved>,
    /// Shank between cutter and holder.
    pub shank: Vec<Revolved>,
    /// Holder.
    pub holder: Vec<Revolved>,
    /// Spindle.
    pub spindle: Vec<Revolved>,
}

impl Tool {
    /// Distance from the tip to the spindle nose (the end of the holder, or of the shank without one), mm.
    #[must_use]
    pub fn gauge(&self) -> f64 {
        self.holder.iter().fold(self.length, |top, h| top.max(h.to))
    }

    /// Height of the tip's cone, mm: 0 for a flat tip, never more than the cutting length.
    #[must_use]
    pub fn tip_height(&self) -> f64 {
        let full = match self.kind {
            ToolKind::EndMill => return 0.0,
            ToolKind::Drill { point_angle } => point_angle,
            ToolKind::Engraver { tip_angle } => tip_angle,
        };
        let half = (0.5 * full).to_radians();
        (0.5 * self.diameter / half.tan()).clamp(0.0, self.cutting_length)
    }

    /// The cutting part as frustums from the tip up: cone (drill point or engraver) and cylinder.
    #[must_use]
    pub fn cutter(&self) -> Vec<Revolved> {
        let radius = 0.5 * self.diameter;
        let tip = self.tip_height();
        let mut body = Vec::with_capacity(2);
        let mut radius_at_tip = radius;
        if tip > 0.0 {
            if let ToolKind::Drill { point_angle: full } | ToolKind::Engraver { tip_angle: full } = self.kind {
                radius_at_tip = radius.min(tip * (0.5 * full).to_radians().tan());
            }
            body.push(Revolved { from: 0.0, to: tip, radius_from: 0.0, radius_to: radius_at_tip });
        }
        if self.cutting_length > tip {
            body.push(Revolved { from: tip, to: self.cutting_length, radius_from: radius, radius_to: radius });
        }
        body
    }
}

impl Machine {
    /// The tool with this number.
    #[must_use]
    pub fn tool(&self, number: u32) -> Option<&Tool> {
        self.tools.iter().find(|t| t.number == number)
    }

    /// Everything that moves with `tool`, measured from its tip.
    #[must_use]
    pub fn body(&self, tool: &Tool) -> ToolBody {
        let radius = 0.5 * tool.shank_diameter;
        let shank = Revolved { from: tool.cutting_length, to: tool.length, radius_from: radius, radius_to: radius };
        let gauge = tool.gauge();
        ToolBody {
            cutter: tool.cutter(),
            shank: if shank.to > shank.from { vec![shank] } else { Vec::new() },
            holder: tool.holder.clone(),
            spindle: self.spindle.iter().map(|s| Revolved { from: s.from + gauge, to: s.to + gauge, ..*s }).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::machine::test_machine;

    #[test]
    fn a_drill_has_a_point_and_the_spindle_sits_on_the_holder() {
        let m = test_machine();
        let drill = m.tool(1).unwrap();
        let height = 2.0 / 59f64.to_radians().tan();
        assert!((drill.tip_height() - height).abs() < 1e-12);
        let body = m.body(drill);
        assert_eq!(body.cutter[0].radius_from, 0.0);
        assert!((body.cutter[0].radius_to - 2.0).abs() < 1e-12);
        assert_eq!(body.spindle[0].from, drill.gauge());
    }
}
