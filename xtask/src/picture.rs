//! `cargo xtask picture`: draws the panels of a graph as a shaded axonometry, the picture of the README.
//!
//! Panels are convex and apart, so drawing their faces from far to near is enough.

use std::fmt::Write;
use std::sync::Arc;
use tenon_engine::{Control, Document, Options, Session};
use tenon_geometry::panel::PanelSet;
use tenon_geometry::{DMat3, DVec3};
use tenon_nodes::value::V;

/// Evaluates graphs/shell-256 up to its panels and draws them into docs/shell-256.svg.
pub(crate) fn write() -> Result<(), String> {
    let graph = crate::root().join("graphs/shell-256/shell-256.tenon.json");
    let bytes = std::fs::read(&graph).map_err(|e| format!("{}: {e}", graph.display()))?;
    let document = Document::from_slice(&bytes).map_err(|d| format!("{}: {}", graph.display(), d[0]))?;
    let mut session = Session::new(Arc::new(tenon_nodes::registry()), document, Options::default());
    let report = session.evaluate(&["panels"], &Control::default());
    let panels = session.value("panels").and_then(|tree| tree.first::<V<PanelSet>>().cloned());
    let panels = panels.ok_or_else(|| format!("no panels: {:?}", report.diagnostics))?;
    let out = crate::root().join("docs/shell-256.svg");
    std::fs::write(&out, draw(&panels, 1200.0, -68.0, 32.0)).map_err(|e| format!("{}: {e}", out.display()))?;
    println!("wrote {}", out.display());
    Ok(())
}

/// The panels as an SVG of `width` pixels, seen from `azimuth` and `elevation` (degrees).
fn draw(panels: &PanelSet, width: f64, azimuth: f64, elevation: f64) -> String {
    let (sa, ca) = azimuth.to_radians().sin_cos();
    let (se, ce) = elevation.to_radians().sin_cos();
    let right = DVec3::new(-sa, ca, 0.0);
    let toward = DVec3::new(ca * ce, sa * ce, se);
    let camera = DMat3::from_cols(right, toward.cross(right), toward).transpose();
    let light = DVec3::new(0.15, -0.85, 0.5).normalize();

    let mut faces: Vec<(f64, Vec<DVec3>, f64)> = Vec::new();
    for i in (0..panels.len()).filter(|i| panels.is_valid(*i)) {
        let solid = panels.solid(i);
        for f in 0..solid.face_count() {
            let seen: Vec<DVec3> = solid.face(f).iter().map(|v| camera * solid.points[*v as usize]).collect();
            let normal = camera.transpose() * newell(&seen);
            if normal.dot(toward) <= 0.0 {
                continue;
            }
            let depth = seen.iter().map(|p| p.z).sum::<f64>() / seen.len() as f64;
            faces.push((depth, seen, normal.normalize_or_zero().dot(light)));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));

    let corners = || faces.iter().flat_map(|f| &f.1);
    let low = corners().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let high = corners().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    let margin = 20.0;
    let scale = (width - 2.0 * margin) / (high.x - low.x).max(1.0);
    let height = (high.y - low.y) * scale + 2.0 * margin;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#f7f5f0\"/>\n\
         <g stroke=\"#5b4630\" stroke-width=\"0.5\" stroke-linejoin=\"round\">\n"
    );
    for (_, face, lit) in &faces {
        let shade = 0.4 + 0.6 * (0.5 + 0.5 * lit);
        let [r, g, b] = [236.0, 208.0, 160.0].map(|c: f64| (c * shade) as u8);
        let _ = write!(svg, "<path fill=\"#{r:02x}{g:02x}{b:02x}\" d=\"");
        for (k, p) in face.iter().enumerate() {
            let (x, y) = (margin + (p.x - low.x) * scale, margin + (high.y - p.y) * scale);
            let _ = write!(svg, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
        }
        svg.push_str("Z\"/>\n");
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

fn newell(loop_: &[DVec3]) -> DVec3 {
    (0..loop_.len()).map(|k| loop_[k].cross(loop_[(k + 1) % loop_.len()])).sum()
}
