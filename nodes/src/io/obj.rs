//! Wavefront OBJ: polygon meshes in and out, panels out as closed solids.

use std::fmt::Write as _;
use tenon_geometry::DVec3;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;

/// Why an OBJ file cannot be used. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ObjError {
    /// The unit is no positive, finite length.
    #[error("the unit must be a positive length in mm, not {unit_mm}")]
    Unit {
        /// The unit that was given, mm.
        unit_mm: f64,
    },
    /// A word that OBJ does not know, or free-form geometry, which is not read.
    #[error("line {line}: \"{word}\" is no statement of a polygon OBJ file")]
    Statement {
        /// Line.
        line: usize,
        /// The word, shortened.
        word: String,
    },
    /// A vertex with fewer than three numbers.
    #[error("line {line}: a vertex needs three numbers, this one has {found}")]
    Vertex {
        /// Line.
        line: usize,
        /// How many were there.
        found: usize,
    },
    /// Something that is no number, or no finite one.
    #[error("line {line}: \"{word}\" is no finite number")]
    Number {
        /// Line.
        line: usize,
        /// The word, shortened.
        word: String,
    },
    /// A face with fewer than three corners.
    #[error("line {line}: a face needs three corners, this one has {found}")]
    Face {
        /// Line.
        line: usize,
        /// How many were there.
        found: usize,
    },
    /// A corner that is no index at all.
    #[error("line {line}: \"{word}\" is no vertex index")]
    Index {
        /// Line.
        line: usize,
        /// The word, shortened.
        word: String,
    },
    /// A corner that refers to a vertex which is not there.
    #[error("line {line}: vertex {index} does not exist, the file has {vertices} there")]
    NoVertex {
        /// Line.
        line: usize,
        /// The index as written.
        index: i64,
        /// How many vertices there are (for a negative index: up to that line).
        vertices: usize,
    },
    /// More vertices or corners than 32 bit count.
    #[error("line {line}: the mesh has more than 4 294 967 295 vertices or corners")]
    TooLarge {
        /// Line.
        line: usize,
    },
    /// A file without a single face.
    #[error("the file has no faces ({vertices} vertices were read)")]
    NoFaces {
        /// How many vertices there are.
        vertices: usize,
    },
}

/// Statements that say nothing about the polygons: read over.
const IGNORED: [&[u8]; 18] = [
    b"vn",
    b"vt",
    b"vp",
    b"g",
    b"o",
    b"s",
    b"mg",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"l",
    b"p",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
];

/// Reads the polygons of an OBJ file; a length of 1 in the file is `unit_mm` millimetres (1000 for a file in metres).
///
/// Reads `v` and `f` (`i`, `i/j`, `i//k`, `i/j/k`, negative indices, any number of corners, corners that come before
/// their vertex), comments, continued lines (`\`) and either line end. Normals, texture, groups, materials, lines and
/// points are read over. The mesh is as written: nothing is welded, turned or dropped. Cost O(bytes).
///
/// # Errors
/// [`ObjError`] names the line.
pub fn read_obj(bytes: &[u8], unit_mm: f64) -> Result<Mesh, ObjError> {
    if !(unit_mm.is_finite() && unit_mm > 0.0) {
        return Err(ObjError::Unit { unit_mm });
    }
    let mut mesh = Rows { face_start: vec![0], ..Rows::default() };
    let mut ahead = Vec::new();
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut joined = Vec::new();
    for (number, raw) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = number + 1;
        let raw = raw.strip_suffix(b"\r").unwrap_or(raw);
        if let Some(head) = raw.strip_suffix(b"\\") {
            joined.extend_from_slice(head);
            joined.push(b' ');
            continue;
        }
        if joined.is_empty() {
            read_line(&mut mesh, &mut ahead, raw, line, unit_mm)?;
        } else {
            joined.extend_from_slice(raw);
            read_line(&mut mesh, &mut ahead, &joined, line, unit_mm)?;
            joined.clear();
        }
    }
    read_line(&mut mesh, &mut ahead, &joined, bytes.split(|&b| b == b'\n').count(), unit_mm)?;
    for (line, index) in ahead {
        if index as usize > mesh.points.len() {
            return Err(ObjError::NoVertex { line, index, vertices: mesh.points.len() });
        }
    }
    if mesh.face_start.len() == 1 {
        return Err(ObjError::NoFaces { vertices: mesh.points.len() });
    }
    Ok(Mesh {
        points: mesh.points.into(),
        face_start: mesh.face_start.into(),
        face_vertices: mesh.face_vertices.into(),
        ..Mesh::default()
    })
}

