//! Joints: machining features, fasteners along edges, hardware, reach.

mod feature;
pub use feature::{Feature, FeatureSet, Hardware, Machining};
