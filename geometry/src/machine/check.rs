//! Whether a machine description makes sense, with what is wrong and what would do.

use super::{Machine, Revolved, ToolKind};

/// What is wrong with a machine description: where (as in the file) and what would work.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {problem}")]
pub struct MachineError {
    /// Place in the description, such as `tools[2].holder[0]`.
    pub at: String,
    /// What is wrong and what would work.
    pub problem: String,
}

fn wrong(at: impl Into<String>, problem: impl Into<String>) -> MachineError {
    MachineError { at: at.into(), problem: problem.into() }
}

/// A stack of frustums: finite, growing upwards.
fn revolved(at: &str, bodies: &[Revolved], start: f64) -> Result<(), MachineError> {
    let mut top = start;
    for (k, r) in bodies.iter().enumerate() {
        let here = format!("{at}[{k}]");
        if ![r.from, r.to, r.radius_from, r.radius_to].iter().all(|x| x.is_finite()) {
            return Err(wrong(here, "all four numbers must be finite"));
        }
        if r.from < top - 1e-9 {
            return Err(wrong(here, format!("starts at {} mm, below {top} mm where the part before it ends", r.from)));
        }
        if r.to <= r.from {
            return Err(wrong(here, format!("ends at {} mm, which is not above its start at {} mm", r.to, r.from)));
        }
        if r.radius_from < 0.0 || r.radius_to < 0.0 {
            return Err(wrong(here, "a radius must not be negative"));
        }
        top = r.to;
    }
    Ok(())
}

impl Machine {
    /// Checks that limits are in order, directions are unit vectors, letters and tool numbers are unique and bodies are
    /// stacked from the tip up. O(tools).
    ///
    /// # Errors
    /// The first thing wrong, with its place and what would work.
    pub fn check(&self) -> Result<(), MachineError> {
        let mut letters = Vec::new();
        for (k, axis) in self.linear.iter().enumerate() {
            let at = format!("linear[{k}]");
            if axis.min.is_nan() || axis.max.is_nan() || axis.min >= axis.max {
                return Err(wrong(at, format!("min {} must be below max {}", axis.min, axis.max)));
            }
            letters.push((at, axis.letter));
        }
        for (at, axis) in [("primary", &self.primary), ("secondary", &self.secondary)] {
            if !axis.min.is_finite() || !axis.max.is_finite() || axis.min >= axis.max {
                return Err(wrong(at, format!("min {} must be below max {} (degrees)", axis.min, axis.max)));
            }
            if axis.sign.abs() != 1.0 {
                return Err(wrong(format!("{at}.sign"), format!("must be 1 or -1, not {}", axis.sign)));
            }
            if !axis.about.is_finite() || (axis.about.length() - 1.0).abs() > 1e-9 {
                let problem = format!("must be a vector of length 1, not {}", axis.about);
                return Err(wrong(format!("{at}.about"), problem));
            }
            letters.push((at.to_owned(), axis.letter));
        }
        if self.primary.about.cross(self.secondary.about).length() < 1e-6 {
            return Err(wrong("secondary.about", "must not be parallel to primary.about"));
        }
        for (k, (at, letter)) in letters.iter().enumerate() {
            if !"XYZABCUVW".contains(*letter) {
                return Err(wrong(format!("{at}.letter"), format!("'{letter}' is not one of X Y Z A B C U V W")));
            }
            if let Some((other, _)) = letters[..k].iter().find(|(_, l)| l == letter) {
                return Err(wrong(format!("{at}.letter"), format!("'{letter}' is already the letter of {other}")));
            }
        }
        let t = &self.table;
        if !t.min.is_finite() || !t.max.is_finite() || t.min.cmpge(t.max).any() {
            return Err(wrong("table", format!("min {} must be below max {} in x, y and z", t.min, t.max)));
        }
        if !(t.sacrificial >= 0.0 && t.sacrificial.is_finite()) {
            return Err(wrong("table.sacrificial", format!("must be 0 mm or more, not {}", t.sacrificial)));
        }
        if t.max.z > -t.sacrificial + 1e-9 {
            let problem =
                format!("{} mm lies above the underside of the sacrificial layer ({} mm)", t.max.z, -t.sacrificial);
            return Err(wrong("table.max", problem));
        }
        for (k, c) in self.clamps.iter().enumerate() {
            if !c.min.is_finite() || !c.max.is_finite() || c.min.cmpge(c.max).any() {
                return Err(wrong(format!("clamps[{k}]"), "min must be below max in x, y and z"));
            }
        }
        if !(self.safe_height > 0.0 && self.safe_height <= self.linear[2].max) {
            let problem =
                format!("{} mm must lie above 0 and within Z (to {} mm)", self.safe_height, self.linear[2].max);
            return Err(wrong("safe_height", problem));
        }
        if !(self.headroom > self.safe_height && self.headroom.is_finite()) {
            let problem = format!("{} mm must lie above the safe height ({} mm)", self.headroom, self.safe_height);
            return Err(wrong("headroom", problem));
        }
        if !(self.pivot >= 0.0 && self.pivot.is_finite()) {
            return Err(wrong("pivot", format!("must be 0 mm or more, not {}", self.pivot)));
        }
        revolved("spindle", &self.spindle, 0.0)?;
        self.tools.iter().enumerate().try_for_each(|(k, _)| self.check_tool(k))
    }

