//! What every value holds, whoever made it: offsets that end where their array does, indices of what there is, finite
//! coordinates. Both roads by which values cross end here.

use crate::abi::value::{TENON_SIDE_OTHER, tenon_edge, tenon_vec3};
use crate::value::{Curve, Feature, Machining, Mesh, Panels, Table};

/// What is wrong with a value that crossed.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum BadValue {
    /// A pointer is NULL although something is said to be there.
    #[error("{0} is NULL")]
    Null(&'static str),
    /// A pointer does not suit its type.
    #[error("{0} is misaligned")]
    Misaligned(&'static str),
    /// A length or stride that cannot be.
    #[error("{what}: {found} is impossible{hint}")]
    Length {
        /// What.
        what: &'static str,
        /// The length.
        found: u64,
        /// What would be right.
        hint: &'static str,
    },
    /// Offsets that do not begin at 0, fall, or do not end at the array's length.
    #[error("{0} must begin with 0, never fall, and end with the number of entries")]
    Offsets(&'static str),
    /// An index past the end.
    #[error("{what}: {found} is not below {count}")]
    Index {
        /// What.
        what: &'static str,
        /// The index.
        found: u32,
        /// How many there are.
        count: usize,
    },
    /// A text is not UTF-8.
    #[error("{what} is not UTF-8 after byte {after}")]
    Text {
        /// What.
        what: &'static str,
        /// Bytes that are.
        after: usize,
    },
    /// A type, machining or path that there is not.
    #[error("{what} {found} is not known")]
    Unknown {
        /// What.
        what: &'static str,
        /// The number.
        found: u64,
    },
    /// A name that is empty or there twice.
    #[error("{what}: the name \"{found}\" is empty or there twice")]
    Name {
        /// What.
        what: &'static str,
        /// The name.
        found: String,
    },
    /// A buffer that changes hands is given twice.
    #[error("two arrays share memory of one buffer")]
    Shared,
    /// NaN or infinity.
    #[error("{what}: entry {entry} is not finite")]
    NotFinite {
        /// What.
        what: &'static str,
        /// Its index.
        entry: usize,
    },
}

type Sound = Result<(), BadValue>;

fn offsets(offsets: &[u32], end: usize, what: &'static str) -> Sound {
    let good = offsets.first() == Some(&0)
        && offsets.last().map(|e| *e as usize) == Some(end)
        && offsets.windows(2).all(|w| w[0] <= w[1]);
    if good { Ok(()) } else { Err(BadValue::Offsets(what)) }
}

fn below(indices: &[u32], count: usize, what: &'static str) -> Sound {
    match indices.iter().find(|i| **i as usize >= count) {
        Some(&found) => Err(BadValue::Index { what, found, count }),
        None => Ok(()),
    }
}

fn finite(points: &[tenon_vec3], what: &'static str) -> Sound {
    match points.iter().position(|p| !(p.x.is_finite() && p.y.is_finite() && p.z.is_finite())) {
        Some(entry) => Err(BadValue::NotFinite { what, entry }),
        None => Ok(()),
    }
}

impl Curve<'_> {
    pub(crate) fn check(&self) -> Sound {
        offsets(&self.strip_start, self.points.len(), "strip_start")
    }
}

impl Mesh<'_> {
    pub(crate) fn check(&self) -> Sound {
        offsets(&self.face_start, self.face_vertices.len(), "face_start")?;
        if !self.addresses.is_empty() && self.addresses.len() + 1 != self.face_start.len() {
            let found = self.addresses.len() as u64;
            return Err(BadValue::Length { what: "addresses", found, hint: "; one per face, or none" });
        }
        below(&self.face_vertices, self.points.len(), "face_vertices")?;
        finite(&self.points, "mesh points")
    }
}

impl Panels<'_> {
    pub(crate) fn check(&self) -> Sound {
        offsets(&self.corner_start, self.front.len(), "corner_start")?;
        if !self.thickness.is_finite() {
            return Err(BadValue::NotFinite { what: "thickness", entry: 0 });
        }
        let (n, k) = (self.len(), self.front.len());
        let panels = [("address", self.address.len()), ("normal", self.normal.len())].map(|(what, len)| (what, len, n));
        let edges = [
            ("vertex", self.vertex.len()),
            ("chamfer", self.chamfer.len()),
            ("neighbour", self.neighbour.len()),
            ("side", self.side.len()),
            ("back_start", self.back_start.len()),
            ("back_end", self.back_end.len()),
            ("voided", self.voided.len()),
        ]
        .map(|(what, len)| (what, len, k));
        if let Some((what, found, _)) = panels.into_iter().chain(edges).find(|(_, len, wanted)| len != wanted) {
            return Err(BadValue::Length { what, found: found as u64, hint: " beside the others" });
        }
        finite(&self.normal, "normal")?;
        finite(&self.front, "front")?;
        finite(&self.back_start, "back_start")?;
        finite(&self.back_end, "back_end")?;
        if let Some(entry) = self.chamfer.iter().position(|c| !c.offset.is_finite()) {
            return Err(BadValue::NotFinite { what: "chamfer", entry });
        }
        for n in self.neighbour.iter().filter(|n| **n != tenon_edge::NONE) {
            below(&[n.panel], self.len(), "neighbour.panel")?;
            below(&[n.edge], self.corners(n.panel as usize).len(), "neighbour.edge")?;
        }
        if let Some(side) = self.side.iter().find(|s| **s > TENON_SIDE_OTHER) {
            return Err(BadValue::Unknown { what: "side", found: (*side).into() });
        }
        Ok(())
    }
}

impl Table<'_> {
    pub(crate) fn check(&self) -> Sound {
        for (i, a) in self.attributes.iter().enumerate() {
            let lengths = [Some(a.items.len()), a.valid.as_ref().map(|v| v.len())];
            if let Some(found) = lengths.into_iter().flatten().find(|len| *len != self.rows) {
                return Err(BadValue::Length { what: "attribute", found: found as u64, hint: "; one per row" });
            }
            if a.name.is_empty() || self.attributes[..i].iter().any(|b| b.name == a.name) {
                return Err(BadValue::Name { what: "attribute", found: a.name.to_string() });
            }
        }
        Ok(())
    }
}

impl Feature<'_> {
    pub(crate) fn check(&self) -> Sound {
        let (at, line, sizes): (Vec<tenon_vec3>, &[tenon_vec3], [f64; 2]) = match &self.machining {
            Machining::Drill { entry, axis, depth, diameter } => (vec![*entry, *axis], &[], [*depth, *diameter]),
            Machining::Slot { from, to, axis, width, depth } => (vec![*from, *to, *axis], &[], [*depth, *width]),
            Machining::Pocket { outline, axis, depth } => (vec![*axis], outline, [*depth, 0.0]),
            Machining::Contour { line, axis } => (vec![*axis], line, [0.0; 2]),
            Machining::Engraving { origin, along, axis, height, depth, .. } => {
                (vec![*origin, *along, *axis], &[], [*depth, *height])
            }
        };
        finite(&at, "feature")?;
        finite(line, "feature.line")?;
        if sizes.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        Err(BadValue::NotFinite { what: "feature.depth or feature.width", entry: 0 })
    }
}