/// A mesh that is being read.
#[derive(Default)]
struct Rows {
    points: Vec<DVec3>,
    face_start: Vec<u32>,
    face_vertices: Vec<u32>,
}

/// One statement. `ahead` collects corners whose vertex has not been read yet.
fn read_line(
    mesh: &mut Rows,
    ahead: &mut Vec<(usize, i64)>,
    text: &[u8],
    line: usize,
    unit: f64,
) -> Result<(), ObjError> {
    let text = text.split(|&b| b == b'#').next().unwrap_or(text);
    let mut words = text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
    let Some(keyword) = words.next() else { return Ok(()) };
    match keyword {
        b"v" => {
            let mut xyz = [0.0; 3];
            for (found, x) in xyz.iter_mut().enumerate() {
                let word = words.next().ok_or(ObjError::Vertex { line, found })?;
                *x = number(word)
                    .map(|v| v * unit)
                    .filter(|v| v.is_finite())
                    .ok_or_else(|| ObjError::Number { line, word: shown(word) })?;
            }
            mesh.points.push(DVec3::from_array(xyz));
            u32::try_from(mesh.points.len()).map_err(|_| ObjError::TooLarge { line })?;
        }
        b"f" => {
            let first = mesh.face_vertices.len();
            for word in words {
                let index = corner(word).ok_or_else(|| ObjError::Index { line, word: shown(word) })?;
                let vertices = mesh.points.len();
                let vertex = if index > 0 {
                    if index as usize > vertices {
                        ahead.push((line, index));
                    }
                    index - 1
                } else {
                    vertices as i64 + index
                };
                let vertex = u32::try_from(vertex).map_err(|_| ObjError::NoVertex { line, index, vertices })?;
                mesh.face_vertices.push(vertex);
            }
            let found = mesh.face_vertices.len() - first;
            if found < 3 {
                return Err(ObjError::Face { line, found });
            }
            mesh.face_start.push(u32::try_from(mesh.face_vertices.len()).map_err(|_| ObjError::TooLarge { line })?);
        }
        other if IGNORED.contains(&other) => {}
        other => return Err(ObjError::Statement { line, word: shown(other) }),
    }
    Ok(())
}

/// The vertex index of `i`, `i/j`, `i//k` or `i/j/k`; `None` if it is none of these. 0 is no index.
fn corner(word: &[u8]) -> Option<i64> {
    let mut parts = word.split(|&b| b == b'/');
    let index = integer(parts.next()?)?;
    for (n, part) in parts.enumerate() {
        if n > 1 || !(part.is_empty() || integer(part).is_some()) {
            return None;
        }
    }
    Some(index)
}

fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok().filter(|&i| i != 0)
}

fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as shown in a message: at most 40 characters, so that garbage does not flood the screen.
fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(160)]);
    let clean: String = text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if clean.len() < word.len() { clean + "…" } else { clean }
}

/// Vertices or faces written before it is looked whether to go on.
const CHUNK: usize = 4096;

