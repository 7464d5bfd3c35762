//! The eye: where it looks, from where, and where a place of the model is on screen. Z is up.

use eframe::egui::{Pos2, Rect, pos2};
use glam::dcamera::rh::proj::directx;
use glam::dcamera::rh::view;
use glam::{DMat4, DVec2, DVec3, DVec4};

/// Half the vertical angle of view, radians.
const HALF: f64 = 0.35;

/// Where the eye is and how it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What it looks at and turns about, mm.
    pub target: DVec3,
    /// Turn about Z, radians; 0: from +X.
    pub yaw: f64,
    /// Height over the ground, radians; π/2: from above.
    pub pitch: f64,
    /// Distance from the target, mm.
    pub distance: f64,
    /// Without perspective.
    pub orthographic: bool,
}

impl Default for Camera {
    fn default() -> Self {
        Self { target: DVec3::ZERO, yaw: -1.05, pitch: 0.5, distance: 8000.0, orthographic: false }
    }
}

/// Directions from which one looks by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standard {
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// Along Y.
    Front,
    /// Against Y.
    Back,
    /// Against X.
    Right,
    /// Along X.
    Left,
    /// From a corner.
    Corner,
}

impl Camera {
    /// The direction from the target to the eye.
    #[must_use]
    pub fn back(&self) -> DVec3 {
        let (sp, cp) = self.pitch.sin_cos();
        let (sy, cy) = self.yaw.sin_cos();
        DVec3::new(cy * cp, sy * cp, sp)
    }

    /// To the right on screen, and up.
    #[must_use]
    pub fn sides(&self) -> (DVec3, DVec3) {
        let right = DVec3::new(-self.yaw.sin(), self.yaw.cos(), 0.0);
        (right, self.back().cross(right))
    }

    /// From the model to clip space; depth 0 to 1.
    #[must_use]
    pub fn matrix(&self, aspect: f64) -> DMat4 {
        let (_, up) = self.sides();
        let look = view::look_at_mat4(self.target + self.back() * self.distance, self.target, up);
        let near = self.distance * 0.01;
        let far = self.distance * 100.0;
        let projection = if self.orthographic {
            let h = self.distance * HALF.tan();
            // The eye is moved back so that nothing is cut off behind it.
            directx::orthographic(-h * aspect, h * aspect, -h, h, -far, far)
        } else {
            directx::perspective(2.0 * HALF, aspect, near, far)
        };
        projection * look
    }

    /// Where a place is on screen; none if it lies behind the eye.
    #[must_use]
    pub fn project(&self, area: Rect, p: DVec3) -> Option<Pos2> {
        self.projector(area)(p)
    }

    /// As [`Camera::project`], for many places.
    pub fn projector(&self, area: Rect) -> impl Fn(DVec3) -> Option<Pos2> + use<> {
        let matrix = self.matrix(aspect(area));
        move |p| {
            let clip: DVec4 = matrix * p.extend(1.0);
            if clip.w <= 1e-9 {
                return None;
            }
            let x = (clip.x / clip.w * 0.5 + 0.5) as f32 * area.width();
            let y = (0.5 - clip.y / clip.w * 0.5) as f32 * area.height();
            Some(pos2(area.left() + x, area.top() + y))
        }
    }

    /// The direction in which a place is looked at from it, towards the eye: where the eye stands, or along the view.
    #[must_use]
    pub fn towards(&self, p: DVec3) -> DVec3 {
        if self.orthographic {
            self.back()
        } else {
            (self.target + self.back() * self.distance - p).normalize_or_zero()
        }
    }

    /// The ray through a place on screen: where it begins and its unit direction.
    #[must_use]
    pub fn ray(&self, area: Rect, at: Pos2) -> (DVec3, DVec3) {
        let unit = DVec2::new(
            f64::from((at.x - area.left()) / area.width()) * 2.0 - 1.0,
            1.0 - f64::from((at.y - area.top()) / area.height()) * 2.0,
        );
        let (right, up) = self.sides();
        let size = HALF.tan();
        let aside = right * unit.x * size * aspect(area) + up * unit.y * size;
        let eye = self.target + self.back() * self.distance;
        if self.orthographic {
            (eye + aside * self.distance + self.back() * self.distance * 50.0, -self.back())
        } else {
            (eye, (aside - self.back()).normalize())
        }
    }

