//! Adaptive quadrature of three channels at once: Gauss–Kronrod on panels, the worst panel halved until all channels are good.
//!
//! Kronrod 1965; nodes and weights as in QUADPACK's QK15 [Piessens et al. 1983].

use glam::DVec3;

/// Positive nodes of the 15-point Kronrod rule, outermost first; the odd ones are the 7-point Gauss rule's.
const NODE: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
const GAUSS: [f64; 4] = [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// Panels after which an integral is taken as it is: one with so many kinks is beyond what is asked of it.
const MAX_PANELS: usize = 3000;

struct Panel {
    from: f64,
    to: f64,
    value: DVec3,
    error: DVec3,
}

fn panel(f: &mut impl FnMut(f64) -> DVec3, from: f64, to: f64) -> Panel {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (DVec3::ZERO, DVec3::ZERO);
    for (i, (node, weight)) in NODE.iter().zip(KRONROD).enumerate() {
        let sum = if *node == 0.0 { f(centre) } else { f(centre - half * node) + f(centre + half * node) };
        kronrod += sum * weight;
        if i % 2 == 1 {
            gauss += sum * GAUSS[i / 2];
        }
    }
    Panel { from, to, value: kronrod * half, error: (kronrod - gauss).abs() * half }
}

/// Integral of `f` from the first to the last of `breaks` (rising; `f` may bend or jump at them), each channel to `relative` of itself.
pub fn integrate(f: &mut impl FnMut(f64) -> DVec3, breaks: &[f64], relative: f64) -> DVec3 {
    let mut panels: Vec<Panel> = breaks.iter().zip(breaks.iter().skip(1)).filter(|(a, b)| b > a).map(|(a, b)| panel(f, *a, *b)).collect();
    loop {
        let value: DVec3 = panels.iter().map(|p| p.value).sum();
        let error: DVec3 = panels.iter().map(|p| p.error).sum();
        // A channel that is a billionth of the brightest need not be good.
        let scale = value.abs().max(DVec3::splat(value.abs().max_element() * 1e-9)).max(DVec3::splat(f64::MIN_POSITIVE));
        if panels.len() >= MAX_PANELS || (error / scale).max_element() <= relative {
            return value;
        }
        let badness = |p: &Panel| (p.error / scale).max_element();
        let Some((worst, _)) = panels.iter().enumerate().max_by(|a, b| badness(a.1).total_cmp(&badness(b.1))) else { return value };
        let Panel { from, to, .. } = panels.swap_remove(worst);
        let middle = 0.5 * (from + to);
        if middle <= from || middle >= to {
            return value;
        }
        panels.push(panel(f, from, middle));
        panels.push(panel(f, middle, to));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_integrals() {
        let mut f = |x: f64| DVec3::new(x.exp(), x.sqrt(), if x < 0.3 { 0.0 } else { 1.0 });
        let v = integrate(&mut f, &[0.0, 0.3, 1.0], 1e-12);
        assert!((v - DVec3::new(1.0_f64.exp() - 1.0, 2.0 / 3.0, 0.7)).abs().max_element() < 1e-11, "{v}");
        let peak = integrate(&mut |x: f64| DVec3::splat((-1e6 * (x - 0.37) * (x - 0.37)).exp()), &[0.0, 0.4, 1.0], 1e-9);
        assert!((peak.x / (core::f64::consts::PI / 1e6).sqrt() - 1.0).abs() < 1e-9);
        assert_eq!(integrate(&mut |_| DVec3::ONE, &[], 1e-3), DVec3::ZERO);
        assert!(integrate(&mut |_| DVec3::NAN, &[0.0, 1.0], 1e-3).is_nan());
    }
}
