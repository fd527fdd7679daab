#!/usr/bin/env python3
"""Paints the two pictures of the world `painted` (model `gradient`): assets/bodies/painted/atmosphere_{shell,ground}.png.

A start for whoever paints their own: `python3 assets/bake/gradient.py [FOLDER]` writes them into FOLDER. Nothing beyond Python is needed.

The shell, 32 x 16: from left (away from the sun) to right (toward it) night, dusk, sunset, day; from the bottom (along the surface) to
the top (the edge of the air) each colour passes from the ramp LOW to the ramp EDGE by the square of the height. The ground, 32 x 2:
top row the colour of the air over it, bottom row what the sun's light is multiplied by; left midnight, middle the sun on the
horizon, right noon. Colours are sRGB.
"""

import struct
import sys
import zlib
from pathlib import Path

LOW = [(0.0, (0, 0, 0)), (0.14, (38, 16, 60)), (0.3, (190, 48, 110)), (0.46, (250, 170, 96)), (0.64, (150, 206, 176)), (1.0, (96, 190, 186))]
EDGE = [(0.0, (0, 0, 0)), (0.2, (30, 12, 70)), (0.42, (110, 40, 140)), (0.66, (40, 70, 170)), (1.0, (20, 60, 150))]
AIR = [(0.0, (0, 0, 0)), (0.43, (0, 0, 0)), (0.5, (170, 50, 90)), (0.58, (220, 160, 110)), (0.72, (130, 200, 180)), (1.0, (96, 190, 186))]
SUN = [(0.0, (255, 255, 255)), (0.4, (255, 220, 226)), (0.5, (255, 130, 110)), (0.6, (255, 214, 170)), (1.0, (255, 255, 250))]


def ramp(stops, x):
    """The colour at x, linear between the stops."""
    for (a, low), (b, high) in zip(stops, stops[1:]):
        if x <= b:
            t = (x - a) / (b - a)
            return [p + (q - p) * t for p, q in zip(low, high)]
    return list(stops[-1][1])


def shell(u, v):
    low, edge = ramp(LOW, u), ramp(EDGE, u)
    return [e + (c - e) * v * v for c, e in zip(low, edge)]


def ground(u, v):
    return ramp(AIR if v < 0.5 else SUN, u)


def png(path, size, colour):
    """Writes an 8-bit RGBA picture of a function of u (left 0, right 1) and v (top 0, bottom 1)."""
    w, h = size
    rows = bytearray()
    for y in range(h):
        rows.append(0)
        for x in range(w):
            rows += bytes(min(255, max(0, round(c))) for c in colour(x / (w - 1), y / (h - 1))) + b"\xff"
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", w, h, 8, 6, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))


def main():
    here = Path(__file__).resolve().parent
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else here.parent / "bodies" / "painted"
    png(folder / "atmosphere_shell.png", (32, 16), shell)
    png(folder / "atmosphere_ground.png", (32, 2), ground)


if __name__ == "__main__":
    main()
