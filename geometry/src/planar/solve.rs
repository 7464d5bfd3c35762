//! Planarizing: vertices move, as little and as smoothly as they can, until faces are planar.

use super::descent::descend;
use super::energy::{Bends, Energy, Weights};
use super::{Planarity, PlanarizeError, PlanarizeParams, Planarized, Rim};
use crate::mesh::{Adjacency, Front, Mesh, orient};
use glam::DVec3;

/// Makes the faces of a mesh planar.
///
/// Minimises closeness Σ |d|² + fairness Σ |bend of d|² over the displacements d, subject to one planarity equation per
/// quad (the distance of its diagonals vanishes; n-gons: distances from Newell's plane). The move of each vertex is
/// bounded and the corners of every face stay convex, seen along its first normal, by smooth barriers; every step that
/// would break one is shortened, so no face can fold over or turn concave. Faces that are concave from the start are
/// planarized as they are.
///
/// The method is Gauss-Newton on a quadratic penalty that hardens tenfold a step, with second-order correction (as in
/// SQP), and at the end pure Newton restoration of least norm. Each step solves one linear system: planarity is eliminated
/// exactly by a sparse Cholesky factor of J G⁻¹ Jᵀ (one row a quad), the rest by conjugate gradients with that as
/// preconditioner. Planarity equations are as ill-conditioned as plate bending (∼ n⁴ for n × n quads), so that plain
/// conjugate gradients, ShapeUp (Bouaziz 2012) and perturbation (000 §8.3.2) crawl; guided projection (Tang 2014) factors a
/// system in all vertices and normals, six unknowns a face instead of one. Measured on domes, waves, saddles and noise of
/// 8 × 8 to 32 × 32: 6 to 29 steps to 1e-4 mm with a reach of 0.5, 1 or 5 edges; see `PlanarizeParams::reach` for what a
/// tight bound costs.
///
/// If the threshold is not reached the result holds the best points found and says how far they are. A mesh that is
/// planar already comes back bit by bit. O(n^1.5) time per step for the factor (in practice linear up to some ten
/// thousand faces) and O(n log n) memory. `progress` is asked several times a step.
///
/// # Errors
/// `BadParameter`, `NoSuch`; `Mesh` for broken, non-manifold or one-sided meshes; `NoArea` for a face of the region
/// without a normal; `Cancelled`.
pub fn planarize(
    mesh: &Mesh,
    params: &PlanarizeParams,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Planarized, PlanarizeError> {
    check(mesh, params)?;
    let before = Planarity::measure(mesh)?;
    // Mixed orientation does no harm here, but neighbours are needed: an oriented copy has the same vertices.
    let oriented = orient(mesh, Front::AsGiven)?.mesh;
    let adjacency = Adjacency::new(&oriented)?;
    let region = region_faces(mesh, params);
    if let Some(face) = (0..mesh.face_count()).find(|&f| region[f] && has_no_area(mesh, f)) {
        return Err(PlanarizeError::NoArea { face: face as u32 });
    }
    let free = free_vertices(mesh, &oriented, &adjacency, &region, params);
    let edge = mean_edges(&oriented, &adjacency);
    let loops: Vec<Vec<u32>> = (0..mesh.face_count())
        .filter(|&f| region[f] && mesh.face(f).len() > 3 && mesh.face(f).iter().any(|&v| free[v as usize]))
        .map(|f| mesh.face(f).to_vec())
        .collect();
    let first = worst(&before, &region).0;

    let mut out = mesh.clone();
    let mut history = vec![first];
    if first > params.threshold && !loops.is_empty() {
        let unit = mean(loops.iter().flatten().map(|&v| edge[v as usize]));
        let base = mesh.points[loops[0][0] as usize];
        let origin: Vec<DVec3> = mesh.points.iter().map(|p| (*p - base) / unit).collect();
        let weights = Weights {
            // A vertex that nothing holds would make the system singular.
            closeness: params.closeness.max(1e-9 * params.fairness),
            fairness: params.fairness,
            reach: edge.iter().map(|e| params.reach * e / unit).collect(),
        };
        let watched: Vec<Vec<u32>> = (0..mesh.face_count())
            .filter(|&f| mesh.face(f).iter().any(|&v| free[v as usize]))
            .map(|f| mesh.face(f).to_vec())
            .collect();
        let bends = bends(&oriented, &adjacency, &free);
        let movable = (0..mesh.points.len() as u32).filter(|&v| free[v as usize]).collect();
        let energy = Energy::new(&origin, movable, bends, &watched, &weights);
        let found = descend(origin.clone(), &loops, energy, params.threshold / unit, params.iterations, progress)
            .ok_or(PlanarizeError::Cancelled)?;
        let points = out.points.to_mut();
        for v in (0..points.len()).filter(|&v| free[v]) {
            points[v] += (found.points[v] - origin[v]) * unit;
        }
        history.extend(found.history[1..].iter().map(|d| d * unit));
    }

    let after = Planarity::measure(&out)?;
    let (deviation, worst_face) = worst(&after, &region);
    let moved: Vec<f64> = mesh.points.iter().zip(&out.points).map(|(p, q)| p.distance(*q)).collect();
    let free_count = free.iter().filter(|f| **f).count().max(1) as f64;
    Ok(Planarized {
        reached: deviation <= params.threshold,
        deviation,
        worst_face,
        before,
        after,
        moved_max: moved.iter().copied().fold(0.0, f64::max),
        moved_rms: (moved.iter().map(|m| m * m).sum::<f64>() / free_count).sqrt(),
        moved_edges: moved.iter().zip(&edge).filter(|(m, _)| **m > 0.0).map(|(m, e)| m / e).fold(0.0, f64::max),
        fold_before: greatest_fold(&oriented, &oriented.points, &adjacency),
        fold_after: greatest_fold(&oriented, &out.points, &adjacency),
        turned: (0..mesh.face_count())
            .filter_map(|f| Some(mesh.face_normal(f)?.angle_between(out.face_normal(f)?)))
            .fold(0.0, f64::max),
        iterations: history.len() as u32 - 1,
        history,
        mesh: out,
    })
}

fn check(mesh: &Mesh, params: &PlanarizeParams) -> Result<(), PlanarizeError> {
    let positive = "a positive number";
    let weight = "0 or a positive number";
    for (name, value, range, good) in [
        ("threshold", params.threshold, positive, params.threshold > 0.0),
        ("reach", params.reach, positive, params.reach > 0.0),
        ("closeness", params.closeness, weight, params.closeness >= 0.0),
        ("fairness", params.fairness, weight, params.fairness >= 0.0),
    ] {
        if !good || !value.is_finite() {
            return Err(PlanarizeError::BadParameter { name, value, range });
        }
    }
    if params.closeness + params.fairness == 0.0 {
        let range = "positive where fairness is 0";
        return Err(PlanarizeError::BadParameter { name: "closeness", value: 0.0, range });
    }
    let faces = params.region.iter().flatten().map(|&f| ("face", f, mesh.face_count()));
    let vertices = params.fixed.iter().map(|&v| ("vertex", v, mesh.points.len()));
    match faces.chain(vertices).find(|&(_, index, count)| index as usize >= count) {
        Some((what, index, count)) => Err(PlanarizeError::NoSuch { what, index, count }),
        None => Ok(()),
    }
}

fn region_faces(mesh: &Mesh, params: &PlanarizeParams) -> Vec<bool> {
    let mut region = vec![params.region.is_none(); mesh.face_count()];
    params.region.iter().flatten().for_each(|&f| region[f as usize] = true);
    region
}

fn has_no_area(mesh: &Mesh, f: usize) -> bool {
    let size = mesh.face_points(f).zip(mesh.face_points(f).skip(1)).map(|(p, q)| p.distance_squared(q)).sum::<f64>();
    // Less than rounding could make of nothing.
    mesh.face_area_vector(f).length() <= 1e-13 * size
}

/// Which vertices may move.
fn free_vertices(
    mesh: &Mesh,
    oriented: &Mesh,
    adjacency: &Adjacency,
    region: &[bool],
    params: &PlanarizeParams,
) -> Vec<bool> {
    let mut free = vec![false; mesh.points.len()];
    let vertices = |inside: bool| {
        (0..mesh.face_count()).filter(move |&f| region[f] == inside).flat_map(|f| mesh.face(f).iter().copied())
    };
    vertices(true).for_each(|v| free[v as usize] = true);
    if params.rim == Rim::Fixed {
        vertices(false).for_each(|v| free[v as usize] = false);
    }
    if params.border == Rim::Fixed {
        for c in adjacency.border().flat_map(|c| [c, adjacency.next(c)]) {
            free[oriented.face_vertices[c as usize] as usize] = false;
        }
    }
    params.fixed.iter().for_each(|&v| free[v as usize] = false);
    free
}

/// Mean length of the edges at each vertex, 0 at a vertex without edges.
fn mean_edges(mesh: &Mesh, adjacency: &Adjacency) -> Vec<f64> {
    let mut sum = vec![(0.0, 0u32); mesh.points.len()];
    for c in adjacency.edges() {
        let ends = [c, adjacency.next(c)].map(|c| mesh.face_vertices[c as usize] as usize);
        let length = mesh.points[ends[0]].distance(mesh.points[ends[1]]);
        for v in ends {
            sum[v].0 += length;
            sum[v].1 += 1;
        }
    }
    sum.iter().map(|&(length, count)| length / f64::from(count.max(1))).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count.max(1))
}

