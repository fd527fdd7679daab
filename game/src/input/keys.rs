//! Physical keys: their names in the settings file and on the screen. Bindings follow the place of a key, not its letter,
//! so that W A S D stays a cross on every layout.

use winit::keyboard::KeyCode::{self, *};

/// Keys that can be bound, with the name used in files and on the screen.
const KEYS: &[(KeyCode, &str)] = &[
    (KeyA, "A"),
    (KeyB, "B"),
    (KeyC, "C"),
    (KeyD, "D"),
    (KeyE, "E"),
    (KeyF, "F"),
    (KeyG, "G"),
    (KeyH, "H"),
    (KeyI, "I"),
    (KeyJ, "J"),
    (KeyK, "K"),
    (KeyL, "L"),
    (KeyM, "M"),
    (KeyN, "N"),
    (KeyO, "O"),
    (KeyP, "P"),
    (KeyQ, "Q"),
    (KeyR, "R"),
    (KeyS, "S"),
    (KeyT, "T"),
    (KeyU, "U"),
    (KeyV, "V"),
    (KeyW, "W"),
    (KeyX, "X"),
    (KeyY, "Y"),
    (KeyZ, "Z"),
    (Digit0, "0"),
    (Digit1, "1"),
    (Digit2, "2"),
    (Digit3, "3"),
    (Digit4, "4"),
    (Digit5, "5"),
    (Digit6, "6"),
    (Digit7, "7"),
    (Digit8, "8"),
    (Digit9, "9"),
    (F1, "F1"),
    (F2, "F2"),
    (F3, "F3"),
    (F4, "F4"),
    (F5, "F5"),
    (F6, "F6"),
    (F7, "F7"),
    (F8, "F8"),
    (F9, "F9"),
    (F10, "F10"),
    (F11, "F11"),
    (F12, "F12"),
    (Escape, "Escape"),
    (Space, "Space"),
    (Enter, "Enter"),
    (Tab, "Tab"),
    (Backspace, "Backspace"),
    (Insert, "Insert"),
    (Delete, "Delete"),
    (Home, "Home"),
    (End, "End"),
    (PageUp, "PageUp"),
    (PageDown, "PageDown"),
    (ArrowUp, "ArrowUp"),
    (ArrowDown, "ArrowDown"),
    (ArrowLeft, "ArrowLeft"),
    (ArrowRight, "ArrowRight"),
    (ShiftLeft, "ShiftLeft"),
    (ShiftRight, "ShiftRight"),
    (ControlLeft, "ControlLeft"),
    (ControlRight, "ControlRight"),
    (AltLeft, "AltLeft"),
    (AltRight, "AltRight"),
    (CapsLock, "CapsLock"),
    (Comma, ","),
    (Period, "."),
    (Slash, "/"),
    (Semicolon, ";"),
    (Quote, "'"),
    (BracketLeft, "["),
    (BracketRight, "]"),
    (Backslash, "Backslash"),
    (IntlBackslash, "IntlBackslash"),
    (Minus, "-"),
    (Equal, "="),
    (Backquote, "`"),
    (Numpad0, "Numpad0"),
    (Numpad1, "Numpad1"),
    (Numpad2, "Numpad2"),
    (Numpad3, "Numpad3"),
    (Numpad4, "Numpad4"),
    (Numpad5, "Numpad5"),
    (Numpad6, "Numpad6"),
    (Numpad7, "Numpad7"),
    (Numpad8, "Numpad8"),
    (Numpad9, "Numpad9"),
    (NumpadAdd, "NumpadAdd"),
    (NumpadSubtract, "NumpadSubtract"),
    (NumpadMultiply, "NumpadMultiply"),
    (NumpadDivide, "NumpadDivide"),
    (NumpadDecimal, "NumpadDecimal"),
    (NumpadEnter, "NumpadEnter"),
];

/// The name of a key in files; `?` for one that cannot be bound.
pub fn name(code: KeyCode) -> &'static str {
    KEYS.iter().find(|(c, _)| *c == code).map_or("?", |(_, n)| n)
}

/// True when the key can be bound (has a name).
pub fn bindable(code: KeyCode) -> bool {
    KEYS.iter().any(|(c, _)| *c == code)
}

/// The key of a name, whatever its case.
pub fn code(name: &str) -> Option<KeyCode> {
    KEYS.iter().find(|(_, n)| n.eq_ignore_ascii_case(name)).map(|(c, _)| *c)
}

/// The valid name most like `name`.
pub fn nearest(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    KEYS.iter()
        .map(|(_, n)| (strsim::damerau_levenshtein(&n.to_lowercase(), &lower), *n))
        .min_by_key(|(d, _)| *d)
        .filter(|(d, n)| *d <= n.len() / 2)
        .map(|(_, n)| n)
}

/// What the player reads: `Shift (left)`.
pub fn label(code: KeyCode) -> String {
    let name = name(code);
    if let Some(stem) = name.strip_suffix("Left").filter(|s| !s.is_empty() && *s != "Arrow") {
        return format!("{} (left)", if stem == "Control" { "Ctrl" } else { stem });
    }
    if let Some(stem) = name.strip_suffix("Right").filter(|s| !s.is_empty() && *s != "Arrow") {
        return format!("{} (right)", if stem == "Control" { "Ctrl" } else { stem });
    }
    match name {
        "Escape" => "Esc".to_owned(),
        "PageUp" => "Page up".to_owned(),
        "PageDown" => "Page down".to_owned(),
        "ArrowUp" => "Up".to_owned(),
        "ArrowDown" => "Down".to_owned(),
        "ArrowLeft" => "Left".to_owned(),
        "ArrowRight" => "Right".to_owned(),
        other => other.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_round_trip() {
        for (c, n) in KEYS {
            assert_eq!(code(n), Some(*c));
            assert_eq!(name(*c), *n);
        }
        assert_eq!(label(ShiftLeft), "Shift (left)");
        assert_eq!(label(ArrowLeft), "Left");
        assert_eq!(nearest("spcae"), Some("Space"));
    }
}
