//! Saves: what is kept of a flight, how it is written so that it is never lost, and how it is read with distrust.
//!
//! - [`v1`]: what is kept; [`restore`]: the way back to a World, distrusting each number
//! - [`format`]: the container: header, checksum, packing; replay logs use it too
//! - [`slots`]: the folder of saves: rings, `.bak`, falling back, the list
//! - [`file`]: one file replaced as a whole or not at all
//!
//! A save is also the scenario format: a start may name one, and a replay log begins with one.

pub mod file;
#[cfg(test)]
pub(crate) mod fixture;
pub mod format;
pub mod restore;
pub mod slots;
pub mod v1;

pub use format::{FormatError, Header};
pub use slots::{Loaded, Slots};
pub use v1::SaveV1;

use crate::world::World;
use std::path::PathBuf;

/// A World as the payload of a save.
pub fn encode(world: &World) -> Vec<u8> {
    // The only failure of this serializer is a writer's, and a Vec has none.
    rmp_serde::to_vec_named(&SaveV1::from(world)).unwrap_or_default()
}

/// Reads a payload; what it says is not yet checked against a system ([`SaveV1::restore`]).
///
/// # Errors
/// Where the payload is not of this format, and what was expected there.
pub fn decode(payload: &[u8]) -> Result<SaveV1, Vec<String>> {
    rmp_serde::from_slice(payload).map_err(|e| vec![format!("the payload is not a state of format 1: {e}")])
}

/// What the list of saves shows of a World.
pub fn label(world: &World) -> slots::Label {
    let rigid = world.rigid();
    let body = world.system.body(rigid.body);
    slots::Label { time: world.time, body: body.key.clone(), altitude_m: rigid.state.position.length() - body.radius_m }
}

/// A World saved and loaded in memory: what a file would give back.
///
/// # Errors
/// What [`SaveV1::restore`] finds wrong.
pub fn round_trip(world: &World) -> Result<World, Vec<String>> {
    decode(&encode(world))?.restore(&world.system, &world.ship.spec)
}

/// ` (did you mean …?)` for a name that is not among those known; empty when none is near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let best = known.map(|k| (strsim::damerau_levenshtein(name, k), k)).min();
    best.filter(|(d, k)| *d <= 2.max(k.len() / 3)).map_or_else(String::new, |(_, k)| format!("; did you mean `{k}`?"))
}

/// What may go wrong with a save.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SaveError {
    /// The file cannot be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    #[diagnostic(code(save::io), help("check the path and its rights; whatever was there before is as it was"))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// The container is damaged or from a newer program.
    #[error("{}: {source}", path.display())]
    #[diagnostic(code(save::format))]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong, and at which byte.
        source: FormatError,
    },
    /// The container is sound, what it says is not.
    #[error("{}: {}", path.display(), problems.join("; "))]
    #[diagnostic(code(save::state))]
    State {
        /// The file.
        path: PathBuf,
        /// Every field at fault, with what was expected.
        problems: Vec<String>,
    },
    /// What was written does not read back.
    #[error("{}: the save did not read back as it was written: {what}; nothing was replaced", path.display())]
    #[diagnostic(code(save::self_check), help("the disk or its driver is at fault: save to another disk"))]
    SelfCheck {
        /// The file.
        path: PathBuf,
        /// The difference.
        what: String,
    },
    /// Neither the file nor anything to fall back on can be read.
    #[error("{}: it cannot be read, and nothing to fall back on can: {}", path.display(), tried.join("; "))]
    #[diagnostic(code(save::nothing_left))]
    NothingLeft {
        /// The file asked for.
        path: PathBuf,
        /// What was tried, each with its reason.
        tried: Vec<String>,
    },
}

impl SaveError {
    /// True when the file was written by a newer program.
    pub fn is_newer(&self) -> bool {
        matches!(self, Self::Format { source, .. } if source.is_newer())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Action, Axes, Commands, Hold};
    use crate::world::ship::Motion;
    use v1::MotionV1;

    #[test]
    fn every_bit_comes_back_in_every_kind_of_motion() {
        for world in fixture::worlds() {
            let back = round_trip(&world).unwrap();
            assert_eq!(back.fields(), world.fields());
            assert_eq!(SaveV1::from(&back), SaveV1::from(&world));
        }
        assert!(fixture::worlds().iter().any(|w| matches!(w.ship.motion, Motion::Coast(_))), "the fixture coasts in one");
    }

    #[test]
    fn after_loading_the_same_ticks_give_the_same_bits() {
        for world in fixture::worlds() {
            let (mut kept, mut loaded) = (world.clone(), round_trip(&world).unwrap());
            for tick in 0..200_u64 {
                let axes = Axes { pitch: if tick > 60 { 9_000 } else { 0 }, ..Axes::default() };
                let actions = match tick {
                    20 => vec![Action::Throttle(30_000)],
                    150 => vec![Action::Hold(Hold::Prograde)],
                    _ => vec![],
                };
                let commands = Commands { axes, actions };
                kept.tick(&commands);
                loaded.tick(&commands);
            }
            assert_eq!(loaded.fields(), kept.fields());
            assert_ne!(kept.fields(), world.fields(), "the ticks did something");
        }
    }

