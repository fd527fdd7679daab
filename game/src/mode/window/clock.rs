//! The clock on the wall, and the only place where it meets the session: it says how many ticks are owed.

use engine::space::relative::narrow;
use engine::time::TICK_S;

/// Ticks that are made up for in one frame at most: after a stall the game goes on, it does not race.
pub const MOST_TICKS: u32 = 8;

/// Wall time that has passed but is not yet a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    owed_s: f64,
    /// Ticks dropped so far because frames took too long.
    pub dropped: u64,
}

impl Clock {
    /// Adds the time since the last frame and takes out whole ticks.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn advance(&mut self, dt_s: f64) -> u32 {
        if dt_s.is_finite() && dt_s > 0.0 {
            self.owed_s += dt_s;
        }
        let ticks = (self.owed_s / TICK_S).floor();
        self.owed_s = (self.owed_s - ticks * TICK_S).clamp(0.0, TICK_S);
        if ticks > f64::from(MOST_TICKS) {
            self.dropped += (ticks - f64::from(MOST_TICKS)) as u64;
            return MOST_TICKS;
        }
        ticks as u32
    }

    /// How far the picture is between the last tick and the next, 0 … 1.
    pub fn alpha(&self) -> f64 {
        (self.owed_s / TICK_S).clamp(0.0, 1.0)
    }

    /// Forgets what is owed (after a menu, a load).
    pub fn rest(&mut self) {
        self.owed_s = 0.0;
    }
}

/// Wall time between frames, for adaptation and animation, bounded.
pub fn bounded(dt_s: f64) -> f32 {
    narrow(dt_s.clamp(0.0, 0.25))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_follow_the_wall_at_any_frame_rate() {
        for rate in [24.0, 59.94, 60.0, 144.0, 1000.0] {
            let mut clock = Clock::default();
            let frames = (10.0 * rate) as u32;
            let ticks: u32 = (0..frames).map(|_| clock.advance(1.0 / rate)).sum();
            let expected = f64::from(frames) / rate * 60.0;
            assert!((f64::from(ticks) - expected).abs() <= 1.0, "{rate}: {ticks} {expected}");
            assert!((0.0..=1.0).contains(&clock.alpha()));
        }
    }

    #[test]
    fn a_stall_is_dropped_and_counted_not_raced_through() {
        let mut clock = Clock::default();
        assert_eq!(clock.advance(3.0), MOST_TICKS);
        assert_eq!(clock.dropped, 180 - u64::from(MOST_TICKS));
        assert_eq!(clock.advance(0.0), 0);
        assert_eq!(clock.advance(f64::NAN), 0);
        assert_eq!(clock.advance(-5.0), 0);
    }
}
