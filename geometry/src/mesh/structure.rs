//! The checks that every algorithm on meshes relies on: rows that fit, vertices that exist, numbers that are finite.

use super::{Mesh, MeshError};

impl Mesh {
    /// Checks that the face rows fit, that every face has three or more different vertices, all of them existing, and
    /// that all coordinates are finite. After it indexing by the mesh's own columns cannot fail. Welding goes first
    /// where several vertices share a position. O(corners + vertices).
    ///
    /// # Errors
    /// The first fault found: `TooLarge`, `NotFinite`, `BrokenRows`, `FewCorners`, `NoSuchVertex`, `RepeatedVertex`.
    pub fn check_structure(&self) -> Result<(), MeshError> {
        self.check_rows()?;
        let mut seen = vec![u32::MAX; self.points.len()];
        for f in 0..self.face_count() {
            let face = f as u32;
            let corners = self.face(f);
            if corners.len() < 3 {
                return Err(MeshError::FewCorners { face, corners: corners.len() as u32 });
            }
            for &vertex in corners {
                let last = &mut seen[vertex as usize];
                if *last == face {
                    return Err(MeshError::RepeatedVertex { face, vertex });
                }
                *last = face;
            }
        }
        Ok(())
    }

    /// The weaker check that welding needs: rows fit, vertices exist, coordinates are finite.
    pub(crate) fn check_rows(&self) -> Result<(), MeshError> {
        let limit = u32::MAX as usize - 1;
        for (what, count) in [("corners", self.face_vertices.len()), ("vertices", self.points.len())] {
            if count > limit {
                return Err(MeshError::TooLarge { what, count, limit });
            }
        }
        if let Some(vertex) = self.points.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { vertex: vertex as u32 });
        }
        let corners = self.face_vertices.len() as u32;
        let first = self.face_start.first().copied().unwrap_or(0);
        let last = self.face_start.last().copied().unwrap_or(0);
        for (face, row) in self.face_start.windows(2).enumerate() {
            let [from, to] = [row[0], row[1]];
            if to < from || to > corners || (face == 0 && from != 0) {
                return Err(MeshError::BrokenRows { face: face as u32, from, to, corners });
            }
        }
        if first != 0 || last != corners {
            let face = self.face_count().saturating_sub(1) as u32;
            return Err(MeshError::BrokenRows { face, from: first, to: last, corners });
        }
        let vertices = self.points.len() as u32;
        if let Some(c) = self.face_vertices.iter().position(|&v| v >= vertices) {
            let face = self.face_start.partition_point(|&s| s as usize <= c) as u32 - 1;
            return Err(MeshError::NoSuchVertex { face, vertex: self.face_vertices[c], vertices });
        }
        Ok(())
    }
}