/// Writes a mesh in millimetres, shortest decimal numbers that read back as the same `f64`. Cost O(corners).
/// Stops early, and what there is then is of no use, when `go` says no.
#[must_use]
pub fn write_obj(mesh: &Mesh, go: &dyn Fn() -> bool) -> Vec<u8> {
    let mut out = String::with_capacity(mesh.points.len() * 56 + mesh.face_vertices.len() * 7 + 64);
    out.push_str("# Tenon mesh, mm\n");
    for points in mesh.points.chunks(CHUNK).take_while(|_| go()) {
        points.iter().for_each(|p| vertex(&mut out, *p));
    }
    for f in (0..mesh.face_count()).take_while(|f| !f.is_multiple_of(CHUNK) || go()) {
        face(&mut out, mesh.face(f), 1);
    }
    out.into_bytes()
}

/// Writes every panel as an object of its own, `o row.column`: a closed solid whose faces (front, back, chamfers, node
/// facets) share their corners and look outwards. Panels that could not be made are left out. Millimetres, shortest
/// round-trip numbers. Cost O(corners). Stops early, and what there is then is of no use, when `go` says no.
#[must_use]
pub fn write_panels_obj(panels: &PanelSet, go: &dyn Fn() -> bool) -> Vec<u8> {
    let mut out = String::from("# Tenon panels, mm\n");
    let mut first = 1;
    for i in (0..panels.len()).filter(|&i| panels.is_valid(i)).take_while(|_| go()) {
        let solid = panels.solid(i);
        let _ = writeln!(out, "o {}", panels.address[i]);
        for p in &solid.points {
            vertex(&mut out, *p);
        }
        for f in 0..solid.face_count() {
            face(&mut out, solid.face(f), first);
        }
        first += solid.points.len() as u64;
    }
    out.into_bytes()
}

fn vertex(out: &mut String, p: DVec3) {
    // Adding 0.0 turns -0 into 0.
    let _ = writeln!(out, "v {} {} {}", p.x + 0.0, p.y + 0.0, p.z + 0.0);
}

