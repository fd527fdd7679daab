//! The draft.
