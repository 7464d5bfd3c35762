//! Ordering: shuffled soups give the same addresses; rings, tori, patches and meshes that are no grid.

use super::*;
use proptest::prelude::*;

/// A curved grid, faces in random order, loops rotated, every face with vertices of its own.
fn soup(mesh: &Mesh, seed: u64, turn_over: bool) -> Mesh {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let mut random = move |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let mut faces: Vec<usize> = (0..mesh.face_count()).collect();
    for i in (1..faces.len()).rev() {
        faces.swap(i, random(i + 1));
    }
    let mut out = Mesh { face_start: vec![0].into(), ..Mesh::default() };
    for f in faces {
        let corners = mesh.face(f);
        let (n, turn, over) = (corners.len(), random(corners.len()), turn_over && random(2) == 1);
        for k in 0..n {
            let k = if over { n - k } else { k };
            out.face_vertices.to_mut().push(out.points.len() as u32);
            out.points.to_mut().push(mesh.points[corners[(k + turn) % n] as usize]);
        }
        out.face_start.to_mut().push(out.points.len() as u32);
    }
    out
}

fn grid_with(rows: u32, columns: u32, point: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let width = columns + 1;
    let points = (0..=rows).flat_map(|r| (0..width).map(move |c| (c, r)));
    let points = points.map(|(c, r)| point(f64::from(c), f64::from(r))).collect();
    let mut faces = Vec::new();
    for r in 0..rows {
        for c in 0..columns {
            let v = r * width + c;
            faces.push([v, v + 1, v + 1 + width, v + width]);
        }
    }
    Mesh::from_faces(points, &faces)
}

fn curved(x: f64, y: f64) -> DVec3 {
    DVec3::new(100.0 * x, 110.0 * y, 20.0 * (x * 0.7).sin() * (1.0 + 0.1 * y) + 3.0 * (y * 1.3).cos())
}

/// Loops as positions, with addresses: what must not depend on the soup.
fn reading(ordered: &Ordered) -> Vec<(Address, Vec<DVec3>)> {
    let mesh = &ordered.mesh;
    (0..mesh.face_count()).map(|f| (mesh.addresses[f], mesh.face_points(f).collect())).collect()
}

