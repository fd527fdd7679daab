//! Light: the sun's disc, who hides it, and how the eye adapts.
