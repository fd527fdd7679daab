//! Small painted colour maps of the model `gradient`, and the two that it has where none is given.
//!
//! Not here: PNG files (the assets' business) and maps of whole bodies (`render/maps.rs`).

use super::super::RangeError;
use core::ops::RangeInclusive;
use glam::DVec4;
use serde::{Deserialize, Serialize};

/// A picture, rows from the top, RGBA of 8 bits, colours sRGB-encoded, alpha linear.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColourMap {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// `4 · width · height` bytes.
    pub rgba: Vec<u8>,
}

/// A stop of a colour ramp: place (0 … 1) and sRGB colour.
type Stop = (f64, [f64; 3]);

/// Night, the glow before it, sunset, late day, day.
const SHELL_SURFACE: [Stop; 6] = [
    (0.0, [0.0, 0.0, 0.0]),
    (0.15, [45.0, 22.0, 48.0]),
    (0.32, [196.0, 88.0, 38.0]),
    (0.48, [214.0, 164.0, 110.0]),
    (0.66, [138.0, 164.0, 190.0]),
    (1.0, [120.0, 160.0, 208.0]),
];
const SHELL_EDGE: [Stop; 5] = [
    (0.0, [0.0, 0.0, 0.0]),
    (0.2, [20.0, 22.0, 60.0]),
    (0.4, [70.0, 78.0, 130.0]),
    (0.65, [38.0, 86.0, 176.0]),
    (1.0, [22.0, 72.0, 180.0]),
];
const GROUND_AIR: [Stop; 6] = [
    (0.0, [0.0, 0.0, 0.0]),
    (0.42, [0.0, 0.0, 0.0]),
    (0.5, [150.0, 84.0, 52.0]),
    (0.58, [186.0, 160.0, 140.0]),
    (0.72, [132.0, 164.0, 200.0]),
    (1.0, [120.0, 160.0, 208.0]),
];
/// White again by night, so that what shines of itself keeps its colour.
const GROUND_SUN: [Stop; 6] = [
    (0.0, [255.0, 255.0, 255.0]),
    (0.4, [255.0, 230.0, 214.0]),
    (0.5, [255.0, 150.0, 84.0]),
    (0.58, [255.0, 214.0, 176.0]),
    (0.75, [255.0, 246.0, 236.0]),
    (1.0, [255.0, 255.0, 255.0]),
];

impl ColourMap {
    /// The shell of 32 × 16 texels that stands in where a file names none: black, dusk, orange, blue from left to right; paler toward
    /// the surface. Each row is a mixture of two ramps by the square of its height.
    pub fn earthly_shell() -> Self {
        Self::painted([32, 16], |u, v| {
            let (low, high) = (ramp(&SHELL_SURFACE, u), ramp(&SHELL_EDGE, u));
            [0, 1, 2].map(|i| high[i] + (low[i] - high[i]) * v * v)
        })
    }

    /// The ground's two rows that stand in where a file names none.
    pub fn earthly_ground() -> Self {
        Self::painted([32, 2], |u, v| ramp(if v < 0.5 { &GROUND_AIR } else { &GROUND_SUN }, u))
    }

