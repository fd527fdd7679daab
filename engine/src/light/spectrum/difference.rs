//! How far two colours are apart: CIELAB and ΔE2000.
//!
//! About 1 is the least that is seen side by side. The white of CIELAB is D65, as sRGB's, at a luminance that the caller chooses:
//! [`shown`] takes twice that of the colour that is judged, so that a twilight is judged by an eye that is used to twilight.
//!
//! # Citations
//! [CIE 15:2004] §8.2.1. [Sharma, Wu & Dalal 2005] "The CIEDE2000 Color-Difference Formula: Implementation Notes, Supplementary Test
//! Data, and Mathematical Observations", Color Research and Application 30.

use super::xyz_from_rgb;
use crate::units::DEG;
use glam::DVec3;

/// L*, a*, b* of X, Y, Z against a white. [CIE 15:2004, §8.2.1]
pub fn lab(xyz: DVec3, white: DVec3) -> DVec3 {
    let f = |t: f64| {
        let linear = (841.0 / 108.0) * t + 4.0 / 29.0;
        if t > (6.0 / 29.0) * (6.0 / 29.0) * (6.0 / 29.0) { libm::cbrt(t) } else { linear }
    };
    let [x, y, z] = (xyz / white).to_array().map(f);
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// ΔE2000 of two linear sRGB colours, both seen by an eye whose white is D65 at twice the luminance of `truth`; 0 where that is dark.
pub fn shown(truth: DVec3, other: DVec3) -> f64 {
    let xyz = xyz_from_rgb();
    let white = xyz * DVec3::ONE * (2.0 * (xyz * truth).y);
    if white.y > 0.0 { delta_e_2000(lab(xyz * truth, white), lab(xyz * other, white)) } else { 0.0 }
}

/// ΔE2000 of two colours L*, a*, b*, all weights 1. [Sharma, Wu & Dalal 2005, eq. 2–22]
pub fn delta_e_2000(one: DVec3, two: DVec3) -> f64 {
    const TWENTY_FIVE_7: f64 = 6_103_515_625.0;
    let seventh = |c: f64| {
        let c7 = c * c * c * c * c * c * c;
        (c7 / (c7 + TWENTY_FIVE_7)).sqrt()
    };
    let chroma = |v: DVec3| (v.y * v.y + v.z * v.z).sqrt();
    let stretch = 1.5 - 0.5 * seventh(0.5 * (chroma(one) + chroma(two)));
    // Chroma and hue, degrees from 0 to 360; a grey has hue 0.
    let polar = |v: DVec3| {
        let a = v.y * stretch;
        let hue = if a == 0.0 && v.z == 0.0 { 0.0 } else { libm::atan2(v.z, a) / DEG };
        ((a * a + v.z * v.z).sqrt(), if hue < 0.0 { hue + 360.0 } else { hue })
    };
    let ((c1, h1), (c2, h2)) = (polar(one), polar(two));
    let grey = c1 * c2 == 0.0;
    let apart = h2 - h1;
    let turn = if grey {
        0.0
    } else if apart > 180.0 {
        apart - 360.0
    } else if apart < -180.0 {
        apart + 360.0
    } else {
        apart
    };
    let hue = if grey {
        h1 + h2
    } else if apart.abs() <= 180.0 {
        0.5 * (h1 + h2)
    } else if h1 + h2 < 360.0 {
        0.5 * (h1 + h2 + 360.0)
    } else {
        0.5 * (h1 + h2 - 360.0)
    };
    let (d_l, d_c) = (two.x - one.x, c2 - c1);
    let d_h = 2.0 * (c1 * c2).sqrt() * libm::sin(0.5 * turn * DEG);
    let cos = |degrees: f64| libm::cos(degrees * DEG);
    let t = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0) - 0.2 * cos(4.0 * hue - 63.0);
    let c = 0.5 * (c1 + c2);
    let l = 0.5 * (one.x + two.x) - 50.0;
    let s_l = 1.0 + 0.015 * l * l / (20.0 + l * l).sqrt();
    let (s_c, s_h) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let bend = (hue - 275.0) / 25.0;
    let r_t = -libm::sin(60.0 * libm::exp(-bend * bend) * DEG) * 2.0 * seventh(c);
    let (l, c, h) = (d_l / s_l, d_c / s_c, d_h / s_h);
    (l * l + c * c + h * h + r_t * c * h).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// L*, a*, b* twice and their difference: [Sharma, Wu & Dalal 2005, table 1], all 34.
    #[rustfmt::skip]
    const PAIRS: [[f64; 7]; 34] = [
        [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425], [50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485, 2.8615],
        [50.0, 2.8361, -74.02, 50.0, 0.0, -82.7485, 3.4412], [50.0, -1.3802, -84.2814, 50.0, 0.0, -82.7485, 1.0],
        [50.0, -1.1848, -84.8006, 50.0, 0.0, -82.7485, 1.0], [50.0, -0.9009, -85.5211, 50.0, 0.0, -82.7485, 1.0],
        [50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669], [50.0, -1.0, 2.0, 50.0, 0.0, 0.0, 2.3669],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.0009, 7.1792], [50.0, 2.49, -0.001, 50.0, -2.49, 0.001, 7.1792],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.0011, 7.2195], [50.0, 2.49, -0.001, 50.0, -2.49, 0.0012, 7.2195],
        [50.0, -0.001, 2.49, 50.0, 0.0009, -2.49, 4.8045], [50.0, -0.001, 2.49, 50.0, 0.001, -2.49, 4.8045],
        [50.0, -0.001, 2.49, 50.0, 0.0011, -2.49, 4.7461], [50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065],
        [50.0, 2.5, 0.0, 73.0, 25.0, -18.0, 27.1492], [50.0, 2.5, 0.0, 61.0, -5.0, 29.0, 22.8977],
        [50.0, 2.5, 0.0, 56.0, -27.0, -3.0, 31.903], [50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535],
        [50.0, 2.5, 0.0, 50.0, 3.1736, 0.5854, 1.0], [50.0, 2.5, 0.0, 50.0, 3.2972, 0.0, 1.0],
        [50.0, 2.5, 0.0, 50.0, 1.8634, 0.5757, 1.0], [50.0, 2.5, 0.0, 50.0, 3.2592, 0.335, 1.0],
        [60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644], [63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.263],
        [61.2901, 3.7196, -5.3901, 61.4292, 2.248, -4.962, 1.8731], [35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645],
        [22.7233, 20.0904, -46.694, 23.0331, 14.973, -42.5619, 2.0373], [36.4612, 47.858, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146],
        [90.8027, -2.0831, 1.441, 91.1528, -1.6435, 0.0447, 1.4441], [90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381],
        [6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377], [2.0776, 0.0795, -1.135, 0.9033, -0.0636, -0.5514, 0.9082],
    ];

    #[test]
    fn the_published_pairs_differ_as_published() {
        for [l1, a1, b1, l2, a2, b2, published] in PAIRS {
            let (one, two) = (DVec3::new(l1, a1, b1), DVec3::new(l2, a2, b2));
            for found in [delta_e_2000(one, two), delta_e_2000(two, one)] {
                assert!((found - published).abs() < 5.1e-5, "{one} {two}: {found}, published {published}");
            }
        }
    }

    #[test]
    fn greys_are_grey_and_white_is_100() {
        let white = xyz_from_rgb() * DVec3::ONE;
        assert!((lab(white, white) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        // Middle grey: Y = 0.184 is L* = 50.
        let grey = lab(white * 0.184_187, white);
        assert!((grey - DVec3::new(50.0, 0.0, 0.0)).length() < 1e-3, "{grey}");
        // Continuous where the cube root ends.
        let edge = 216.0 / 24_389.0;
        assert!((lab(white * (edge - 1e-9), white) - lab(white * (edge + 1e-9), white)).length() < 1e-5);
    }

    #[test]
    fn what_is_shown_is_judged_alike_at_any_brightness() {
        let (a, b) = (DVec3::new(0.2, 0.3, 0.5), DVec3::new(0.21, 0.3, 0.49));
        let bright = shown(a, b);
        assert!((shown(a * 1e-6, b * 1e-6) / bright - 1.0).abs() < 1e-9 && bright > 0.3 && bright < 3.0, "{bright}");
        assert_eq!(shown(DVec3::ZERO, b), 0.0);
        // One stop is 17 apart in lightness: far more than is seen.
        assert!(shown(a, a * 0.5) > 10.0);
    }
}
