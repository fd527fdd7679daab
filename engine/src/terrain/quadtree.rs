//! Which tiles a camera needs: a walk down the quadtree by screen-space error, after [Strugar 2010, "Continuous
//! Distance-Dependent Level of Detail for Rendering Heightmaps"].
//!
//! A fractal surface departs from its triangles in proportion to their size; [`ERROR_PER_QUAD`] times a quad's edge bounds it for
//! slopes up to about 0.5. A tile is split where that error covers more than `max_error_px`: nearer than `c` tile edges with the
//! same `c` at every level, so ranges double from level to level. A vertex turns into its parent's grid between 1.55 and 1.95
//! split ranges; neighbours of another level lie beyond 2, finer ones within 1.55 as long as `c ≥` [`SPLIT_MIN`]: no cracks, no pops.
//!
//! Left out: what lies behind the horizon (of the lowest ground, with the highest as margin) and outside the view's cone.
//! Not here: what of it is already on the GPU ([`super::stream`]).

use super::relief::Relief;
use super::scale::relief_scale;
use super::tile::{QUADS, TileKey, TileSet};
use glam::DVec3;
use std::sync::Arc;

/// Largest departure of the ground from a quad, in quad edges.
pub const ERROR_PER_QUAD: f64 = 0.125;
/// Least split distance, in tile edges, for which morphing closes all cracks.
pub const SPLIT_MIN: f64 = 3.3;
/// Coarsest level drawn: a quad then bulges 30 m over its chord on the Earth, too little for the air above it to show.
pub const LEVEL_MIN: u8 = 3;
/// Most tiles of one set; where more are wanted, the error allowed is raised.
pub const TILES_MAX: usize = 1400;

/// What the walk needs of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Camera from the body's centre, body-fixed axes, m.
    pub camera_m: DVec3,
    /// Unit view axis, body-fixed.
    pub forward: DVec3,
    /// Half the angle of a cone around the axis that holds the picture (its corners), rad; π to keep everything.
    pub cone_rad: f64,
    /// Angle of a pixel, rad.
    pub pixel_rad: f64,
    /// Largest departure of the drawn ground, pixels.
    pub max_error_px: f64,
    /// Factor on relief from afar.
    pub relief_max: f64,
}

struct Walk<'a> {
    relief: &'a Relief,
    view: View,
    scale: f64,
    bound_m: f64,
    split: f64,
    height_m: f64,
    tiles: Vec<TileKey>,
}

/// Chooses the tiles of a body for a camera.
pub fn select(relief: &Arc<Relief>, view: &View) -> TileSet {
    let radius = relief.radius_m;
    let distance = view.camera_m.length();
    let scale = relief_scale(distance - radius, radius, view.relief_max);
    let pixel = view.pixel_rad.max(1e-7);
    let mut split = (ERROR_PER_QUAD / f64::from(QUADS) / (pixel * view.max_error_px.max(0.05))).max(SPLIT_MIN);
    let mut walk = Walk { relief, view: *view, scale, bound_m: relief.bound_m() * scale, split, height_m: distance, tiles: Vec::new() };
    if radius > 0.0 && view.camera_m.is_finite() {
        loop {
            walk.split = split;
            walk.tiles.clear();
            for root in TileKey::roots() {
                walk.visit(root);
            }
            if walk.tiles.len() <= TILES_MAX || split <= SPLIT_MIN {
                break;
            }
            split = (0.8 * split).max(SPLIT_MIN);
        }
    }
    walk.tiles.sort_unstable();
    TileSet { relief: Arc::clone(relief), camera_m: view.camera_m, relief_scale: scale, split_tiles: split, tiles: walk.tiles }
}

