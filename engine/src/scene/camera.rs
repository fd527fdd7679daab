//! The camera: a perspective with infinite reversed-Z depth.
//!
//! The camera is the origin of every position in a [`super::Snapshot`]; only its attitude is kept here.
//! Depth of a point at distance `z` along the view axis is `near / z`: 1 at the near plane, 0 at infinity
//! [Upchurch & Desbrun 2012, "Tightening the Precision of Perspective Rendering"].

use glam::{Mat4, Quat, Vec4};

/// Attitude and lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Rotates ICRF axes into view axes (+X right, +Y up, −Z forward).
    pub view_from_icrf: Quat,
    /// Vertical field of view, rad.
    pub fov_y_rad: f32,
    /// Near plane, m.
    pub near_m: f32,
    /// Size of the picture, pixels.
    pub size_px: [u32; 2],
}

impl Camera {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size_px[0].max(1) as f32 / self.size_px[1].max(1) as f32
    }
    /// Clip from view: infinite far plane, depth `near / −z`.
    pub fn clip_from_view(&self) -> Mat4 {
        let f = 1.0 / (0.5 * self.fov_y_rad).tan();
        Mat4::from_cols(
            Vec4::new(f / self.aspect(), 0.0, 0.0, 0.0),
            Vec4::new(0.0, f, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, self.near_m, 0.0),
        )
    }
    /// Clip from camera-relative ICRF offsets.
    pub fn clip_from_icrf(&self) -> Mat4 {
        self.clip_from_view() * Mat4::from_quat(self.view_from_icrf)
    }
    /// Angle that one pixel covers at the centre of the picture, rad.
    pub fn pixel_rad(&self) -> f32 {
        2.0 * (0.5 * self.fov_y_rad).tan() / self.size_px[1].max(1) as f32
    }
}