    /// Changes one thing of a sound save and gives back what is said about it.
    fn said_of(change: impl Fn(&mut SaveV1)) -> String {
        let world = &fixture::worlds()[2];
        let mut save = SaveV1::from(world);
        change(&mut save);
        let bytes = rmp_serde::to_vec_named(&save).unwrap();
        decode(&bytes).unwrap().restore(&world.system, &world.ship.spec).map(drop).unwrap_err().join("; ")
    }

    fn state_of(save: &mut SaveV1) -> &mut v1::RigidV1 {
        match &mut save.ship.motion {
            MotionV1::Fly(r) => r,
            other => panic!("{other:?}"),
        }
    }

    macro_rules! refuses {
        ($($name:ident: $change:expr => $($word:literal),+;)*) => {$(
            #[test]
            fn $name() {
                let said = said_of($change);
                $(assert!(said.contains($word), "{said}");)+
            }
        )*};
    }
    refuses! {
        refuses_a_position_that_is_nan: |s: &mut SaveV1| state_of(s).state.position_m[1] = f64::NAN => "ship.motion.Fly.state.position_m.y: NaN";
        refuses_an_infinite_velocity: |s: &mut SaveV1| state_of(s).state.velocity_m_s[0] = f64::INFINITY => "velocity_m_s.x: inf";
        refuses_faster_than_light: |s: &mut SaveV1| state_of(s).state.velocity_m_s[2] = 4e8 => "velocity_m_s.z: 400000000";
        refuses_the_centre_of_a_body: |s: &mut SaveV1| state_of(s).state.position_m = [0.0; 3] => "at the body's centre";
        refuses_an_attitude_that_is_no_rotation: |s: &mut SaveV1| state_of(s).attitude = [0.0; 4] => "attitude: length 0", "unit quaternion";
        refuses_an_absurd_turn: |s: &mut SaveV1| state_of(s).rate_rad_s[0] = 1e9 => "rate_rad_s.x";
        refuses_negative_propellant: |s: &mut SaveV1| s.ship.propellant_kg = -1.0 => "ship.propellant_kg: -1, expected 0 to";
        refuses_more_than_the_tanks_hold: |s: &mut SaveV1| s.ship.propellant_kg = 1e12 => "ship.propellant_kg";
        refuses_an_unknown_warp: |s: &mut SaveV1| s.warp_asked = 200 => "warp_asked: 200, expected 0 to 11";
        refuses_a_date_beyond_belief: |s: &mut SaveV1| s.time_ticks = i64::MAX => "time_ticks: 9223372036854775807";
        refuses_a_body_that_is_not_there: |s: &mut SaveV1| state_of(s).state.body = "rok".into() => "has no body `rok`", "did you mean `rock`?";
        refuses_another_system: |s: &mut SaveV1| s.system = "three".into() => "saved in `three`";
        refuses_another_ship: |s: &mut SaveV1| s.ship_key = "arrow".into() => "ship_key: it was saved with `arrow`";
        refuses_a_spot_off_the_map: |s: &mut SaveV1| s.target.as_mut().unwrap().spot_udeg = Some((91_000_000, 0)) => "target.spot_udeg.0";
        refuses_a_landing_spot_that_is_no_direction: |s: &mut SaveV1| s.ship.landing.as_mut().unwrap().spot = [0.0; 3] => "ship.landing.spot";
        names_all_faults_at_once: |s: &mut SaveV1| {
            s.ship.nozzle = f64::NAN;
            s.quarters = 9;
        } => "ship.nozzle: NaN", "quarters: 9, expected 0 to 3";
    }

    #[test]
    fn a_payload_that_is_something_else_is_told_so() {
        for bad in [&b""[..], b"\x00", b"hello", &[0xdd, 0xff, 0xff, 0xff, 0xff], &[0x93; 5000]] {
            assert!(decode(bad).unwrap_err()[0].contains("not a state of format 1"));
        }
    }

    #[test]
    fn bent_payloads_never_panic() {
        let worlds = fixture::worlds();
        let mut x = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = move || {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            usize::try_from(x >> 33).unwrap()
        };
        let (mut taken, mut refused) = (0, 0);
        for round in 0..1500 {
            let world = &worlds[round % worlds.len()];
            let mut bytes = encode(world);
            for _ in 0..1 + next() % 4 {
                let at = next() % bytes.len();
                match next() % 4 {
                    0 => bytes[at] ^= 1 << (next() % 8),
                    1 => bytes[at] = [0x00, 0x7f, 0xc0, 0xca, 0xcb, 0xdd, 0xdf, 0xff][next() % 8],
                    2 => bytes.truncate(at.max(1)),
                    _ => drop(bytes.splice(at..at, [0xdf, 0xff, 0xff])),
                }
            }
            match decode(&bytes).and_then(|save| save.restore(&world.system, &world.ship.spec)) {
                Ok(mut world) => {
                    world.tick(&Commands::default());
                    assert!(world.fields().len() > 20);
                    taken += 1;
                }
                Err(problems) => {
                    assert!(!problems.is_empty());
                    refused += 1;
                }
            }
        }
        assert!(taken > 20 && refused > 500, "the changes reach deep: {taken} taken, {refused} refused");
    }
}
