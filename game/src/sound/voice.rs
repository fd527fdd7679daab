//! Voices: samples from filtered noise and sines, made on the audio thread without allocation.
//!
//! Each voice reads the shared [`Controls`] (atomics, no lock) once a batch and glides there, so that no change clicks.
//! Full levels are budgeted so that all voices together stay below 1: engine 0.42, wind 0.30, warning 0.20.

use super::levels::{Beep, Levels};
use engine::space::relative::narrow;
use kira::Frame;
use kira::info::Info;
use kira::sound::{Sound, SoundData};
use std::convert::Infallible;
use std::f32::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

const ENGINE_FULL: f32 = 0.42;
const WIND_FULL: f32 = 0.30;
const WARNING_FULL: f32 = 0.20;
/// Time in which a level covers 63 % of a change, s.
const GLIDE_S: f32 = 0.06;
/// Rise and fall of a beep, s.
const EDGE_S: f32 = 0.006;
/// Pitch and decay of a touchdown.
const THUMP_HZ: f32 = 52.0;
const THUMP_DECAY_S: f32 = 0.14;

/// A number that one thread sets and another reads.
#[derive(Debug, Default)]
struct Knob(AtomicU32);

impl Knob {
    fn set(&self, x: f32) {
        self.0.store(x.to_bits(), Ordering::Relaxed);
    }
    fn get(&self) -> f32 {
        f32::from_bits(self.0.load(Ordering::Relaxed))
    }
}

/// What the voices follow.
#[derive(Debug, Default)]
pub struct Controls {
    engine: Knob,
    engine_cutoff_hz: Knob,
    rcs: Knob,
    wind: Knob,
    wind_pitch_hz: Knob,
    buffet: Knob,
    warning: Knob,
    warning_pitch_hz: [Knob; 2],
    warning_on_every_s: [Knob; 2],
    thump: Knob,
    thumps: AtomicU32,
}

impl Controls {
    /// Follow these levels.
    pub fn set(&self, l: &Levels) {
        self.engine.set(l.engine);
        self.engine_cutoff_hz.set(l.engine_cutoff_hz);
        self.rcs.set(l.rcs);
        self.wind.set(l.wind);
        self.wind_pitch_hz.set(l.wind_pitch_hz);
        self.buffet.set(l.buffet);
        let Beep { pitch_hz, on_every_s, level } = l.warning;
        self.warning.set(level);
        if level > 0.0 {
            for i in 0..2 {
                self.warning_pitch_hz[i].set(pitch_hz[i]);
                self.warning_on_every_s[i].set(on_every_s[i]);
            }
        }
    }
    /// Lets a touchdown be heard, 0 … 1.
    pub fn thump(&self, strength: f32) {
        self.thump.set(strength);
        self.thumps.fetch_add(1, Ordering::Release);
    }
}

