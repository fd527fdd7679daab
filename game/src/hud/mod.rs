//! The HUD: panels, menus, maps. Each is a function of what the World told, and answers with what was clicked.

#[cfg(test)]
pub mod testing;