impl Walk<'_> {
    fn visit(&mut self, key: TileKey) {
        let r = self.relief;
        let edge = core::f64::consts::FRAC_PI_2 * r.radius_m / f64::from(1_u32 << key.level.min(31));
        let up = key.centre();
        // A coarse tile is taken as a ball on the datum with all relief as margin; a fine one sits on its own ground.
        let margin = (0.2 * edge).min(self.bound_m);
        let lift = if margin < self.bound_m { self.scale * drawn(r, up, key.level) } else { 0.0 };
        let reach = 0.71 * edge + margin;
        let to = up * (r.radius_m + lift) - self.view.camera_m;
        let distance = (to.length() - reach).max(0.0);
        if key.level > 0 && (self.hidden(to, reach, lift + margin) || self.aside(to, reach)) {
            return;
        }
        if key.level < r.max_level() && (key.level < LEVEL_MIN || distance < self.split * edge) {
            for child in key.children() {
                self.visit(child);
            }
        } else {
            self.tiles.push(key);
        }
    }

    /// Behind the horizon of the lowest ground: the chord from the camera to the tile's nearest part dips under it.
    fn hidden(&self, to: DVec3, reach: f64, top_m: f64) -> bool {
        let low = (self.relief.radius_m - if self.relief.has_water { 0.0 } else { self.bound_m }).max(1.0);
        let above = (self.height_m * self.height_m - low * low).max(0.0).sqrt();
        let high = self.relief.radius_m + top_m.max(0.0);
        let beyond = (high * high - low * low).max(0.0).sqrt();
        to.length() - reach > above + beyond
    }

    fn aside(&self, to: DVec3, reach: f64) -> bool {
        let d = to.length();
        if d <= reach || self.view.cone_rad >= 3.0 {
            return false;
        }
        let angle = libm::acos((to.dot(self.view.forward) / d).clamp(-1.0, 1.0));
        angle - libm::asin((reach / d).min(1.0)) > self.view.cone_rad
    }
}

/// Height, m, at which a tile's middle is drawn.
fn drawn(relief: &Relief, up: DVec3, level: u8) -> f64 {
    let h = relief.height_at_level(up, level);
    if relief.has_water { h.max(0.0) } else { h }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::sphere::direction_of_lat_lon;
    use crate::terrain::relief::Maps;
    use crate::terrain::spec::{NoiseSpec, ReliefSpec};

    fn rough() -> Arc<Relief> {
        let noise = NoiseSpec { wavelength_m: 2e4, amplitude_m: 800.0, plain_amplitude_m: 800.0, gain: 0.47, ridged: 0.5, seed: 1 };
        Arc::new(Relief::new(6.371e6, ReliefSpec { noise: Some(noise), ..ReliefSpec::default() }, Maps::default()).unwrap())
    }

    fn view(altitude_m: f64) -> View {
        let up = direction_of_lat_lon(0.7, 0.3);
        View { camera_m: up * (6.371e6 + altitude_m), forward: -up, cone_rad: 3.2, pixel_rad: 1e-3, max_error_px: 1.0, relief_max: 1.0 }
    }

    #[test]
    fn the_ground_below_is_at_the_finest_level_and_covered_once() {
        let relief = rough();
        let up = direction_of_lat_lon(0.7, 0.3);
        let (_, _, north) = crate::space::sphere::east_up_north(up);
        let ahead = View { forward: north, cone_rad: 0.7, ..view(relief.height_m(up) + 2.0) };
        let set = select(&relief, &ahead);
        let (face, u, v) = crate::space::sphere::face_of(up);
        let holds = |k: &&TileKey| {
            let (cu, cv) = k.centre_uv();
            k.face == face && (u - cu).abs() <= 0.5 * k.size_uv() && (v - cv).abs() <= 0.5 * k.size_uv()
        };
        let below: Vec<_> = set.tiles.iter().filter(holds).collect();
        assert_eq!(below.len(), 1);
        assert_eq!(below[0].level, relief.max_level());
        assert!(set.tiles.len() <= TILES_MAX && set.tiles.len() > 50, "{} tiles", set.tiles.len());
    }

    #[test]
    fn no_split_point_lies_within_its_morph_range_and_far_views_are_few_tiles() {
        let relief = rough();
        let set = select(&relief, &view(4e5));
        for key in &set.tiles {
            let distance = (key.centre() * relief.radius_m - set.camera_m).length();
            assert!(distance + 1.2 * set.edge_m(key.level) > set.split_tiles * set.edge_m(key.level) || key.level == relief.max_level());
        }
        assert!(select(&relief, &view(6e7)).tiles.len() < 384);
    }

    #[test]
    fn the_far_side_is_left_out() {
        let relief = rough();
        let set = select(&relief, &view(1e6));
        let worst = set.tiles.iter().filter(|k| k.level > 2).map(|k| k.centre().dot(set.camera_m.normalize())).fold(1.0, f64::min);
        assert!(worst > 0.6, "a tile at cosine {worst} of the sub-camera point is behind the horizon");
    }
}