fn assert_rows_fit(ordered: &Ordered) {
    for patch in &ordered.patches {
        let index = |r: u32, c: u32| patch.first + r * patch.columns + c;
        for r in 0..patch.rows {
            for c in 0..patch.columns {
                let f = index(r, c) as usize;
                let corner = ordered.mesh.face_start[f];
                assert_eq!((ordered.mesh.addresses[f].row, ordered.mesh.addresses[f].column), (r, c));
                let across = |k: u32| ordered.adjacency.twin(corner + k);
                if c + 1 < patch.columns || patch.closing != Closing::Open {
                    assert_eq!(across(1), Some(4 * index(r, (c + 1) % patch.columns) + 3));
                }
                if r + 1 < patch.rows || patch.closing == Closing::RowsAndColumns {
                    assert_eq!(across(2), Some(4 * index((r + 1) % patch.rows, c)));
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn any_soup_of_a_grid_gives_the_same_addresses(
        rows in 1u32..7, columns in 1u32..7, seed in any::<u64>(), turned in any::<bool>(),
    ) {
        let grid = grid_with(rows, columns, curved);
        let params = OrderParams { front: Front::Facing(DVec3::Z), ..OrderParams::default() };
        let straight = order_faces(&grid, &params).unwrap();
        let shuffled = order_faces(&soup(&grid, seed, turned), &params).unwrap();
        prop_assert_eq!(shuffled.kind, OrderKind::Grid);
        prop_assert_eq!(reading(&shuffled), reading(&straight));
        // The grid was written row by row from its bottom left corner.
        prop_assert_eq!(&straight.source, &(0..rows * columns).collect::<Vec<_>>());
        prop_assert_eq!(&straight.mesh.face_vertices, &grid.face_vertices);
        prop_assert_eq!(shuffled.merged as u32, 4 * rows * columns - (rows + 1) * (columns + 1));
        assert_rows_fit(&shuffled);
        for (face, &source) in shuffled.source.iter().enumerate() {
            let soup = soup(&grid, seed, turned);
            let mut from: Vec<_> = soup.face(source as usize).iter().map(|&v| shuffled.vertex[v as usize]).collect();
            let mut to = shuffled.mesh.face(face).to_vec();
            from.sort_unstable();
            to.sort_unstable();
            prop_assert_eq!(from, to);
        }
    }

    #[test]
    fn any_soup_of_a_ring_or_torus_gives_the_same_addresses(
        around in 3u32..9, along in 1u32..6, seed in any::<u64>(), torus in any::<bool>(),
    ) {
        let along = if torus { along + 2 } else { along };
        let tau = std::f64::consts::TAU;
        let shape = grid_with(along, around, |x, y| {
            let (s, c) = (0.3 + tau * (x % f64::from(around)) / f64::from(around)).sin_cos();
            if torus {
                let (t, d) = (0.2 + tau * (y % f64::from(along)) / f64::from(along)).sin_cos();
                DVec3::new((900.0 + 200.0 * d) * c, (900.0 + 200.0 * d) * s, 200.0 * t)
            } else {
                DVec3::new(500.0 * c, 500.0 * s, 90.0 * y)
            }
        });
        let first = order_faces(&shape, &OrderParams::default()).unwrap();
        let other = order_faces(&soup(&shape, seed, false), &OrderParams::default()).unwrap();
        prop_assert_eq!(first.kind, OrderKind::ClosedGrid);
        prop_assert_eq!(first.patches.len(), 1);
        if !torus {
            prop_assert_eq!((first.patches[0].rows, first.patches[0].columns), (along, around));
        }
        let closing = if torus { Closing::RowsAndColumns } else { Closing::Columns };
        prop_assert_eq!(first.patches[0].closing, closing);
        prop_assert_eq!(reading(&other), reading(&first));
        assert_rows_fit(&other);
    }
}

#[test]
fn faces_are_told_corner_border_and_centre() {
    let ordered = order_faces(&grid_with(4, 5, curved), &OrderParams::default()).unwrap();
    let count = |kind| ordered.face_kind.iter().filter(|k| **k == kind).count();
    assert_eq!([FaceKind::Corner, FaceKind::Border, FaceKind::Centre].map(count), [4, 10, 6]);
    assert_eq!(ordered.adjacency.neighbours(0).map(|n| n.is_some()).collect::<Vec<_>>(), [false, true, true, false]);
}

#[test]
fn the_start_may_be_chosen() {
    let grid = grid_with(2, 3, curved);
    let params = OrderParams { start: Start::Near(DVec3::new(300.0, 0.0, 0.0)), ..OrderParams::default() };
    let ordered = order_faces(&grid, &params).unwrap();
    // From the old bottom right corner the old columns are rows.
    assert_eq!((ordered.patches[0].rows, ordered.patches[0].columns), (3, 2));
    assert_eq!(ordered.source, [2, 5, 1, 4, 0, 3]);
}

#[test]
fn an_l_shape_falls_into_three_patches() {
    let full = grid_with(4, 4, curved);
    let faces: Vec<[u32; 4]> =
        (0..16).filter(|f| f % 4 < 2 || f / 4 < 2).map(|f| full.face(f).try_into().unwrap()).collect();
    let shape = Mesh::from_faces(full.points.to_vec(), &faces);
    for seed in 0..8 {
        let ordered = order_faces(&soup(&shape, seed, false), &OrderParams::default()).unwrap();
        assert_eq!(ordered.kind, OrderKind::Patches);
        assert_eq!(ordered.patches.iter().map(|p| (p.rows, p.columns)).collect::<Vec<_>>(), [(2, 2); 3]);
        assert_rows_fit(&ordered);
    }
}

#[test]
fn a_cube_falls_into_its_six_sides() {
    // Each side 2 x 2: only the eight corners of the cube are irregular.
    let mut shape = Mesh { face_start: vec![0].into(), ..Mesh::default() };
    for (axis, sign) in (0..3).flat_map(|a| [(a, -1.0), (a, 1.0)]) {
        let side = grid_with(2, 2, |x, y| {
            let flat = [[x - 1.0, y - 1.0], [y - 1.0, x - 1.0]][usize::from(sign < 0.0)];
            let mut p = [0.0; 3];
            p[axis] = sign;
            p[(axis + 1) % 3] = flat[0];
            p[(axis + 2) % 3] = flat[1];
            DVec3::from(p) * 100.0
        });
        let base = shape.points.len() as u32;
        shape.points.to_mut().extend(&side.points);
        shape.face_vertices.to_mut().extend(side.face_vertices.iter().map(|v| v + base));
        let corners = shape.face_vertices.len() as u32 - 16;
        shape.face_start.to_mut().extend(side.face_start[1..].iter().map(|s| s + corners));
    }
    let ordered = order_faces(&shape, &OrderParams::default()).unwrap();
    assert_eq!((ordered.kind, ordered.patches.len(), ordered.mesh.points.len()), (OrderKind::Patches, 6, 26));
    assert!(ordered.patches.iter().all(|p| (p.rows, p.columns) == (2, 2)));
    assert!(ordered.face_kind.iter().all(|k| *k == FaceKind::Centre));
    assert_rows_fit(&ordered);
}

#[test]
fn triangles_and_twisted_tori_are_plain() {
    let quad = grid_with(1, 1, curved);
    let triangles = Mesh::from_faces(quad.points.to_vec(), &[[0, 1, 2], [1, 3, 2]]);
    let ordered = order_faces(&triangles, &OrderParams::default()).unwrap();
    assert_eq!(ordered.kind, OrderKind::PlainNotQuads);
    assert_eq!(ordered.mesh.addresses[1], Address { patch: 0, row: 0, column: 1 });
    assert_eq!(ordered.adjacency.neighbours(0).flatten().collect::<Vec<_>>(), [1]);

    // A torus of 19 quads whose every row is one and the same spiral.
    let faces: Vec<[u32; 4]> = (0..19).map(|v| [v, v + 1, v + 6, v + 5].map(|v| v % 19)).collect();
    let points = (0..19u32).map(|i| DVec3::new(f64::from(i * 7 % 19), f64::from(i * i % 19), f64::from(i))).collect();
    let ordered = order_faces(&Mesh::from_faces(points, &faces), &OrderParams::default()).unwrap();
    assert_eq!((ordered.kind, ordered.mesh.face_count()), (OrderKind::PlainNoRows, 19));
}

#[test]
fn given_addresses_stay() {
    let mut grid = grid_with(2, 2, curved);
    let address = |row, column| Address { patch: 3, row, column };
    grid.addresses = vec![address(1, 1), address(1, 0), address(0, 1), address(0, 0)].into();
    let ordered = order_faces(&grid, &OrderParams::default()).unwrap();
    assert_eq!((ordered.kind, &ordered.mesh), (OrderKind::Kept, &grid));
    grid.addresses.to_mut()[0] = grid.addresses[1];
    assert_eq!(order_faces(&grid, &OrderParams::default()).unwrap().kind, OrderKind::Grid);
}

#[test]
fn meshes_that_are_no_surface_are_refused() {
    let p = |i: u32| DVec3::new(f64::from(i), f64::from(i * i), 1.0);
    let fins = Mesh::from_faces((0..8).map(p).collect(), &[[0, 1, 2, 3], [1, 0, 4, 5], [0, 1, 6, 7]]);
    let error = order_faces(&fins, &OrderParams::default()).unwrap_err();
    assert_eq!(error, MeshError::NotManifold { edge: [0, 1], faces: vec![0, 1, 2] });
    assert_eq!(
        order_faces(&Mesh { face_start: vec![0].into(), ..Mesh::default() }, &OrderParams::default()).unwrap().kind,
        OrderKind::Patches
    );
}
