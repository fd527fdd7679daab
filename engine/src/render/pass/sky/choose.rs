//! Which airs are drawn, over which part of the picture, which need tables, and why the others do not. No GPU here.

use super::model_name;
use crate::air::Air;
use crate::render::pass::smooth_body::{POINT_BELOW_PX, radius_px};
use crate::scene::gpu_data::{MAX_AIRS, MAX_BODIES};
use crate::scene::{Body, Snapshot, Surface};
use crate::space::relative::narrow;
use glam::Vec3;

/// Air around a disc of a smaller radius than this, in pixels, is not drawn: the body is a point of light, and its albedo has its air in it.
pub const AIR_BELOW_PX: f32 = POINT_BELOW_PX;
/// A rectangle that covers more of the picture than this is drawn as the whole of it: that saves a copy.
const NEARLY_WHOLE: f32 = 0.8;
/// Why an air beside or behind the picture is not drawn.
const OUT_OF_VIEW: &str = "out of view";

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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// Its place in the list of bodies.
    pub body: u32,
    /// Its id.
    pub id: u16,
    /// Name of its model.
    pub model: &'static str,
    /// What its air covers.
    pub rect: Rect,
    /// Place in the list of the body in whose air it lies.
    pub held_by: Option<usize>,
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

    /// The texels of a texture of every `rate`-th pixel each way that its pixels, and those between, ask for; `size` is the picture's.
    pub fn every(self, rate: u32, size: [u32; 2]) -> Self {
        let part = |from: u32, len: u32, of: u32| {
            let first = from / rate;
            (first, ((from + len).div_ceil(rate) + 1).min(of.div_ceil(rate)).saturating_sub(first))
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
    let one = |held: Held| {
        let body = scene.bodies.get(held.body)?;
        let chosen = choice(scene, held.body, body, body.air.as_ref()?, slots.get(held.body).copied().flatten());
        Some(Choice { held_by: held.by, ..chosen })
    };
    far_to_near(scene).into_iter().filter_map(one).collect()
}

/// A body's air, and the body in whose air it lies.
struct Held {
    body: usize,
    by: Option<usize>,
}

/// Bodies with air in the order in which their shells are laid over the picture.
///
/// Two shells apart from each other lie on either side of the plane of equal powers, d² − R²: whatever the ray, the one of less power to the
/// camera comes first on it. Shells within another, as banks of fog are, follow the one that holds them.
fn far_to_near(scene: &Snapshot) -> Vec<Held> {
    let shell = |(body, at): (usize, &Body)| {
        let top_m = narrow(at.air.as_ref()?.medium.top_altitude_m);
        let power = (at.camera_altitude_m - top_m) * (2.0 * at.radius_m + at.camera_altitude_m + top_m);
        Some(Shell { body, centre_m: at.centre_m, radius_m: at.radius_m + top_m, power })
    };
    let mut shells: Vec<Shell> = scene.bodies.iter().enumerate().filter_map(shell).collect();
    shells.sort_by(|a, b| b.power.total_cmp(&a.power));
    let mut order = Vec::new();
    Shell::lay(&shells, None, &mut order);
    order
}

struct Shell {
    body: usize,
    centre_m: Vec3,
    radius_m: f32,
    power: f32,
}

impl Shell {
    fn holds(&self, other: &Self) -> bool {
        self.radius_m > other.radius_m && self.centre_m.distance(other.centre_m) < self.radius_m
    }

    /// Those that are held by `by` and by nothing smaller, each followed by what it holds.
    fn lay(all: &[Self], by: Option<usize>, into: &mut Vec<Held>) {
        for shell in all {
            let holders = all.iter().filter(|other| other.holds(shell));
            if holders.min_by(|a, b| a.radius_m.total_cmp(&b.radius_m)).map(|other| other.body) == by {
                into.push(Held { body: shell.body, by });
                Self::lay(all, Some(shell.body), into);
            }
        }
    }
}

/// Why the air of a body needs no tables: it is not drawn, and nothing drawn is lit through it.
pub fn without_tables(scene: &Snapshot, index: usize) -> Option<String> {
    let body = scene.bodies.get(index)?;
    let air = body.air.as_ref()?;
    if scene.ships.iter().any(|ship| ship.host == Some(index) && !ship.hidden) {
        return None;
    }
    extent(scene, index, body, air).err()
}

#[allow(clippy::cast_possible_truncation)]
fn choice(scene: &Snapshot, index: usize, body: &Body, air: &Air, slot: Option<u32>) -> Choice {
    let chosen = Choice { body: index as u32, id: body.id, model: model_name(&air.model), ..Choice::default() };
    match extent(scene, index, body, air) {
        Ok(_) if slot.is_none() => {
            let skip = format!("more airs in view than the {MAX_AIRS} that fit, and this one is among the farthest");
            Choice { skip: Some(skip), ..chosen }
        }
        Ok((rect, reason)) => Choice { rect, reason, ..chosen },
        Err(why) if scene.force.all && slot.is_some() && why == OUT_OF_VIEW => {
            Choice { rect: Rect::whole(scene.camera.size_px), reason: format!("forced; else skipped: {why}"), ..chosen }
        }
        Err(why) => Choice { skip: Some(why), ..chosen },
    }
}

/// What an air is drawn over and why, or why it is not drawn.
fn extent(scene: &Snapshot, index: usize, body: &Body, air: &Air) -> Result<(Rect, String), String> {
    let size = scene.camera.size_px;
    if index >= MAX_BODIES {
        return Err(format!("more bodies than the {MAX_BODIES} that a picture holds, and this one is among the farthest"));
    }
    // Of a shell that is all there is, its own disc counts.
    let shell = if matches!(body.surface, Surface::Nothing) { narrow(air.medium.top_altitude_m) / body.radius_m + 1.0 } else { 1.0 };
    let px = radius_px(scene, body) * shell;
    if px < AIR_BELOW_PX {
        return Err(format!("its disc has a radius of {px:.2} pixels: under {AIR_BELOW_PX}"));
    }
    match covered(scene, body, narrow(air.medium.top_altitude_m)) {
        Some(rect) if rect.share_of(size) > NEARLY_WHOLE => Ok((Rect::whole(size), "it covers the picture".to_owned())),
        Some(rect) if !rect.is_empty() => Ok((rect, format!("it covers {} × {} pixels", rect.width, rect.height))),
        Some(_) => Err(OUT_OF_VIEW.to_owned()),
        None => Ok((Rect::whole(size), "the camera is in it, or near".to_owned())),
    }
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
    use crate::air::Medium;
    use crate::render::tests::empty_scene;
    use glam::Quat;

    /// A ball of air about a core of `radius_m`.
    fn body(id: u16, centre_m: Vec3, radius_m: f32, top_m: f32) -> Body {
        let medium = Medium {
            bottom_radius_m: f64::from(radius_m),
            top_altitude_m: f64::from(top_m),
            ground_albedo: Vec3::ZERO,
            layers: Vec::new(),
        };
        Body {
            id,
            centre_m,
            radius_m,
            icrf_from_fixed: Quat::IDENTITY,
            camera_altitude_m: centre_m.length() - radius_m,
            camera_up: -centre_m.normalize_or(Vec3::NEG_Z),
            sun_direction: Vec3::Z,
            sun_angular_radius_rad: 0.005,
            sun_illuminance_lx: Vec3::ONE,
            occluders: Vec::new(),
            albedo: Vec3::ZERO,
            surface: Surface::Smooth,
            air: Some(medium.into()),
        }
    }

    fn ids(bodies: Vec<Body>) -> Vec<u16> {
        let scene = Snapshot { bodies, ..empty_scene([64, 64]) };
        choose(&scene, &[]).iter().map(|c| c.id).collect()
    }

    #[test]
    fn shells_are_laid_far_to_near_whichever_centre_is_nearer() {
        // A giant and a moon beside its limb, seen through the edge of the giant's air: the moon's centre is nearer, the moon lies behind.
        let giant = body(1, Vec3::NEG_Z * 2.0e8, 7.0e7, 1.0e6);
        let behind = body(2, Vec3::new(7.3e7, 0.0, -1.85e8), 1.0e6, 1.0e5);
        assert!(behind.centre_m.length() < giant.centre_m.length());
        let before = body(3, Vec3::NEG_Z * 1.0e8, 1.0e6, 1.0e5);
        assert_eq!(ids(vec![before.clone(), giant.clone(), behind.clone()]), [2, 1, 3]);
        assert_eq!(ids(vec![behind, before, giant]), [2, 1, 3]);
    }

    #[test]
    fn what_a_shell_holds_follows_it() {
        let planet = |alt: f32| body(1, Vec3::NEG_Y * (6.4e6 + alt), 6.4e6, 1.0e5);
        let bank = |at: Vec3| body(2, at, 1.0e-3, 500.0);
        let moon = body(3, Vec3::NEG_Z * 3.8e8, 1.7e6, 1.0e4);
        // On the ground with a bank far off; from space down on it; within the bank.
        assert_eq!(ids(vec![bank(Vec3::NEG_Z * 4.0e3), planet(2.0), moon.clone()]), [3, 1, 2]);
        assert_eq!(ids(vec![planet(4.0e5), bank(Vec3::NEG_Y * 3.99e5), moon.clone()]), [3, 1, 2]);
        assert_eq!(ids(vec![bank(Vec3::NEG_Z * 100.0), planet(2.0), moon]), [3, 1, 2]);
    }

    #[test]
    fn tables_are_for_airs_that_are_seen_or_light_a_ship() {
        let mut scene = empty_scene([64, 64]);
        scene.bodies = vec![
            body(1, Vec3::NEG_Z * 2.0e7, 6.4e6, 1.0e5),
            body(2, Vec3::Z * 2.0e7, 6.4e6, 1.0e5),
            body(3, Vec3::NEG_Z * 1.0e10, 6.4e6, 1.0e5),
        ];
        let why = |scene: &Snapshot, i| without_tables(scene, i);
        assert_eq!(why(&scene, 0), None);
        assert_eq!(why(&scene, 1).as_deref(), Some(OUT_OF_VIEW));
        assert!(why(&scene, 2).is_some_and(|w| w.contains("pixels: under")));
        let ship = crate::render::tests::ship_at(Vec3::NEG_Z * 20.0, 1e6);
        scene.ships = vec![crate::scene::Ship { host: Some(1), ..ship }];
        assert_eq!(why(&scene, 1), None);
        scene.ships[0].hidden = true;
        assert_eq!(why(&scene, 1).as_deref(), Some(OUT_OF_VIEW));
    }

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