/// White noise in [−1, 1], xorshift32 [Marsaglia 2003].
#[derive(Clone, Copy, Debug)]
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        // The top 24 bits are exact in an f32.
        (self.0 >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

/// A state-variable filter in its trapezoidal form, stable at every cutoff [Zavalishin 2012, ch. 3.10].
#[derive(Clone, Copy, Debug, Default)]
struct Filter {
    s1: f32,
    s2: f32,
}

impl Filter {
    /// `(low, band, high)`; `damping` is 1/Q, the band has unit gain at its centre.
    fn run(&mut self, x: f32, cutoff_hz: f32, damping: f32, dt: f32) -> (f32, f32, f32) {
        let g = libm::tanf((core::f32::consts::PI * cutoff_hz * dt).min(1.4));
        let high = (x - (damping + g) * self.s1 - self.s2) / (1.0 + g * (damping + g));
        let band = g * high + self.s1;
        let low = g * band + self.s2;
        self.s1 = g * high + band;
        self.s2 = g * band + low;
        (low, band * damping, high)
    }
}

/// Follows a knob without a jump.
#[derive(Clone, Copy, Debug, Default)]
struct Glide(f32);

impl Glide {
    fn towards(&mut self, goal: f32, rate: f32) -> f32 {
        self.0 += (goal - self.0) * rate;
        // What cannot be heard is off; it also keeps the filters out of denormals.
        if goal == 0.0 && self.0.abs() < 1e-6 {
            self.0 = 0.0;
        }
        self.0
    }
}

/// Bends what exceeds the full level smoothly back under it.
fn limit(x: f32, full: f32) -> f32 {
    full * libm::tanhf(x / full)
}

/// The sources.
#[derive(Clone, Copy, Debug)]
enum Source {
    Engine { rumble: [Filter; 2], hiss: Filter, level: Glide, cutoff: Glide, rcs: Glide, thump: Thump },
    Wind { band: Filter, shake: Filter, level: Glide, pitch: Glide, buffet: Glide },
    Warning { clock_s: f32, odd: usize, phase: f32, edge: f32, level: Glide },
}

#[derive(Clone, Copy, Debug, Default)]
struct Thump {
    heard: u32,
    age_s: f32,
    strength: f32,
}

impl Thump {
    fn run(&mut self, noise: f32, dt: f32) -> f32 {
        if self.strength == 0.0 {
            return 0.0;
        }
        self.age_s += dt;
        let envelope = self.strength * (self.age_s / 0.004).min(1.0) * libm::expf(-self.age_s / THUMP_DECAY_S);
        if self.age_s > 2.0 {
            self.strength = 0.0;
        }
        envelope * (0.8 * libm::sinf(TAU * THUMP_HZ * self.age_s) + 0.2 * noise)
    }
}

/// A source that plays for ever.
pub struct Voice {
    controls: Arc<Controls>,
    noise: Noise,
    source: Source,
}

impl Voice {
    /// Main engine, thrusters and touchdown.
    pub fn engine(controls: &Arc<Controls>) -> Self {
        let source = Source::Engine {
            rumble: Default::default(),
            hiss: Filter::default(),
            level: Glide::default(),
            cutoff: Glide(80.0),
            rcs: Glide::default(),
            thump: Thump::default(),
        };
        Self { controls: Arc::clone(controls), noise: Noise(0x1234_5679), source }
    }
    /// Air along the hull.
    pub fn wind(controls: &Arc<Controls>) -> Self {
        let (level, buffet) = (Glide::default(), Glide::default());
        let source = Source::Wind { band: Filter::default(), shake: Filter::default(), level, pitch: Glide(200.0), buffet };
        Self { controls: Arc::clone(controls), noise: Noise(0x9e37_79b9), source }
    }
    /// Beeps.
    pub fn warning(controls: &Arc<Controls>) -> Self {
        let source = Source::Warning { clock_s: 0.0, odd: 0, phase: 0.0, edge: 0.0, level: Glide::default() };
        Self { controls: Arc::clone(controls), noise: Noise(1), source }
    }

    fn sample(&mut self, dt: f32) -> f32 {
        let c = &*self.controls;
        let rate = (dt / GLIDE_S).min(1.0);
        match &mut self.source {
            Source::Engine { rumble, hiss, level, cutoff, rcs, thump } => {
                let level = level.towards(c.engine.get(), rate);
                let cutoff = cutoff.towards(c.engine_cutoff_hz.get().max(40.0), rate);
                let rcs = rcs.towards(c.rcs.get(), 2.0 * rate);
                if level == 0.0 && rcs == 0.0 && thump.strength == 0.0 {
                    return 0.0;
                }
                let noise = self.noise.next();
                // Noise loses power as its band narrows; the gain gives it back by 1/√bandwidth.
                let gain = libm::sqrtf(1_600.0 / cutoff).min(5.0);
                let (low, ..) = rumble[0].run(noise, cutoff, 1.2, dt);
                let (low, ..) = rumble[1].run(low, cutoff, 1.6, dt);
                let (.., high) = hiss.run(noise, 2_500.0, 1.0, dt);
                let thump = thump.run(noise, dt);
                limit(0.9 * ENGINE_FULL * gain * level * low + 0.05 * rcs * high + ENGINE_FULL * thump, ENGINE_FULL)
            }
            Source::Wind { band, shake, level, pitch, buffet } => {
                let level = level.towards(c.wind.get(), rate);
                let pitch = pitch.towards(c.wind_pitch_hz.get().max(60.0), rate);
                let buffet = buffet.towards(c.buffet.get(), rate);
                if level == 0.0 && buffet == 0.0 {
                    return 0.0;
                }
                let noise = self.noise.next();
                let (_, hum, _) = band.run(noise, pitch, 0.9, dt);
                let (low, ..) = shake.run(noise, 28.0, 0.8, dt);
                limit(WIND_FULL * (1.6 * level * hum + 5.0 * buffet * low), WIND_FULL)
            }
            Source::Warning { clock_s, odd, phase, edge, level } => {
                let goal = c.warning.get();
                let [on, every] = [c.warning_on_every_s[0].get(), c.warning_on_every_s[1].get().max(0.05)];
                *clock_s += dt;
                if *clock_s >= every {
                    *clock_s = 0.0;
                    *odd ^= 1;
                }
                if goal == 0.0 && *edge < 1e-4 {
                    // The next warning begins with a beep, not in the middle of a pause.
                    (*clock_s, *odd, *edge, level.0) = (0.0, 0, 0.0, 0.0);
                    return 0.0;
                }
                let open = if goal > 0.0 && *clock_s < on { 1.0 } else { 0.0 };
                *edge += (open - *edge) * (dt / EDGE_S).min(1.0);
                let level = level.towards(goal.max(if open == 0.0 { level.0 } else { 0.0 }), 4.0 * rate);
                *phase = (*phase + c.warning_pitch_hz[*odd].get() * dt).fract();
                let tone = libm::sinf(TAU * *phase) + 0.25 * libm::sinf(2.0 * TAU * *phase);
                limit(WARNING_FULL * level * *edge * tone, WARNING_FULL)
            }
        }
    }
}

impl Sound for Voice {
    fn on_start_processing(&mut self) {
        if let Source::Engine { thump, .. } = &mut self.source {
            let thumps = self.controls.thumps.load(Ordering::Acquire);
            if thumps != thump.heard {
                *thump = Thump { heard: thumps, age_s: 0.0, strength: self.controls.thump.get() };
            }
        }
    }

    fn process(&mut self, out: &mut [Frame], dt: f64, _: &Info) {
        let dt = narrow(dt);
        for frame in out {
            *frame = Frame::from_mono(self.sample(dt));
        }
    }

    fn finished(&self) -> bool {
        false
    }
}

impl SoundData for Voice {
    type Error = Infallible;
    type Handle = ();
    fn into_sound(self) -> Result<(Box<dyn Sound>, ()), Infallible> {
        Ok((Box::new(self), ()))
    }
}
