//! Sound: engine, thrusters, wind, touchdown and warnings, synthesised in code and driven by the [`Readout`] alone.
//!
//! - [`levels`]: Readout → how loud and how high each source is (plain numbers, testable by ear or by assertion)
//! - [`voice`]: levels → samples
//!
//! Nothing here reaches the World; without a sound card the game goes on after a notice.

pub mod levels;
pub mod voice;

use crate::world::readout::Readout;
use kira::backend::{Backend, DefaultBackend};
use kira::track::{TrackBuilder, TrackHandle};
use kira::{AudioManager, AudioManagerSettings, Decibels, Tween};
use levels::Levels;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use voice::{Controls, Voice};

/// Volume settings, each 0 … 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Volumes {
    /// Of everything.
    pub master: f32,
    /// Main engine, thrusters, touchdown.
    pub engine: f32,
    /// Air along the hull.
    pub wind: f32,
    /// Warnings.
    pub warning: f32,
}

impl Default for Volumes {
    fn default() -> Self {
        Self { master: 0.8, engine: 1.0, wind: 1.0, warning: 1.0 }
    }
}

/// Why there is no sound; to be shown as a small notice.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("No sound: {}; the game goes on without", .0.trim_end_matches('.'))]
pub struct Notice(pub String);

/// The game's sound.
pub struct Sound<B: Backend = DefaultBackend> {
    manager: AudioManager<B>,
    tracks: [TrackHandle; 3],
    controls: Arc<Controls>,
    last_touch: Option<(f64, i64)>,
}

impl Sound {
    /// Opens the sound card.
    ///
    /// # Errors
    /// A notice for the player where there is none.
    pub fn new(volumes: &Volumes) -> Result<Self, Notice> {
        let manager = AudioManager::<DefaultBackend>::new(AudioManagerSettings::default()).map_err(|e| Notice(e.to_string()))?;
        Self::with(manager, volumes)
    }
}

impl<B: Backend> Sound<B> {
    /// On a given output.
    ///
    /// # Errors
    /// A notice when the output takes no more tracks.
    pub fn with(mut manager: AudioManager<B>, volumes: &Volumes) -> Result<Self, Notice> {
        let controls = Arc::new(Controls::default());
        let mut track = |voice: Voice| -> Result<TrackHandle, Notice> {
            let mut track = manager.add_sub_track(TrackBuilder::new()).map_err(|e| Notice(e.to_string()))?;
            track.play(voice).map_err(|_| Notice("the mixer takes no more voices".into()))?;
            Ok(track)
        };
        let tracks = [track(Voice::engine(&controls))?, track(Voice::wind(&controls))?, track(Voice::warning(&controls))?];
        let mut sound = Self { manager, tracks, controls, last_touch: None };
        sound.set_volumes(volumes);
        Ok(sound)
    }

    /// Follows the readout; call once a frame. A paused game is silent.
    pub fn update(&mut self, readout: &Readout, paused: bool) {
        let levels = if paused { Levels::default() } else { Levels::of(readout) };
        self.controls.set(&levels);
        // A touch is new when its clock has started again, or its speed is another.
        if let Some((speed, ticks)) = readout.last_contact {
            let new = self.last_touch.is_none_or(|(s, t)| s.to_bits() != speed.to_bits() || ticks < t);
            if new && ticks < 60 && !paused {
                self.controls.thump(levels::thump(speed));
            }
        }
        self.last_touch = readout.last_contact;
    }

    /// Fades everything out, for menus.
    pub fn silence(&mut self) {
        self.controls.set(&Levels::default());
    }

    /// Applies volume settings, without a click.
    pub fn set_volumes(&mut self, volumes: &Volumes) {
        self.manager.main_track().set_volume(decibels(volumes.master), Tween::default());
        for (track, volume) in self.tracks.iter_mut().zip([volumes.engine, volumes.wind, volumes.warning]) {
            track.set_volume(decibels(volume), Tween::default());
        }
    }
}

