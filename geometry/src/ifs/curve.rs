//! The figure that a scheme draws: homogeneous points in strips, and the word that names each segment (000 §5.3).

use super::error::CurveError;
use crate::shared::Shared;
use glam::{DVec3, DVec4, Vec4Swizzles};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// A polyline, or several, in homogeneous coordinates. Segments are counted along the strips, in the order in which
/// they are drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Homogeneous points (WX, WY, WZ, W), all W > 0, in drawing order. A closed curve does not repeat its first point.
    pub points: Shared<DVec4>,
    /// Where each strip starts; one longer than the number of strips, first entry 0.
    pub strip_start: Shared<u32>,
    /// Whether the last point is joined to the first (a single strip of at least 3 points then).
    pub closed: bool,
    /// Names of the segments.
    pub words: Words,
}

/// In which order, and in which direction, the transformed copies of a figure are drawn so that neighbours meet.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Traversal {
    /// Transformations in drawing order.
    pub letters: Vec<u32>,
    /// Whether the copy made by each transformation (by its number) is drawn from end to start.
    pub reversed: Vec<bool>,
}

impl Traversal {
    /// The transformation drawn at `position`, and whether its copy is drawn backwards, in a figure that is itself drawn
    /// forwards or `backwards`.
    pub(crate) fn step(&self, position: usize, backwards: bool) -> (usize, bool) {
        let at = if backwards { self.letters.len() - 1 - position } else { position };
        let letter = self.letters[at] as usize;
        (letter, backwards ^ self.reversed[letter])
    }
}

/// Names of all segments of a curve in compact form: every patch has `base`ᵈⁱᵍⁱᵗˢ elements of `parts` segments.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Words {
    /// Number of transformations, k.
    pub base: u32,
    /// Number of iterations, n.
    pub digits: u32,
    /// Segments of the germ.
    pub parts: u32,
    /// Drawing order of the transformations.
    pub traversal: Traversal,
}

/// The name of one segment: the word of transformation indices that made its element (000 §3.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Word {
    /// Patch, from 0.
    pub patch: u32,
    /// Number of transformations, k.
    pub base: u32,
    /// Length of the word, n.
    pub digits: u32,
    /// The word as a number of `digits` digits to the base k, the transformation applied last to the control points
    /// (the coarsest) first.
    pub index: u64,
    /// Segments per element.
    pub parts: u32,
    /// Segment of the germ within the element, from 0.
    pub part: u32,
}

/// `patch/word`, counting from 1 as the thesis does: `1/1221`. Digits of more than nine transformations are separated
/// by dots; a germ of several segments adds `#segment`.
impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/", self.patch + 1)?;
        let base = u64::from(self.base.max(1));
        for place in (0..self.digits).rev() {
            let digit = base.checked_pow(place).map_or(0, |p| self.index / p) % base;
            write!(f, "{}", digit + 1)?;
            if base > 9 && place > 0 {
                write!(f, ".")?;
            }
        }
        if self.parts > 1 {
            write!(f, "#{}", self.part + 1)?;
        }
        Ok(())
    }
}

impl Words {
    /// The name of segment `segment` in drawing order. O(digits).
    #[must_use]
    pub fn word(&self, segment: usize) -> Word {
        let (base, parts) = (self.base as usize, self.parts as usize);
        let elements = base.pow(self.digits);
        let (element, part) = (segment / parts, segment % parts);
        let (patch, mut rest) = (element / elements, element % elements);
        let (mut index, mut backwards, mut weight) = (0_u64, false, elements);
        for _ in 0..self.digits {
            weight /= base;
            let letter;
            (letter, backwards) = self.traversal.step(rest / weight, backwards);
            rest %= weight;
            index = index * base as u64 + letter as u64;
        }
        let part = if backwards { parts - 1 - part } else { part } as u32;
        Word { patch: patch as u32, base: self.base, digits: self.digits, index, parts: self.parts, part }
    }
}

