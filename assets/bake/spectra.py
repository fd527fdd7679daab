"""Compiles engine/src/light/spectrum/table.rs: the CIE 1931 2-degree observer and the Sun's spectrum, every 5 nm.

    pip download --no-deps colour-science==0.4.4   # unpack the wheel
    python spectra.py UNPACKED/colour ../../engine/src/light/spectrum/table.rs

Both are published standards (CIE 15:2004; ASTM G173-03, from NREL); the package only carries them. The Sun is averaged over each step,
so that a dark line between two rows is not lost.
"""
import ast
import sys
from pathlib import Path

FIRST, LAST, STEP = 350, 780, 5

HEAD = """//! The tables behind [`super`]: every 5 nm from 350 to 780 nm. Written by `assets/bake/spectra.py`; sources in `assets/CREDITS.md`.
//!
//! Not here: what is between the rows ([`super::observer`], [`super::Spectrum::sun`]).

/// Wavelength of the first row, nm.
pub const FIRST_NM: f64 = 350.0;
/// Step, nm.
pub const STEP_NM: f64 = 5.0;
/// Rows.
pub const ROWS: usize = {rows};

/// x̄, ȳ, z̄ of the CIE 1931 2° standard observer [CIE 15:2004]; 0 below 360 nm.
#[rustfmt::skip]
pub const OBSERVER: [[f64; 3]; ROWS] = [
{observer}
];

/// The Sun above the air at 1 au, W m⁻² nm⁻¹, averaged over each step [ASTM G173-03, extraterrestrial].
#[rustfmt::skip]
pub const SUN: [f64; ROWS] = [
{sun}
];
"""


def dictionary(path, name):
    """The dictionary literal that follows a name in a source file."""
    text = path.read_text()
    start = text.index("{", text.index(name))
    depth = 0
    for end in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        if depth == 0:
            return ast.literal_eval(text[start : end + 1])
    raise SystemExit(f"{path}: no dictionary after {name}")


def number(x):
    """Shortest float literal of six digits."""
    return repr(float(f"{x:.6g}"))


def rows_of(items, per_line):
    """Literals, so many to a line."""
    lines = [items[i : i + per_line] for i in range(0, len(items), per_line)]
    return "\n".join("    " + ", ".join(line) + "," for line in lines)


package, out = Path(sys.argv[1]), Path(sys.argv[2])
observer = dictionary(package / "colorimetry/datasets/cmfs.py", '"CIE 1931 2 Degree Standard Observer": {')
sun = dictionary(package / "plotting/datasets/astm_g_173.py", "DATA_ASTMG173_ETR: dict")
grid = range(FIRST, LAST + 1, STEP)
triples = ["[" + ", ".join(number(v) for v in observer.get(nm, (0, 0, 0))) + "]" for nm in grid]
means = []
for nm in grid:
    inside = [v for at, v in sun.items() if nm - STEP / 2 < at <= nm + STEP / 2]
    means.append(number(sum(inside) / len(inside)))
out.write_text(HEAD.format(rows=len(grid), observer=rows_of(triples, 4), sun=rows_of(means, 12)))
