"""Scattering by the dust of Mars: the numbers of `assets/bodies/mars/atmosphere.toml`. Run by hand; nothing depends on it.

    pip install numpy
    python mars_dust.py

Mie scattering [Bohren & Huffman 1983, appendix A] by spheres with the gamma distribution n(r) ~ r^((1-3v)/v) exp(-r/(a v)) [Hansen & Travis 1974],
effective radius a = 1.6 um, effective variance v = 0.2, refractive index 1.5 + ik; k at each channel such that the single-scattering albedo is
about that of Tomasko et al. 1999 (Pathfinder) and Wolff et al. 2009.
"""
import math

import numpy as np

RADIUS_M, VARIANCE = 1.6e-6, 0.2
CHANNELS = {"red": (661e-9, 0.0012), "green": (550e-9, 0.0029), "blue": (442e-9, 0.0087)}
ANGLES_DEG = np.array([0, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 25, 30, 35, 40, 50, 60, 70, 80, 90, 100, 110, 120,
                       130, 140, 150, 160, 165, 170, 173, 176, 178, 180.0])


def mie(x, m, mu):
    """Efficiencies of extinction and scattering, and intensity by angle, of a sphere of size parameter x."""
    terms = int(x + 4 * x ** (1 / 3) + 2)
    start = int(max(terms, abs(m * x)) + 16)
    d = np.zeros(start + 1, complex)
    for n in range(start, 0, -1):
        d[n - 1] = n / (m * x) - 1 / (d[n] + n / (m * x))
    psi0, psi1, chi0, chi1 = math.cos(x), math.sin(x), -math.sin(x), math.cos(x)
    pi0, pi1 = np.zeros_like(mu), np.ones_like(mu)
    s1, s2 = np.zeros(len(mu), complex), np.zeros(len(mu), complex)
    scattering = extinction = 0.0
    for n in range(1, terms + 1):
        psi, chi = (2 * n - 1) * psi1 / x - psi0, (2 * n - 1) * chi1 / x - chi0
        xi, xi1 = complex(psi, -chi), complex(psi1, -chi1)
        a = ((d[n] / m + n / x) * psi - psi1) / ((d[n] / m + n / x) * xi - xi1)
        b = ((d[n] * m + n / x) * psi - psi1) / ((d[n] * m + n / x) * xi - xi1)
        scattering += (2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)
        extinction += (2 * n + 1) * (a + b).real
        tau = n * mu * pi1 - (n + 1) * pi0
        weight = (2 * n + 1) / (n * (n + 1))
        s1 += weight * (a * pi1 + b * tau)
        s2 += weight * (a * tau + b * pi1)
        pi0, pi1 = pi1, ((2 * n + 1) * mu * pi1 - (n + 1) * pi0) / n
        psi0, psi1, chi0, chi1 = psi1, psi, chi1, chi
    return 2 / x ** 2 * extinction, 2 / x ** 2 * scattering, (abs(s1) ** 2 + abs(s2) ** 2) / 2


def dust(wavelength_m, index):
    """Mean efficiency, single-scattering albedo, and phase function in 1/sr at ANGLES_DEG."""
    theta = np.radians(ANGLES_DEG)
    radii = np.exp(np.linspace(math.log(0.02 * RADIUS_M), math.log(6 * RADIUS_M), 160))
    number = radii * radii ** ((1 - 3 * VARIANCE) / VARIANCE) * np.exp(-radii / (RADIUS_M * VARIANCE))
    extinction = scattering = 0.0
    phase = np.zeros(len(theta))
    for r, n in zip(radii, number):
        qe, qs, intensity = mie(2 * math.pi * r / wavelength_m, index, np.cos(theta))
        extinction += n * qe * r * r
        scattering += n * qs * r * r
        phase += n * intensity
    phase /= 2 * math.pi * np.trapezoid(phase * np.sin(theta), theta)
    return extinction / (number * radii ** 2).sum(), scattering / extinction, phase


for name, (wavelength_m, k) in CHANNELS.items():
    efficiency, albedo, phase = dust(wavelength_m, complex(1.5, k))
    print(f"{name}: efficiency {efficiency:.3f}, single-scattering albedo {albedo:.4f}")
    print("  " + ", ".join(f"{v:.3g}" for v in phase))