/// A setting of 0 … 1 as decibels; loudness is felt by power, so the amplitude goes with the square.
fn decibels(volume: f32) -> Decibels {
    let amplitude = volume.clamp(0.0, 1.0) * volume.clamp(0.0, 1.0);
    if amplitude > 1e-4 { Decibels(20.0 * libm::log10f(amplitude)) } else { Decibels::SILENCE }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::readout::Warning;
    use kira::backend::Renderer;
    use std::sync::Mutex;

    /// An output that hands its renderer to the test, to be asked for samples.
    struct Ear(Arc<Mutex<Option<Renderer>>>);
    impl Backend for Ear {
        type Settings = Arc<Mutex<Option<Renderer>>>;
        type Error = ();
        fn setup(slot: Self::Settings, _: usize) -> Result<(Self, u32), ()> {
            Ok((Self(slot), 48_000))
        }
        fn start(&mut self, renderer: Renderer) -> Result<(), ()> {
            *self.0.lock().map_err(drop)? = Some(renderer);
            Ok(())
        }
    }

    struct Room {
        sound: Sound<Ear>,
        slot: Arc<Mutex<Option<Renderer>>>,
    }

    impl Room {
        fn new(volumes: &Volumes) -> Self {
            let slot: Arc<Mutex<Option<Renderer>>> = Arc::default();
            let settings = AudioManagerSettings::<Ear> {
                capacities: Default::default(),
                main_track_builder: Default::default(),
                internal_buffer_size: 128,
                backend_settings: Arc::clone(&slot),
            };
            let sound = Sound::with(AudioManager::new(settings).unwrap(), volumes).unwrap();
            Self { sound, slot }
        }
        /// Left channel over some 60ths of a second, the readout applied before each.
        fn hear(&mut self, readout: &Readout, frames: usize) -> Vec<f32> {
            let mut heard = Vec::new();
            for _ in 0..frames {
                self.sound.update(readout, false);
                let mut buffer = vec![0.0; 2 * 800];
                let mut slot = self.slot.lock().unwrap();
                let renderer = slot.as_mut().unwrap();
                renderer.on_start_processing();
                renderer.process(&mut buffer, 2);
                heard.extend(buffer.iter().step_by(2));
            }
            heard
        }
    }

    fn loudness(samples: &[f32]) -> f32 {
        (samples.iter().map(|x| x * x).sum::<f32>() / samples.len() as f32).sqrt()
    }

    fn full_blast() -> Readout {
        Readout {
            throttle: 1.0,
            rcs: 1.0,
            density_kg_m3: 1.2,
            dynamic_pressure_pa: 6.0e4,
            mach: 0.95,
            warnings: vec![Warning::PullUp],
            ..levels::tests::quiet()
        }
    }

    #[test]
    fn silence_is_silent_and_an_engine_is_not() {
        let mut room = Room::new(&Volumes::default());
        assert_eq!(loudness(&room.hear(&levels::tests::quiet(), 20)), 0.0);
        let engine = Readout { throttle: 1.0, ..levels::tests::quiet() };
        let in_vacuum = loudness(&room.hear(&engine, 60)[24_000..]);
        let in_air = loudness(&room.hear(&Readout { density_kg_m3: 1.2, ..engine.clone() }, 60)[24_000..]);
        assert!(in_vacuum > 0.005, "the hull carries it: {in_vacuum}");
        assert!(in_air > 2.0 * in_vacuum, "air carries it better: {in_air}");
        let off = loudness(&room.hear(&levels::tests::quiet(), 60)[40_000..]);
        assert!(off < 1e-4, "{off}");
    }

    #[test]
    fn everything_at_once_does_not_clip() {
        let mut room = Room::new(&Volumes { master: 1.0, ..Volumes::default() });
        let heard = room.hear(&full_blast(), 180);
        let peak = heard.iter().fold(0.0_f32, |m, x| m.max(x.abs()));
        assert!(peak < 0.99 && peak > 0.2, "{peak}");
        assert!(heard.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_sudden_change_does_not_click() {
        // The steepest step between samples must not be steeper at the change than in the sound itself.
        let step = |s: &[f32]| s.windows(2).fold(0.0_f32, |m, w| m.max((w[1] - w[0]).abs()));
        for loud in [
            Readout { throttle: 1.0, ..levels::tests::quiet() },
            Readout { warnings: vec![Warning::PullUp], ..levels::tests::quiet() },
            Readout { dynamic_pressure_pa: 4e4, mach: 0.7, density_kg_m3: 1.0, ..levels::tests::quiet() },
        ] {
            let mut room = Room::new(&Volumes::default());
            let on = step(&room.hear(&loud, 1));
            let steady = step(&room.hear(&loud, 120));
            let off = step(&room.hear(&levels::tests::quiet(), 2));
            assert!(on <= 1.05 * steady && off <= 1.05 * steady, "on {on}, off {off}, steady {steady}");
        }
    }

    #[test]
    fn volumes_act_on_their_own_kind() {
        let only_wind = Volumes { engine: 0.0, warning: 0.0, ..Volumes::default() };
        let engine = Readout { throttle: 1.0, warnings: vec![Warning::Heat], ..levels::tests::quiet() };
        assert!(loudness(&Room::new(&only_wind).hear(&engine, 60)[8_000..]) < 1e-5);
        let wind = Readout { dynamic_pressure_pa: 2e4, mach: 0.5, density_kg_m3: 1.0, ..levels::tests::quiet() };
        assert!(loudness(&Room::new(&only_wind).hear(&wind, 60)) > 0.01);
        assert!(loudness(&Room::new(&Volumes { master: 0.0, ..Volumes::default() }).hear(&wind, 60)[8_000..]) < 1e-5);
    }

    #[test]
    fn a_touchdown_is_heard_once() {
        let mut room = Room::new(&Volumes::default());
        room.hear(&levels::tests::quiet(), 5);
        let touched = |ticks| Readout { last_contact: Some((1.4, ticks)), ..levels::tests::quiet() };
        assert!(loudness(&room.hear(&touched(0), 6)) > 0.01);
        room.hear(&touched(7), 120);
        assert!(loudness(&room.hear(&touched(130), 30)) < 1e-4);
    }

    #[test]
    fn a_machine_without_a_sound_card_gets_a_notice_or_a_sound() {
        match Sound::new(&Volumes::default()) {
            Ok(mut sound) => sound.silence(),
            Err(notice) => assert!(notice.to_string().contains("the game goes on"), "{notice}"),
        }
    }
}
