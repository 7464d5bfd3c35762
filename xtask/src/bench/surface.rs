//! The curve and the vector sum of the chain suite, beside numpy.

use super::figure::{Figure, median_ms};
use super::peer;
use tenon_geometry::ifs::{Preset, Scheme, homogeneous, iterate};
use tenon_geometry::surface::vector_sum;
use tenon_geometry::{DVec3, DVec4};

const ROUNDS: usize = 15;

/// 2^20 segments.
const ITERATIONS: u32 = 20;

/// Points of each curve of the vector sum: a million vertices.
const POINTS: u32 = 1000;

/// Measures both and prints their figures.
pub fn run() -> Result<(), String> {
    let numpy = peer::numpy(ITERATIONS, POINTS);
    let control: Vec<DVec4> = [[0.0, 0.0, 0.0], [300.0, 500.0, 0.0], [700.0, 500.0, 100.0], [1000.0, 0.0, 0.0]]
        .map(|p| homogeneous(DVec3::from_array(p), 1.0))
        .to_vec();
    let scheme = Scheme::preset(Preset::Bezier { degree: 3 }).map_err(|e| e.to_string())?;
    let patches = [control];
    let curve = median_ms(
        ROUNDS,
        |_| Ok(()),
        |()| iterate(&scheme, &patches, ITERATIONS, 1e-9, &|_| true).map(|c| c.projected()).map_err(|e| e.to_string()),
    )?;
    let a = arc(|t| DVec3::new(t, (t / 200.0).sin(), 0.0))?;
    let b = arc(|t| DVec3::new(0.0, t, (t / 300.0).cos()))?;
    let sum =
        median_ms(ROUNDS, |_| Ok(()), |()| vector_sum(&a, &b, DVec3::ZERO, &|_| true).map_err(|e| e.to_string()))?;
    let name = numpy.as_ref().map(|n| n.name.clone());
    let figure = |case, size, ours, theirs, target| Figure {
        suite: "chain",
        case,
        size,
        ours,
        unit: "ms",
        peer: name.clone(),
        theirs,
        target: Some(target),
    };
    figure("curve", 1 << ITERATIONS, curve, numpy.as_ref().map(|n| n.curve_ms), 20.0).print();
    let vertices = u64::from(POINTS) * u64::from(POINTS);
    figure("vector_sum", vertices, sum, numpy.as_ref().map(|n| n.vector_sum_ms), 30.0).print();
    Ok(())
}

/// A curve of [`POINTS`] points along `place`, parameter 0 to 1000 mm.
fn arc(place: impl Fn(f64) -> DVec3) -> Result<tenon_geometry::ifs::Curve, String> {
    let step = 1000.0 / f64::from(POINTS - 1);
    let points = (0..POINTS).map(|i| homogeneous(place(f64::from(i) * step), 1.0)).collect();
    tenon_geometry::ifs::Curve::polyline(points, false).map_err(|e| e.to_string())
}
