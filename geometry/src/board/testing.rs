//! Panels by hand for the tests of boards and motion: convex polygons with chosen chamfers and voided nodes.

use crate::mesh::Address;
use crate::panel::{Neighbour, PanelSet, Side};
use crate::plane::Plane;
use glam::{DAffine3, DQuat, DVec2, DVec3};
use proptest::prelude::*;

/// One panel: front corners (counter-clockwise), lean of each chamfer (positive: its normal points to the front), cut
/// of each back corner (0: no node facet).
pub struct Shape {
    pub front: Vec<DVec2>,
    pub lean: Vec<f64>,
    pub void: Vec<f64>,
}

/// A parallelogram of length `l` along x, height `h`, sheared by `shear`.
pub fn slanted_quad(l: f64, h: f64, shear: f64, lean: [f64; 4]) -> Shape {
    let front = vec![DVec2::ZERO, DVec2::new(l, 0.0), DVec2::new(l + shear, h), DVec2::new(shear, h)];
    Shape { front, lean: lean.to_vec(), void: vec![0.0; 4] }
}

/// A panel set whose panels lie on the xy plane (front up, wood below) before `pose` moves them.
pub fn panel_set(shapes: &[Shape], thickness: f64, pose: DAffine3) -> PanelSet {
    let mut set = PanelSet { thickness, corner_start: vec![0].into(), ..PanelSet::default() };
    for (i, shape) in shapes.iter().enumerate() {
        let n = shape.front.len();
        let planes: Vec<Plane> = (0..n)
            .map(|k| {
                let out = -(shape.front[(k + 1) % n] - shape.front[k]).perp().normalize();
                let (s, c) = shape.lean[k].sin_cos();
                Plane::through(shape.front[k].extend(0.0), (out * c).extend(s))
            })
            .collect();
        let corner = |k: usize| {
            let (a, b) = (planes[(k + n - 1) % n], planes[k]);
            let (u, v) = (a.normal.truncate(), b.normal.truncate());
            let (p, q) = (a.offset + a.normal.z * thickness, b.offset + b.normal.z * thickness);
            DVec2::new(p * v.y - q * u.y, u.x * q - v.x * p) / u.perp_dot(v)
        };
        let back: Vec<DVec2> = (0..n).map(corner).collect();
        for k in 0..n {
            let next = (k + 1) % n;
            let along = (back[next] - back[k]).normalize();
            let (start, end) = (back[k] + along * shape.void[k], back[next] - along * shape.void[next]);
            set.front.to_mut().push(pose.transform_point3(shape.front[k].extend(0.0)));
            set.back_start.to_mut().push(pose.transform_point3(start.extend(-thickness)));
            set.back_end.to_mut().push(pose.transform_point3(end.extend(-thickness)));
            set.chamfer.to_mut().push(Plane::through(
                pose.transform_point3(shape.front[k].extend(0.0)),
                pose.transform_vector3(planes[k].normal),
            ));
            set.vertex.to_mut().push((i * 16 + k) as u32);
            set.neighbour.to_mut().push(Neighbour::NONE);
            set.side.to_mut().push(Side::Other);
            set.voided.to_mut().push(shape.void[k] > 0.0);
        }
        set.normal.to_mut().push(pose.transform_vector3(DVec3::Z));
        set.address.to_mut().push(Address { patch: 0, row: i as u32, column: 0 });
        set.corner_start.to_mut().push(set.front.len() as u32);
    }
    set
}

/// Any rigid motion near a building's size.
pub fn random_pose() -> impl Strategy<Value = DAffine3> {
    let angle = -3.0..3.0f64;
    let shift = -5000.0..5000.0f64;
    (angle.clone(), angle.clone(), angle, prop::array::uniform3(shift)).prop_map(|(a, b, c, t)| {
        let turn = DQuat::from_rotation_z(a) * DQuat::from_rotation_y(b) * DQuat::from_rotation_x(c);
        DAffine3::from_rotation_translation(turn, DVec3::from_array(t))
    })
}
