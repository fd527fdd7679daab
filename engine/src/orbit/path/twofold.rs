//! Twofold: a vector as the sum of two f64 words, so that thousands of steps do not wear its last digits off.
//!
//! Not here: the error-free sum and product that it is made of ([`crate::orbit::integrate::sums`]), who needs it ([`super::step`]).

use crate::orbit::integrate::sums::{two_product, two_sum};
use glam::DVec3;

/// `high + low`, with |low| at most half an ulp of high. Metres or metres per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    /// The value to f64.
    pub high: DVec3,
    /// What f64 leaves out.
    pub low: DVec3,
}

fn each(f: impl Fn(usize) -> (f64, f64)) -> (DVec3, DVec3) {
    let [x, y, z] = [f(0), f(1), f(2)];
    (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
}

impl Twofold {
    /// The sum, to f64.
    pub fn value(self) -> DVec3 {
        self.high + self.low
    }

    /// Plus another, to some 100 bits.
    pub fn plus(self, other: Self) -> Self {
        let (sum, error) = each(|i| two_sum(self.high[i], other.high[i]));
        Self { high: sum, low: DVec3::ZERO }.carrying(error + (self.low + other.low))
    }

    /// Times a number, to some 100 bits.
    pub fn times(self, factor: f64) -> Self {
        let (product, error) = each(|i| two_product(self.high[i], factor));
        Self { high: product, low: DVec3::ZERO }.carrying(error + self.low * factor)
    }

    /// Plus a small correction, words put in order again.
    fn carrying(self, small: DVec3) -> Self {
        let (high, low) = each(|i| two_sum(self.high[i], small[i]));
        Self { high, low }
    }
}

impl From<DVec3> for Twofold {
    fn from(high: DVec3) -> Self {
        Self { high, low: DVec3::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_word_loses_two_keep() {
        let mut two = Twofold::from(DVec3::splat(1.0));
        let mut one = DVec3::splat(1.0);
        for _ in 0..1000 {
            two = two.plus(DVec3::splat(1e-17).into());
            one += DVec3::splat(1e-17);
        }
        assert_eq!(one, DVec3::splat(1.0));
        assert!((two.low - DVec3::splat(1e-14) + (two.high - DVec3::splat(1.0))).length() < 1e-28);
    }
}
