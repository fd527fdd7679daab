//! Which airs are drawn, over which part of the picture, and why the others are not. No GPU here.

use super::model_name;
use crate::air::Air;
use crate::render::pass::smooth_body::radius_px;
use crate::scene::gpu_data::MAX_BODIES;
use crate::scene::{Body, Snapshot, Surface};
use crate::space::relative::narrow;
use glam::Vec3;

/// Air around a disc of a smaller radius than this, in pixels, is not drawn.
pub const AIR_BELOW_PX: f32 = 0.5;
/// A rectangle that covers more of the picture than this is drawn as the whole of it: that saves a copy.
const NEARLY_WHOLE: f32 = 0.8;

/// A part of the picture, pixels from the upper left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// A body with air, and what becomes of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Its place in the list of bodies.
    pub body: u32,
    /// Its id.
    pub id: u16,
    /// Name of its model.
    pub model: &'static str,
    /// What its air covers.
    pub rect: Rect,
    /// Why it is drawn over that.
    pub reason: String,
    /// Why it is not drawn.
    pub skip: Option<String>,
}

impl Rect {
    /// The whole picture.
    pub const fn whole(size: [u32; 2]) -> Self {
        Self { left: 0, top: 0, width: size[0], height: size[1] }
    }

    /// Share of a picture of this size, 0 … 1.
    pub fn share_of(self, size: [u32; 2]) -> f32 {
        (self.width * self.height) as f32 / (size[0].max(1) * size[1].max(1)) as f32
    }

    /// The texels of a texture of half the size that its pixels ask for.
    pub fn half(self, size: [u32; 2]) -> Self {
        let part = |from: u32, len: u32, of: u32| {
            let first = from / 2;
            (first, ((from + len).div_ceil(2) + 1).min(of.div_ceil(2)).saturating_sub(first))
        };
        let ((left, width), (top, height)) = (part(self.left, self.width, size[0]), part(self.top, self.height, size[1]));
        Self { left, top, width, height }
    }

    /// True when there is nothing in it.
    pub const fn is_empty(self) -> bool {
        self.width == 0 || self.height == 0
    }

    /// Copies this part of a texture to the same place of another.
    pub fn copy(self, encoder: &mut wgpu::CommandEncoder, from: &wgpu::Texture, into: &wgpu::Texture) {
        let at = |texture| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: self.left, y: self.top, z: 0 },
            aspect: wgpu::TextureAspect::All,
        };
        let size = wgpu::Extent3d { width: self.width, height: self.height, depth_or_array_layers: 1 };
        encoder.copy_texture_to_texture(at(from), at(into), size);
    }
}

/// Every body with air, far to near, with what becomes of it. `slots` are those of the air tables, by body.
pub fn choose(scene: &Snapshot, slots: &[Option<u32>]) -> Vec<Choice> {
    let mut all: Vec<Choice> = (0u32..)
        .zip(scene.bodies.iter().take(MAX_BODIES))
        .filter_map(|(i, body)| body.air.as_ref().map(|air| choice(scene, i, body, air, slots.get(i as usize).copied().flatten())))
        .collect();
    all.reverse();
    all
}

fn choice(scene: &Snapshot, index: u32, body: &Body, air: &Air, slot: Option<u32>) -> Choice {
    let size = scene.camera.size_px;
    let mut out =
        Choice { body: index, id: body.id, model: model_name(&air.model), rect: Rect::default(), reason: String::new(), skip: None };
    // Of a shell that is all there is, its own disc counts.
    let shell = if matches!(body.surface, Surface::Nothing) { narrow(air.medium.top_altitude_m) / body.radius_m + 1.0 } else { 1.0 };
    let px = radius_px(scene, body) * shell;
    if slot.is_none() {
        out.skip = Some("more airs than slots for their tables, and this one is the farthest".to_owned());
    } else if px < AIR_BELOW_PX {
        out.skip = Some(format!("its disc has a radius of {px:.2} pixels: under {AIR_BELOW_PX}"));
    } else {
        match covered(scene, body, narrow(air.medium.top_altitude_m)) {
            Some(rect) if rect.share_of(size) > NEARLY_WHOLE => {
                out.rect = Rect::whole(size);
                out.reason = "it covers the picture".to_owned();
            }
            Some(rect) if !rect.is_empty() => {
                out.rect = rect;
                out.reason = format!("it covers {} × {} pixels", rect.width, rect.height);
            }
            Some(_) => out.skip = Some("out of view".to_owned()),
            None => {
                out.rect = Rect::whole(size);
                out.reason = "the camera is in it, or near".to_owned();
            }
        }
    }
    out
}

/// The rectangle around a body's air; `None` where the shell reaches the camera's plane.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn covered(scene: &Snapshot, body: &Body, top_m: f32) -> Option<Rect> {
    let camera = &scene.camera;
    let outer = body.radius_m + top_m;
    let centre = camera.view_from_icrf * (-body.camera_up * (body.radius_m + body.camera_altitude_m));
    if -centre.z <= outer {
        return if centre.z >= outer { Some(Rect::default()) } else { None };
    }
    let tan_y = (0.5 * camera.fov_y_rad).tan();
    let [w, h] = camera.size_px.map(|n| n as f32);
    let span = |across: f32, tan: f32, pixels: f32| {
        let [from, to] = tangents(across, -centre.z, outer).map(|t| 0.5 * (1.0 + t / tan) * pixels);
        let (first, last) = ((from - 2.0).floor().clamp(0.0, pixels), (to + 2.0).ceil().clamp(0.0, pixels));
        (first as u32, (last - first) as u32)
    };
    let (left, width) = span(centre.x, tan_y * camera.aspect(), w);
    let (top, height) = span(-centre.y, tan_y, h);
    Some(Rect { left, top, width, height })
}

/// Slopes of the two planes through the eye that touch a sphere: `across` from the axis, `along` in front, of radius less than that.
fn tangents(across: f32, along: f32, radius: f32) -> [f32; 2] {
    let reach = Vec3::new(across, along, 0.0).length();
    let sine = (radius / reach).min(1.0);
    let (middle, half) = ((across / along).atan(), sine.asin());
    // Beyond a right angle the picture has no more: its edge lies far within.
    [middle - half, middle + half].map(|a| a.clamp(-1.55, 1.55).tan())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangent_planes_touch_the_sphere() {
        for (across, along, radius) in [(0.0_f32, 10.0, 1.0), (3.0, 10.0, 2.0), (-8.0, 5.0, 4.5)] {
            for slope in tangents(across, along, radius) {
                // Distance of the centre from the line x = slope · z.
                let distance = (across - slope * along).abs() / (1.0 + slope * slope).sqrt();
                assert!((distance / radius - 1.0).abs() < 1e-4, "{across} {along} {radius}: {distance}");
            }
        }
    }
}
