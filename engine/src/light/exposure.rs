//! Exposure: what the eye or a camera makes of a scene's luminance. CPU twin of the formula in the exposure pass.
//!
//! EV100 is the exposure value at ISO 100: `EV100 = log₂(L·S/K)` with S = 100, K = 12.5 cd/m² (ISO 2720 reflected-light
//! meters). The luminance that saturates is `1.2·2^EV100` with the lens vignetting q = 0.65 of ISO 12232, so the factor applied to
//! cd/m² is its reciprocal [Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", §5.1.2].

use glam::Vec3;

/// Bins of the luminance histogram. Bin 0 counts what is darker than [`LOG2_MIN`] and is left out of the meter.
pub const BINS: usize = 256;
/// Luminance of the linear sRGB primaries (IEC 61966-2-1).
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);
/// log₂ of the luminance (cd/m²) at the lower edge of bin 1: a moonless night's darkest ground.
pub const LOG2_MIN: f32 = -20.0;
/// log₂ of the luminance (cd/m²) at the upper edge of the last bin: above the sun's disc (1.9e9 cd/m²).
pub const LOG2_MAX: f32 = 32.0;
/// The meter averages log-luminance between these fractions of the counted pixels: black space and the sun's glint do not vote.
pub const METER_RANGE: [f32; 2] = [0.5, 0.95];
/// Stops by which the luminance so metered, that of the brighter half, stands above the middle of what one looks at.
pub const BRIGHT_HALF_EV: f32 = 0.6;
/// Share of the counted pixels, and stops above middle grey that the luminance which this share does not exceed may stand at most: the glow about
/// a low sun keeps its colour, and the rest is darker for it, as a photographer would have it.
pub const HIGHLIGHT: [f32; 2] = [0.985, 1.8];
/// Stops by which the rest is darker for that at most: in empty space a star's disc alone is more than that share of what is counted, and the limb
/// beside it must not drown.
pub const HIGHLIGHT_COST_EV: f32 = 1.3;
/// What is by more stops darker than the highlights is black beside them and does not vote: the night side of a world behind its bright crescent.
pub const BLACK_EV: f32 = 14.0;
/// Log₂ of the luminance (cd/m²) of a star's disc: whatever is as bright is no highlight that others are black beside.
pub const DISC_LOG2: f32 = 22.0;
/// Luminance of land under a full moon, cd/m²; stops by which it is left darker than middle grey; stops more for every decade less.
pub const MOONLIT: [f32; 3] = [0.02, 2.2, 0.3];
/// Luminance of sunlit ground, cd/m²; the part of what exceeds it that is left to be seen as such; stops of that at most.
pub const BRIGHT: [f32; 3] = [4096.0, 0.5, 1.0];
/// Rates of adaptation to brighter and to darker light, 1/s.
pub const ADAPT_PER_S: [f32; 2] = [3.0, 1.5];
/// EV100 that a meter which sees nothing gives: a starry night.
pub const EV100_DARK: f32 = -6.0;

/// EV100 that places an average luminance (cd/m²) at middle grey.
pub fn ev100_of_luminance(luminance_cd_m2: f32) -> f32 {
    (luminance_cd_m2 * (100.0 / 12.5)).log2()
}

/// Factor from cd/m² to display-linear: 1 is where the sensor saturates.
pub fn exposure_of_ev100(ev100: f32) -> f32 {
    1.0 / (1.2 * ev100.exp2())
}

/// Stops by which a scene of this luminance is left darker than middle grey, so that dusk looks like dusk and totality like
/// night: the key of a scene, `1.03 − 2/(2 + log₁₀(L + 1))` [Krawczyk, Myszkowski & Seidel 2005, eq. 11], against a sunlit one's. That key has
/// no eyes for the night, where it falls by two stops within a decade and then no more: from there on ([`MOONLIT`]) every decade costs the same, so
/// that ground under a full moon is seen, and that under stars alone less.
pub fn dimness_ev(luminance_cd_m2: f32) -> f32 {
    const SUNLIT_KEY: f32 = 0.6769;
    let key = 1.03 - 2.0 / (2.0 + (luminance_cd_m2 + 1.0).log10());
    let night = MOONLIT[1] - MOONLIT[2] * (luminance_cd_m2.max(1e-9) / MOONLIT[0]).log10();
    (SUNLIT_KEY / key).log2().min(night).max(0.0)
}