/// Where the smoothness of displacements is judged: along both lines through a regular vertex, along the border, and
/// around an irregular vertex as a whole.
fn bends(mesh: &Mesh, adjacency: &Adjacency, free: &[bool]) -> Bends {
    let head = |c: u32| mesh.face_vertices[adjacency.next(c) as usize];
    let tail = |c: u32| mesh.face_vertices[adjacency.previous(c) as usize];
    let turn = |c: u32| adjacency.twin(adjacency.previous(c));
    let mut bends = Bends::default();
    let mut push = |row: &[u32]| {
        if row.iter().any(|&v| free[v as usize]) {
            bends.push(row);
        }
    };
    for v in 0..mesh.points.len() as u32 {
        let fan = adjacency.corners_at(v);
        let rim = fan.iter().find(|&&c| adjacency.twin(c).is_none());
        let end = fan.iter().find(|&&c| turn(c).is_none());
        match (rim, end, fan) {
            (Some(&rim), Some(&end), [_, _, ..]) => push(&[v, head(rim), tail(end)]),
            (None, None, &[c, _, _, _]) => {
                let around: Vec<u32> = std::iter::successors(Some(c), |&c| turn(c)).take(4).map(head).collect();
                if let [a, b, c, d] = *around.as_slice() {
                    push(&[v, a, c]);
                    push(&[v, b, d]);
                }
            }
            (None, None, [_, ..]) => push(&std::iter::once(v).chain(fan.iter().map(|&c| head(c))).collect::<Vec<_>>()),
            _ => {}
        }
    }
    bends
}

/// Greatest deviation in the region and the face that has it.
fn worst(planarity: &Planarity, region: &[bool]) -> (f64, u32) {
    let faces = planarity.corner.iter().zip(region).enumerate().filter(|(_, (_, inside))| **inside);
    faces.fold((0.0, 0), |worst, (f, (&d, _))| if d > worst.0 { (d, f as u32) } else { worst })
}

/// Greatest angle between the normals of neighbours.
fn greatest_fold(mesh: &Mesh, points: &[DVec3], adjacency: &Adjacency) -> f64 {
    let normal = |f: usize| crate::mesh::area_vector(mesh.face(f).iter().map(|&v| points[v as usize])).try_normalize();
    let normals: Vec<Option<DVec3>> = (0..mesh.face_count()).map(normal).collect();
    let fold = |c: u32| {
        let across = adjacency.twin(c)?;
        let pair = [c, across].map(|c| normals[adjacency.face_of(c) as usize]);
        Some(pair[0]?.angle_between(pair[1]?))
    };
    adjacency.edges().filter_map(fold).fold(0.0, f64::max)
}

#[cfg(test)]
#[path = "solve_tests.rs"]
mod tests;
