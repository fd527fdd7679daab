//! `syzygy probe`: one number or table at a time, for tests and tools outside.

pub mod air;
