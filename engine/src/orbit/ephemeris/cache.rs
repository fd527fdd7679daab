//! The cache.

use super::orbit::{Details, Orbit};

/// Hash of what a system is made from.
pub fn key(orbits: &[Orbit], details: &Details) -> [u8; 32] {
    let mut hash = blake3::Hasher::new();
    hash.update(format!("{orbits:?}{details:?}").as_bytes());
    *hash.finalize().as_bytes()
}
