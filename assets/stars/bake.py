#!/usr/bin/env python3
"""Makes stars.bin from `data/stars.8.json` of the npm package d3-celestial 0.7.35 (BSD-3-Clause, Olaf Frohn).

    npm pack d3-celestial@0.7.35 && tar xzf d3-celestial-0.7.35.tgz
    python3 assets/stars/bake.py package/data/stars.8.json assets/stars/stars.bin

Format (little-endian): the 8 bytes `SYZSTAR1`, u32 count, then per star, brightest first:
i16 x, y, z (J2000 direction, ICRF axes, times 32767), u8 (V + 2) * 20, u8 (B-V + 0.5) * 80.
"""
import json
import math
import struct
import sys


def main() -> None:
    source, out = sys.argv[1], sys.argv[2]
    stars = []
    with open(source, encoding="utf-8") as f:
        for feature in json.load(f)["features"]:
            ra, dec = (math.radians(a) for a in feature["geometry"]["coordinates"])
            v = float(feature["properties"]["mag"])
            # A star without a colour index is taken as solar.
            bv = float(feature["properties"].get("bv") or 0.65)
            xyz = (math.cos(dec) * math.cos(ra), math.cos(dec) * math.sin(ra), math.sin(dec))
            stars.append((v, bv, xyz))
    stars.sort(key=lambda s: s[0])
    byte = lambda x: max(0, min(255, round(x)))
    with open(out, "wb") as f:
        f.write(b"SYZSTAR1" + struct.pack("<I", len(stars)))
        for v, bv, xyz in stars:
            f.write(struct.pack("<3h2B", *(round(c * 32767) for c in xyz), byte((v + 2) * 20), byte((bv + 0.5) * 80)))
    print(f"{len(stars)} stars, V {stars[0][0]} to {stars[-1][0]}")


main()