/// Stops by which a scene of this luminance is left brighter than middle grey, so that snow in the sun is white and not grey.
pub fn brightness_ev(luminance_cd_m2: f32) -> f32 {
    (BRIGHT[1] * (luminance_cd_m2.max(1e-9) / BRIGHT[0]).log2()).clamp(0.0, BRIGHT[2])
}

/// Bin of a luminance in cd/m²; 0 for what is too dark, negative or NaN.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn bin_of_luminance(luminance_cd_m2: f32) -> usize {
    let x = (luminance_cd_m2.log2() - LOG2_MIN) / (LOG2_MAX - LOG2_MIN);
    if x >= 0.0 { (1.0 + x * (BINS - 1) as f32).min((BINS - 1) as f32) as usize } else { 0 }
}

/// EV100 metered from a histogram of [`BINS`] bins (missing bins count as empty), before compensation.
pub fn ev100_of_histogram(bins: &[u32]) -> f32 {
    let log2_of = |i: usize| LOG2_MIN + (i as f32 - 0.5) / (BINS - 1) as f32 * (LOG2_MAX - LOG2_MIN);
    let all = || bins.iter().copied().enumerate().take(BINS).skip(1);
    let below: f32 = all().filter(|(i, _)| log2_of(*i) < DISC_LOG2).map(|(_, n)| n as f32).sum();
    let (mut count, mut black) = (0.0, LOG2_MIN);
    for (i, n) in all() {
        black = if count < below * HIGHLIGHT[0] { log2_of(i) - BLACK_EV } else { black };
        count += n as f32;
    }
    let lit = || all().filter(|(i, _)| log2_of(*i) >= black);
    let total: f32 = lit().map(|(_, n)| n as f32).sum();
    let (low, high) = (total * METER_RANGE[0], total * METER_RANGE[1]);
    let (mut before, mut weight, mut sum, mut bright) = (0.0_f32, 0.0_f32, 0.0_f32, LOG2_MIN);
    for (i, n) in lit() {
        let after = before + n as f32;
        let inside = (after.min(high) - before.max(low)).max(0.0);
        let log2 = log2_of(i);
        sum += inside * log2;
        weight += inside;
        bright = if before < total * HIGHLIGHT[0] { log2 } else { bright };
        before = after;
    }
    let average = (sum / weight).exp2();
    let usual = sum / weight - BRIGHT_HALF_EV;
    let middle = usual.max((bright - HIGHLIGHT[1]).min(usual + HIGHLIGHT_COST_EV));
    if weight > 0.0 { ev100_of_luminance(middle.exp2()) + dimness_ev(average) - brightness_ev(average) } else { EV100_DARK }
}

