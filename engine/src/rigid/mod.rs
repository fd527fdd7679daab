//! Rigid bodies: a rapier world anchored near the ship, alive only near the ground.