impl Curve {
    /// A curve of given homogeneous points in one strip: an element by itself, whose germ is the polyline. Segment `i`
    /// is named `1/#i+1`.
    ///
    /// # Errors
    /// [`CurveError::TooFewPoints`], [`CurveError::NotFinite`], [`CurveError::Weight`] (W ≤ 0).
    pub fn polyline(points: Vec<DVec4>, closed: bool) -> Result<Self, CurveError> {
        let end = u32::try_from(points.len()).unwrap_or(u32::MAX);
        Self::strips_of(points, vec![0, end], closed)
    }

    /// The same of several strips: `strip_start` holds the first point of each, then the number of points. Segments are
    /// named in drawing order, as of one polyline. A curve of several strips cannot be closed.
    ///
    /// # Errors
    /// As [`Curve::polyline`], for every strip; [`CurveError::Strips`].
    pub fn strips_of(
        points: impl Into<Shared<DVec4>>,
        strip_start: impl Into<Shared<u32>>,
        closed: bool,
    ) -> Result<Self, CurveError> {
        let (points, strip_start) = (points.into(), strip_start.into());
        let needed = if closed { 3 } else { 2 };
        let strips = strip_start.len().saturating_sub(1);
        let ends = [strip_start.first(), strip_start.last()].map(|e| e.map(|e| *e as usize));
        if ends != [Some(0), Some(points.len())] || closed && strips != 1 {
            return Err(CurveError::Strips { strips, points: points.len(), closed });
        }
        let lengths = strip_start.windows(2).map(|w| (w[1] as usize).saturating_sub(w[0] as usize));
        if let Some(given) = lengths.min().filter(|least| *least < needed) {
            return Err(CurveError::TooFewPoints { given, needed, closed });
        }
        let segments = points.len() - if closed { 0 } else { strips };
        if segments > super::MAX_SEGMENTS {
            return Err(CurveError::TooManySegments { iterations: 0, limit: super::MAX_SEGMENTS, largest: 0 });
        }
        let traversal = Traversal { letters: vec![0], reversed: vec![false] };
        let words = Words { base: 1, digits: 0, parts: segments as u32, traversal };
        for (i, p) in points.iter().enumerate() {
            if !p.is_finite() {
                return Err(CurveError::NotFinite { patch: 0, control: i });
            }
            if !drawable(*p) {
                return Err(CurveError::Weight { word: words.word(i.min(segments - 1)), weight: p.w });
            }
        }
        Ok(Self { points, strip_start, closed, words })
    }

    /// Number of strips.
    #[must_use]
    pub fn strip_count(&self) -> usize {
        self.strip_start.len().saturating_sub(1)
    }

    /// Index ranges of the strips' points.
    pub fn strips(&self) -> impl ExactSizeIterator<Item = Range<usize>> + '_ {
        self.strip_start.windows(2).map(|w| w[0] as usize..w[1] as usize)
    }

    /// Number of segments.
    #[must_use]
    pub fn segment_count(&self) -> usize {
        self.points.len() - if self.closed { 0 } else { self.strip_count() }
    }

    /// The two points of segment `segment`, in drawing order; `None` when there is no such segment. O(log strips).
    #[must_use]
    pub fn segment(&self, segment: usize) -> Option<(usize, usize)> {
        if segment >= self.segment_count() {
            return None;
        }
        if self.closed {
            return Some((segment, (segment + 1) % self.points.len()));
        }
        // Strip t has its points from strip_start[t], hence its segments from strip_start[t] - t.
        let (mut low, mut high) = (0, self.strip_count());
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.strip_start[middle] as usize - middle <= segment { low = middle } else { high = middle }
        }
        Some((segment + low, segment + low + 1))
    }

    /// The name of segment `segment`; `None` when there is no such segment. O(iterations).
    #[must_use]
    pub fn word(&self, segment: usize) -> Option<Word> {
        (segment < self.segment_count()).then(|| self.words.word(segment))
    }

    /// The points in space, mm: (WX, WY, WZ) / W. All are finite. O(points).
    #[must_use]
    pub fn projected(&self) -> Vec<DVec3> {
        self.points.par_iter().with_min_len(1 << 14).map(|p| p.xyz() / p.w).collect()
    }
}

/// Whether a homogeneous point has a place in space.
#[inline]
pub(crate) fn drawable(p: DVec4) -> bool {
    p.w > 0.0 && (p.xyz() * p.w.recip()).is_finite()
}