/// EV100 after `dt_s` seconds of adaptation from `now` towards `goal`: exponential, quicker to bright light than to dark.
pub fn adapt(now_ev100: f32, goal_ev100: f32, dt_s: f32) -> f32 {
    let rate_per_s = if goal_ev100 > now_ev100 { ADAPT_PER_S[0] } else { ADAPT_PER_S[1] };
    goal_ev100 + (now_ev100 - goal_ev100) * (-rate_per_s * dt_s.max(0.0)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sunny_sixteen_rule() {
        // A sunlit scene of about 4,000 cd/m² is EV 15: f/16 at 1/125 s.
        assert!((ev100_of_luminance(4096.0) - 15.0).abs() < 1e-5);
        assert!((exposure_of_ev100(15.0) * 1.2 * 32768.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_histogram_finds_the_luminance() {
        for luminance in [1e-4_f32, 0.3, 4000.0, 1e6] {
            let mut bins = vec![0; BINS];
            bins[bin_of_luminance(luminance)] = 1000;
            bins[0] = 1_000_000; // black sky does not vote
            let key = dimness_ev(luminance) - brightness_ev(luminance);
            let wanted = ev100_of_luminance(luminance) - BRIGHT_HALF_EV + key;
            assert!((ev100_of_histogram(&bins) - wanted).abs() < 0.11, "{luminance}");
            // A glow over three hundredths of the picture is held, one of the brightness of a star's disc at no more than its cost; over one hundredth it is not.
            bins[bin_of_luminance(5.0 * luminance)] = 30;
            let held = ev100_of_luminance(5.0 * luminance) - HIGHLIGHT[1] + key;
            assert!((ev100_of_histogram(&bins) - held).abs() < 0.2, "{luminance}");
            bins[bin_of_luminance(5.0 * luminance)] = 0;
            bins[bin_of_luminance(1e9)] = 30;
            assert!((ev100_of_histogram(&bins) - wanted - HIGHLIGHT_COST_EV).abs() < 0.2, "{luminance}");
            bins[bin_of_luminance(1e9)] = 0;
            bins[bin_of_luminance(64.0 * luminance)] = 10;
            assert!((ev100_of_histogram(&bins) - wanted).abs() < 0.11, "{luminance}");
        }
        // Behind a bright crescent the night side is black.
        let mut crescent = vec![0; BINS];
        (crescent[bin_of_luminance(1e-3)], crescent[bin_of_luminance(4000.0)]) = (1000, 100);
        assert!((ev100_of_histogram(&crescent) - ev100_of_luminance(4000.0) + BRIGHT_HALF_EV).abs() < 0.11);
        assert_eq!(ev100_of_histogram(&[0; BINS]), EV100_DARK);
        assert_eq!([f32::NAN, -1.0, 0.0, 1e-9].map(bin_of_luminance), [0; 4]);
        assert_eq!(bin_of_luminance(f32::INFINITY), BINS - 1);
    }

    #[test]
    fn dim_scenes_stay_dim() {
        assert!(dimness_ev(4096.0) < 0.01 && dimness_ev(1e5) == 0.0);
        assert!((dimness_ev(100.0) - 0.36).abs() < 0.1 && dimness_ev(1.0) > 1.5);
        assert!(dimness_ev(0.0).is_finite() && dimness_ev(0.0) > 4.0);
    }

    #[test]
    fn a_darker_scene_is_never_shown_brighter_and_a_moonlit_one_is_legible() {
        // Tone of an even scene, stops above middle grey, from snow in the sun to a moonless night.
        let tone = |log2: f32| {
            let mut bins = vec![0; BINS];
            bins[bin_of_luminance(log2.exp2())] = 1000;
            log2 - (ev100_of_histogram(&bins).max(EV100_DARK) - ev100_of_luminance(1.0))
        };
        // A bin is a fifth of a stop wide.
        let steps: Vec<f32> = (-140..160).map(|i| tone(0.1 * i as f32)).collect();
        assert!(steps.windows(2).all(|w| w[1] >= w[0] - 0.21), "{steps:?}");
        assert!(steps.windows(40).all(|w| w[39] >= w[0] - 0.01), "{steps:?}");
        // 1.8 stops under middle grey are 58 of 255 on the screen, 3.5 are 19.
        assert!((-1.9..-1.4).contains(&tone(-5.6)), "land under a full moon: {}", tone(-5.6));
        assert!(tone(-14.0) < -3.5, "land under stars: {}", tone(-14.0));
        assert!((1.4..1.8).contains(&tone(14.6)), "snow in the sun: {}", tone(14.6));
    }

    #[test]
    fn adaptation_ends_at_its_goal() {
        assert!((adapt(15.0, 0.0, 20.0)).abs() < 1e-3);
        assert_eq!(adapt(3.0, 9.0, 0.0), 3.0);
        assert!(adapt(0.0, 10.0, 0.1) > 10.0 - adapt(10.0, 0.0, 0.1));
    }
}
