"""The JSON Schemas of an air against the game's own reader, by a validator that is not ours.

    pip install jsonschema
    python3 tests/peers/schema.py --syzygy target/release/syzygy

Every shipped atmosphere.toml and a list of broken ones are given to `jsonschema` and to `syzygy check-assets`; both must say the same.
What depends on other values (altitudes that rise, tables of one length, names that are there once) no schema can say: the reader alone
refuses it, and such files are not in the list.
"""

import argparse
import json
import subprocess
import tempfile
import tomllib
from pathlib import Path

from jsonschema import Draft7Validator

ROOT = Path(__file__).resolve().parents[2]
HEAD = "top_altitude_m = 100000.0\nground_albedo = [0.1, 0.1, 0.1]\n"
LAYER = """[[layers]]
name = "c"
scattering_per_m = [5.8e-6, 13.5e-6, 33.1e-6]
absorption_per_m = [0.0, 0.0, 0.0]
profile = { kind = "exponential", scale_height_m = 8000.0 }
phase = { kind = "rayleigh" }
"""
GAS = 'gas = { molecules = { air = 1.0 }, pressure_pa = 1e5, temperature_k = 280.0 }\n'


def swap(old, new):
    assert old in HEAD + LAYER, old
    return (HEAD + LAYER).replace(old, new)


# Name, text, whether it is good; for the whole file, then for a patch of Earth's.
WHOLE = [
    ("as it should be", HEAD + LAYER, True),
    ("a vacuum", HEAD + "layers = []\n", True),
    ("a gas", HEAD + "[[layers]]\n" + GAS, True),
    ("a model that needs no layers", 'model = "gradient"\ntop_altitude_m = 9e4\n', True),
    ("nothing to be seen", 'model = "none"\n', True),
    ("negative scale height", swap("8000.0", "-8000.0"), False),
    ("layer without a phase", swap('phase = { kind = "rayleigh" }\n', ""), False),
    ("unknown profile", swap('"exponential"', '"exponetial"'), False),
    ("one number for three", swap("[5.8e-6, 13.5e-6, 33.1e-6]", "5.8e-6"), False),
    ("g out of range", swap('"rayleigh"', '"cornette_shanks", g = 1.5'), False),
    ("unknown key", HEAD + LAYER + "sattering = 1\n", False),
    ("described twice", HEAD + LAYER + GAS, False),
    ("not described", HEAD + '[[layers]]\nname = "c"\n', False),
    ("gas without an amount", HEAD + "[[layers]]\ngas = { molecules = { air = 1.0 } }\n", False),
    ("no top", swap("top_altitude_m = 100000.0\n", ""), False),
    ("top below the ground", swap("100000.0", "-5.0"), False),
    ("no layers", HEAD, False),
    ("empty", "", False),
]
PATCH = [
    ("one key", "top_altitude_m = 9e4\n", True),
    ("a key of a layer", "[layers.haze.aerosol]\noptical_depth = 0.1\n", True),
    ("another kind", '[layers.haze.phase]\nkind = "isotropic"\n', True),
    ("layers taken out and added", 'layers.remove = ["ozone"]\n' + LAYER.replace("[[layers]]", "[[layers.add]]"), True),
    ("a key taken out", '[physics]\nremove = ["drag_top_m"]\ndrag_top_m = 1e5\n', True),
    ("empty", "", True),
    ("unknown key", "top_altitude = 9e4\n", False),
    ("unknown key of a layer", "[layers.haze]\nscatering_per_m = [1, 1, 1]\n", False),
    ("out of range", "top_altitude_m = -5\n", False),
    ("a word for a list", 'layers.remove = "ozone"\n', False),
    ("g out of range", "[layers.haze.phase]\ng = 3\n", False),
]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--syzygy", default="target/release/syzygy")
    program = arguments.parse_args().syzygy
    schema = {name: json.loads((ROOT / f"assets/{name}.schema.json").read_text()) for name in ("atmosphere", "atmosphere.patch")}
    for one in schema.values():
        Draft7Validator.check_schema(one)
    cases = [("atmosphere", path.parent.name, path.read_text(), True) for path in sorted((ROOT / "assets/bodies").glob("*/atmosphere.toml"))]
    cases += [("atmosphere", *case) for case in WHOLE] + [("atmosphere.patch", *case) for case in PATCH]
    wrong = 0
    for kind, name, text, good in cases:
        faults = list(Draft7Validator(schema[kind]).iter_errors(tomllib.loads(text)))
        with tempfile.TemporaryDirectory() as folder:
            body = Path(folder) / "bodies" / (name if (ROOT / "assets/bodies" / name).is_dir() else "earth")
            body.mkdir(parents=True)
            (body / f"{kind}.toml").write_text(text)
            read = subprocess.run([program, "check-assets", str(body)], capture_output=True, text=True).returncode == 0
        same = (not faults) == read == good
        wrong += not same
        said = "; ".join(f"{'/'.join(map(str, f.absolute_path))}: {f.message[:60]}" for f in faults[:2])
        print(f"{'same' if same else 'OTHERWISE':9} {kind:16} {name}: {'good' if read else 'refused'} {said}")
    print(f"{len(cases)} files, {wrong} of which schema and reader judge otherwise")
    raise SystemExit(wrong > 0)


main()