    /// Turns by a movement of the hand, points of the screen.
    pub fn orbit(&mut self, dx: f64, dy: f64) {
        self.yaw -= dx * 0.008;
        self.pitch = (self.pitch + dy * 0.008).clamp(-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2);
    }

    /// Moves sideways so that what is looked at follows the hand.
    pub fn pan(&mut self, area: Rect, dx: f64, dy: f64) {
        let (right, up) = self.sides();
        let scale = 2.0 * self.distance * HALF.tan() / f64::from(area.height().max(1.0));
        self.target += (up * dy - right * dx) * scale;
    }

    /// Goes nearer (`factor` < 1) or away; what is under the pointer stays there.
    pub fn zoom(&mut self, area: Rect, at: Pos2, factor: f64) {
        let distance = (self.distance * factor).clamp(1.0, 1e8);
        let factor = distance / self.distance;
        let (origin, direction) = self.ray(area, at);
        // The place under the pointer, in the plane through the target.
        let along = (self.target - origin).dot(self.back()) / direction.dot(self.back());
        let under = origin + direction * along;
        self.target = under + (self.target - under) * factor;
        self.distance = distance;
    }

    /// Shows all of a box.
    pub fn fit(&mut self, area: Rect, [low, high]: [DVec3; 2]) {
        self.target = (low + high) / 2.0;
        let radius = ((high - low).length() / 2.0).max(1.0);
        let narrow = aspect(area).min(1.0);
        self.distance = (radius / (HALF.sin() * narrow)).clamp(1.0, 1e8);
    }

    /// Looks from a named direction.
    pub fn stand(&mut self, from: Standard) {
        let quarter = std::f64::consts::FRAC_PI_2;
        (self.yaw, self.pitch) = match from {
            Standard::Top => (-quarter, quarter),
            Standard::Bottom => (-quarter, -quarter),
            Standard::Front => (-quarter, 0.0),
            Standard::Back => (quarter, 0.0),
            Standard::Right => (0.0, 0.0),
            Standard::Left => (2.0 * quarter, 0.0),
            Standard::Corner => (Self::default().yaw, Self::default().pitch),
        };
    }
}

fn aspect(area: Rect) -> f64 {
    f64::from(area.width().max(1.0) / area.height().max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn rays_go_through_what_is_drawn_at_their_place() {
        let area = Rect::from_min_size(pos2(30.0, 10.0), vec2(700.0, 500.0));
        for orthographic in [false, true] {
            let mut camera = Camera { orthographic, ..Camera::default() };
            camera.fit(area, [DVec3::ZERO, DVec3::new(4500.0, 1600.0, 1100.0)]);
            let p = DVec3::new(900.0, 20.0, 1500.0);
            let at = camera.project(area, p).unwrap();
            let (origin, direction) = camera.ray(area, at);
            let away = (p - origin).cross(direction).length();
            assert!(away < 1.0, "{away} mm beside the ray, orthographic {orthographic}");
            camera.zoom(area, at, 0.5);
            let (origin, direction) = camera.ray(area, at);
            assert!((camera.target - origin).dot(direction) > 0.0);
        }
    }

    #[test]
    fn named_views_look_from_where_they_say() {
        let views = [
            (Standard::Top, DVec3::Z),
            (Standard::Bottom, -DVec3::Z),
            (Standard::Front, -DVec3::Y),
            (Standard::Back, DVec3::Y),
            (Standard::Right, DVec3::X),
            (Standard::Left, -DVec3::X),
        ];
        for (from, back) in views {
            let mut camera = Camera::default();
            camera.stand(from);
            assert!(camera.back().distance(back) < 1e-12, "{from:?}");
            assert!(camera.towards(camera.target).distance(back) < 1e-12, "{from:?}");
        }
    }

    #[test]
    fn from_above_x_goes_right_and_y_up() {
        let area = Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0));
        let mut camera = Camera::default();
        camera.stand(Standard::Top);
        let at = |p| camera.project(area, p).unwrap();
        let zero = at(DVec3::ZERO);
        assert!(at(DVec3::X * 100.0).x > zero.x && at(DVec3::Y * 100.0).y < zero.y);
    }
}
