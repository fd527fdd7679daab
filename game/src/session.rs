//! The session: the loop body that every mode calls.