    fn check_tool(&self, k: usize) -> Result<(), MachineError> {
        let tool = &self.tools[k];
        let at = format!("tools[{k}]");
        if let Some(other) = self.tools[..k].iter().position(|t| t.number == tool.number) {
            let problem = format!("{} is already the number of tools[{other}]", tool.number);
            return Err(wrong(format!("{at}.number"), problem));
        }
        let positive = [
            ("diameter", tool.diameter),
            ("cutting_length", tool.cutting_length),
            ("shank_diameter", tool.shank_diameter),
            ("speed", tool.speed),
            ("feeds.approach", tool.feeds.approach),
            ("feeds.plunge", tool.feeds.plunge),
            ("feeds.cut", tool.feeds.cut),
            ("feeds.lift", tool.feeds.lift),
        ];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(wrong(format!("{at}.{name}"), format!("must be more than 0, not {value}")));
            }
        }
        if !(tool.length >= tool.cutting_length && tool.length.is_finite()) {
            let problem =
                format!("{} mm must not be less than the cutting length {} mm", tool.length, tool.cutting_length);
            return Err(wrong(format!("{at}.length"), problem));
        }
        if let ToolKind::Drill { point_angle: angle } | ToolKind::Engraver { tip_angle: angle } = tool.kind
            && !(angle > 0.0 && angle <= 180.0)
        {
            return Err(wrong(format!("{at}.kind"), format!("the full tip angle must lie in 0..180°, not {angle}°")));
        }
        revolved(&format!("{at}.holder"), &tool.holder, tool.length)
    }
}

#[cfg(test)]
mod tests {
    use crate::machine::{Machine, test_machine};

    fn refused(change: impl FnOnce(&mut Machine)) -> String {
        let mut m = test_machine();
        m.check().unwrap();
        change(&mut m);
        m.check().unwrap_err().to_string()
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(refused(|m| m.linear[1].min = 5000.0).starts_with("linear[1]"));
        assert!(refused(|m| m.primary.sign = 0.5).starts_with("primary.sign"));
        assert!(refused(|m| m.secondary.letter = 'A').contains("already the letter of primary"));
        assert!(refused(|m| m.tools[1].number = m.tools[0].number).starts_with("tools[1].number"));
        assert!(refused(|m| m.tools[0].holder[0].from = 1.0).starts_with("tools[0].holder[0]"));
        assert!(refused(|m| m.tools[0].diameter = -3.0).contains("more than 0"));
        assert!(refused(|m| m.table.max.z = -1.0).starts_with("table.max"));
        assert!(refused(|m| m.safe_height = f64::NAN).starts_with("safe_height"));
    }
}