fn face(out: &mut String, corners: &[u32], first: u64) {
    out.push('f');
    for &c in corners {
        let _ = write!(out, " {}", u64::from(c) + first);
    }
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Mesh, ObjError> {
        read_obj(text.as_bytes(), 1.0)
    }

    #[test]
    fn reads_all_ways_to_write_a_face() {
        let text = "# quad and triangle\r\nmtllib a.mtl\r\nv 0 0 0\r\nv 1e3 0 0\r\nv 1 1 0 1.0\nvt 0 0\nvn 0 0 1\n\
                    o thing\ng a b\nusemtl m\ns off\nf 1/1/1 2//1 \\\n3/1 4\nv 0 1 -.5\nf -1 -3 -4 # tail\n";
        let mesh = read_obj(text.as_bytes(), 2.0).unwrap();
        assert_eq!(mesh.face_start, [0, 4, 7]);
        assert_eq!(mesh.face_vertices, [0, 1, 2, 3, 3, 1, 0]);
        assert_eq!(mesh.points[1], DVec3::new(2000.0, 0.0, 0.0));
        assert_eq!(mesh.points[3], DVec3::new(0.0, 2.0, -1.0));
    }

    #[test]
    fn names_the_line_of_what_is_wrong() {
        let v = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        let wrong = |tail: &str| read(&format!("{v}{tail}")).unwrap_err();
        assert_eq!(wrong("v 1 2\n"), ObjError::Vertex { line: 4, found: 2 });
        assert_eq!(wrong("v 1 2 x\n"), ObjError::Number { line: 4, word: "x".into() });
        assert_eq!(wrong("\nv 1 nan 3\n"), ObjError::Number { line: 5, word: "nan".into() });
        assert_eq!(wrong("v 1 inf 3\n"), ObjError::Number { line: 4, word: "inf".into() });
        assert_eq!(wrong("v 1 1e999 3\n"), ObjError::Number { line: 4, word: "1e999".into() });
        assert_eq!(wrong("f 1 2\n"), ObjError::Face { line: 4, found: 2 });
        assert_eq!(wrong("f 1 2 0\n"), ObjError::Index { line: 4, word: "0".into() });
        assert_eq!(wrong("f 1 2 3/a\n"), ObjError::Index { line: 4, word: "3/a".into() });
        assert_eq!(wrong("f 1 2 4\n"), ObjError::NoVertex { line: 4, index: 4, vertices: 3 });
        assert_eq!(wrong("f 1 2 -4\n"), ObjError::NoVertex { line: 4, index: -4, vertices: 3 });
        assert_eq!(wrong("f 1 2 3 99999999999\n"), ObjError::NoVertex { line: 4, index: 99_999_999_999, vertices: 3 });
        assert_eq!(wrong("curv 0 1 1 2\n"), ObjError::Statement { line: 4, word: "curv".into() });
        assert_eq!(wrong(""), ObjError::NoFaces { vertices: 3 });
        assert_eq!(read_obj(v.as_bytes(), -1.0), Err(ObjError::Unit { unit_mm: -1.0 }));
        assert!(matches!(read_obj(b"v 1e300 0 0", 1e300), Err(ObjError::Number { line: 1, .. })));
    }

    #[test]
    fn garbage_is_refused_in_few_words() {
        let garbage: Vec<u8> = (0..200_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8 | 1).collect();
        assert!(read_obj(&garbage, 1.0).unwrap_err().to_string().len() < 250);
    }

    #[test]
    fn panels_are_closed_and_hold_their_volume() {
        let panels = fixture::panels();
        let text = write_panels_obj(&panels, &|| true);
        assert!(String::from_utf8_lossy(&text).contains("\no 3.2\n"));
        let mesh = read_obj(&text, 1.0).unwrap();
        // 2 × (front, back, 4 chamfers) and one node facet; 8 + 1 corners and 8.
        assert_eq!((mesh.face_count(), mesh.points.len()), (13, 17));
        let mut edges = std::collections::BTreeMap::new();
        for f in 0..mesh.face_count() {
            let face = mesh.face(f);
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "an edge is not met by two opposite loops: {edges:?}");
        // Prismatoid rule on the panel without a void; the void takes the pyramid over its corner.
        let section = |s: f64| {
            let p = |c: usize| panels.front[c].lerp(panels.back_start[c], s).truncate();
            let [a, b, c, d] = [4, 5, 6, 7].map(p);
            0.5 * ((c - a).perp_dot(d - b)).abs()
        };
        let whole = (section(0.0) + 4.0 * section(0.5) + section(1.0)) * fixture::D / 6.0;
        assert!((panels.solid(2).volume() - whole).abs() < 1e-9 * whole);
        let corner = panels.back_start[6];
        let base = 0.5 * (panels.back_end[1] - corner).cross(panels.back_start[2] - corner).length();
        let voided = panels.solid(0).volume();
        assert!((whole - base * fixture::D / 3.0 - voided).abs() < 1e-9 * whole, "{whole} {voided}");
    }

    proptest! {
        #[test]
        fn what_is_written_reads_back_bit_by_bit(
            xyz in prop::collection::vec(prop::array::uniform3(-1e6..1e6f64), 3..20),
            picks in prop::collection::vec(prop::collection::vec(0usize..1000, 3..7), 1..10),
        ) {
            let points: Vec<DVec3> = xyz.into_iter().map(DVec3::from_array).collect();
            let mut mesh = Mesh { face_start: vec![0].into(), ..Mesh::default() };
            for loop_ in &picks {
                mesh.face_vertices.to_mut().extend(loop_.iter().map(|p| (p % points.len()) as u32));
                mesh.face_start.to_mut().push(mesh.face_vertices.len() as u32);
            }
            mesh.points = points.into();
            prop_assert_eq!(read_obj(&write_obj(&mesh, &|| true), 1.0).unwrap(), mesh);
        }

        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(
            prop_oneof![Just(b'f'), Just(b'v'), Just(b'/'), Just(b'\n'), Just(b'-'), Just(b' '), Just(b'9'), Just(b'\\'), any::<u8>()],
            0..200,
        )) {
            let _ = read_obj(&bytes, 1.0);
        }
    }
}
