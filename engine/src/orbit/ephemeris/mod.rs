//! The ephemeris: position and velocity of body B at time t. This interface is deliberately narrow: what stands behind it
//! may be replaced without any caller noticing.
//!
//! A system starts from the states (or mean elements) of its bodies at its epoch and is integrated outwards from there, as far as
//! somebody asks, into Chebyshev polynomials: a query is O(1) and has the same bits whoever asked first. [`Ephemeris::prepare`]
//! integrates ahead in a thread of its own, [`cache`] keeps the result on disk.
//!
//! Read [`tree`] (who is integrated with whom), [`planets`] and [`moons`] (the forces), [`level`] (chunks of time), [`chunk`]
//! (the polynomials). Accuracy is that of the masses, states and forces given: `assets/systems/sol/system.toml` has the measured errors.
//! Not here: rotation, ships.

mod cache;
mod chunk;
mod handle;
mod level;
mod mean;
mod moons;
mod orbit;
mod planets;
mod prepare;
mod tree;

pub use cache::CacheError;
pub use handle::Ephemeris;
pub use orbit::{Details, EphemerisError, Mass, MeanOrbit, Orbit, Path};

#[cfg(test)]
mod tests;