    /// From a function of u (0: first column … 1: last) and v (0: top row … 1: bottom row) to sRGB, 0 … 255.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn painted(size: [u32; 2], colour: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        let [w, h] = size;
        let part = |i: u32, n: u32| f64::from(i) / f64::from(n - 1);
        let texels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
        let rgba = texels.flat_map(|(x, y)| {
            let [r, g, b] = colour(part(x, w), part(y, h)).map(|c| c.round().clamp(0.0, 255.0) as u8);
            [r, g, b, 255]
        });
        Self { size, rgba: rgba.collect() }
    }

    /// Tells a size that is not allowed, or bytes that do not fill it.
    pub(super) fn check(&self, e: &mut Vec<RangeError>, field: &str, heights: RangeInclusive<u32>) {
        let [w, h] = self.size;
        RangeError::check(e, &format!("{field}: width in texels"), f64::from(w), 2.0, 256.0);
        RangeError::check(e, &format!("{field}: height in texels"), f64::from(h), f64::from(*heights.start()), f64::from(*heights.end()));
        let expected = 4.0 * f64::from(w) * f64::from(h);
        RangeError::check(e, &format!("{field}: bytes"), self.rgba.len() as f64, expected, expected);
    }

    /// Linear RGB and alpha of a texel; transparent black outside.
    pub fn texel(&self, x: u32, y: u32) -> DVec4 {
        let start = 4 * (y as usize * self.size[0] as usize + x as usize);
        match self.rgba.get(start..start + 4) {
            Some(&[r, g, b, a]) => DVec4::new(linear(r), linear(g), linear(b), f64::from(a) / 255.0),
            _ => DVec4::ZERO,
        }
    }

    /// Linear RGB and alpha at (u, v) from the top left, 0 … 1, between the four texels around it; held at the edges.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn at(&self, u: f64, v: f64) -> DVec4 {
        let place = |x: f64, n: u32| {
            let last = f64::from(n.max(1) - 1);
            let x = (x * f64::from(n) - 0.5).clamp(0.0, last);
            let low = x.floor().min((last - 1.0).max(0.0));
            (low as u32, (low as u32 + 1).min(n.max(1) - 1), x - low)
        };
        let (x0, x1, fx) = place(u, self.size[0]);
        let (y0, y1, fy) = place(v, self.size[1]);
        let row = |y| self.texel(x0, y).lerp(self.texel(x1, y), fx);
        row(y0).lerp(row(y1), fy)
    }
}

/// The colour of a ramp, linear between its stops.
fn ramp(stops: &[Stop], x: f64) -> [f64; 3] {
    let after = stops.iter().position(|s| s.0 >= x).unwrap_or(stops.len() - 1).max(1);
    let ((a, from), (b, to)) = (stops[after - 1], stops[after]);
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * t)
}

/// sRGB decoding [IEC 61966-2-1].
fn linear(byte: u8) -> f64 {
    let x = f64::from(byte) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_read_between_texel_centres() {
        let map = ColourMap { size: [2, 2], rgba: vec![0, 0, 0, 255, 255, 255, 255, 255, 0, 255, 0, 255, 255, 0, 0, 0] };
        assert_eq!(map.at(0.0, 0.0), DVec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(map.at(0.75, 0.25), DVec4::ONE);
        assert_eq!(map.at(0.5, 0.25), DVec4::new(0.5, 0.5, 0.5, 1.0));
        assert_eq!(map.at(0.5, 0.5), DVec4::new(0.5, 0.5, 0.25, 0.75));
        assert_eq!(map.at(9.0, 9.0), DVec4::new(1.0, 0.0, 0.0, 0.0));
        assert!((linear(188) - 0.502_886).abs() < 1e-6 && linear(10) == 10.0 / 255.0 / 12.92);
    }

    #[test]
    fn the_maps_that_stand_in_are_of_the_article_s_size_and_order() {
        let shell = ColourMap::earthly_shell();
        let ground = ColourMap::earthly_ground();
        assert_eq!((shell.size, ground.size), ([32, 16], [32, 2]));
        // Day is blue, sunset orange, midnight black; the edge is deeper than the surface.
        let (day, dusk) = (shell.at(1.0, 1.0), shell.at(0.33, 1.0));
        assert!(day.z > day.x && dusk.x > 2.0 * dusk.z && shell.at(0.0, 1.0).truncate().length() == 0.0);
        let edge = shell.at(1.0, 0.0);
        assert!(edge.x / edge.z < 0.5 * day.x / day.z);
        // By day the air over the ground is that of the shell along the surface: no seam at the horizon.
        assert!((ground.at(1.0, 0.25) - day).length() < 1e-12);
    }

    #[test]
    fn a_wrong_size_is_told() {
        let mut e = Vec::new();
        ColourMap { size: [1, 3], rgba: vec![0; 11] }.check(&mut e, "ground_map", 2..=2);
        let fields: Vec<_> = e.iter().map(|e| e.field.as_str()).collect();
        assert_eq!(fields, ["ground_map: width in texels", "ground_map: height in texels", "ground_map: bytes"]);
        assert_eq!(ColourMap::default().at(0.3, 0.3), DVec4::ZERO);
    }
}
