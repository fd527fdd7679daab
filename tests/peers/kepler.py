"""Kepler's problem by regime: error of `syzygy probe kepler` against 50-digit solutions, as multiples of what the inputs' last digit does.

    pip install mpmath gmpy2
    python3 tests/peers/kepler.py --syzygy target/release/syzygy [--cases 200] [--seed 1]
    python3 tests/peers/kepler.py --write tests/reference/kepler_cases.csv --cases 60     the cases that the engine's tests hold

The regimes are those on which REBOUND's universal solver was measured. A case's floor is the largest change of the result when
one of its eight inputs is changed by a part in 2^53 (half of a last digit, at most), and never less than 1.11e-16; position and
velocity are taken each as a vector, relative to its length. The truth is solved with mpmath from the f64 inputs as they are.
"""

import argparse
import csv
import math
import random
import subprocess
import sys
import tempfile
import time

from mpmath import cos, cosh, mp, mpf, nint, pi, sin, sinh, sqrt

mp.dps = 50
INPUTS = ["gm", "x", "y", "z", "vx", "vy", "vz", "dt"]
OUTPUTS = ["x", "y", "z", "vx", "vy", "vz"]
LAST = mpf(2) ** -53


def truth(case, start=None):
    """State after dt, and the universal anomaly. Universal variables [Battin 1999, s. 4.5], Newton's steps inside a bracket."""
    mu, x, y, z, vx, vy, vz, dt = case
    r, v = (x, y, z), (vx, vy, vz)
    r0 = sqrt(x * x + y * y + z * z)
    eta = x * vx + y * vy + z * vz
    beta = 2 * mu / r0 - (vx * vx + vy * vy + vz * vz)
    zeta = mu - beta * r0
    root = sqrt(abs(beta))

    def functions(s):
        if beta > 0:
            g0, g1 = cos(root * s), sin(root * s) / root
        elif beta < 0:
            g0, g1 = cosh(root * s), sinh(root * s) / root
        else:
            return mpf(1), s, s * s / 2, s**3 / 6
        return g0, g1, (1 - g0) / beta, (s - g1) / beta

    if beta > 0:
        period = 2 * pi * mu / (beta * root)
        dt -= period * nint(dt / period)

    def miss(s):
        g = functions(s)
        return r0 * g[1] + eta * g[2] + mu * g[3] - dt, r0 + eta * g[1] + zeta * g[2], g

    side = 1 if dt > 0 else -1
    if start is not None:
        s = start
        low, high = -mpf("inf"), mpf("inf")
    else:
        if beta > 0:
            far = 2 * pi / root
        else:
            far = abs(dt) / r0
            far = min(far, 1 / root) if beta < 0 else far
            while miss(side * far)[0] * side < 0:
                far *= mpf("1.5")
        low, high = sorted((mpf(0), side * far))
        s = (low + high) / 2
    for _ in range(400):
        m, radius, g = miss(s)
        if m > 0:
            high = s
        else:
            low = s
        step = s - m / radius
        if not low < step < high:
            step = (low + high) / 2
        done = abs(step - s) <= abs(s) * mpf(10) ** -30
        s = step
        if done:
            break
    else:
        return truth(case) if start is not None else sys.exit(f"no solution for {case}")
    m, radius, g = miss(s)
    f, gee = -mu * g[2] / r0, r0 * g[1] + eta * g[2]
    fd, gd = -mu * g[1] / (r0 * radius), -mu * g[2] / radius
    return [a + (a * f + b * gee) for a, b in zip(r, v)] + [b + (a * fd + b * gd) for a, b in zip(r, v)], s


def length(a):
    return sqrt(sum(x * x for x in a))


def apart(a, b):
    """Relative distances of positions and of velocities, b the measure."""
    return [float(length([p - q for p, q in zip(a[k : k + 3], b[k : k + 3])]) / length(b[k : k + 3])) for k in (0, 3)]


def floors(case, exact, s):
    worst = [1.11e-16, 1.11e-16]
    for k in range(8):
        if case[k] != 0:
            other = list(case)
            other[k] = case[k] * (1 + LAST)
            worst = [max(a, b) for a, b in zip(worst, apart(truth(other, s)[0], exact))]
    return worst


class Maker:
    """Random cases: any orientation, units from 1e-3 to 1e3."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def log(self, a, b):
        return math.exp(self.random.uniform(math.log(a), math.log(b)))

    def axes(self):
        def unit():
            while True:
                v = [self.random.uniform(-1, 1) for _ in range(3)]
                n = math.sqrt(sum(x * x for x in v))
                if 0.1 < n < 1:
                    return [x / n for x in v]

        p, w = unit(), unit()
        q = [p[1] * w[2] - p[2] * w[1], p[2] * w[0] - p[0] * w[2], p[0] * w[1] - p[1] * w[0]]
        n = math.sqrt(sum(x * x for x in q))
        return (p, [x / n for x in q]) if n > 0.3 else self.axes()

    def case(self, x, y, vx, vy, dt):
        p, q = self.axes()
        mu, unit = self.log(1e-3, 1e3), self.log(1e-3, 1e3)
        speed = math.sqrt(mu / unit)
        r = [(a * x + b * y) * unit for a, b in zip(p, q)]
        v = [(a * vx + b * vy) * speed for a, b in zip(p, q)]
        return [mu, *r, *v, dt * unit / speed]

    def sign(self):
        return self.random.choice((-1, 1))

    def ellipse(self, e, less, anomaly, dt):
        """`less` = 1 - e; dt in periods, forward or back."""
        b = math.sqrt(less * (1 + e))
        radius = less + 2 * e * math.sin(anomaly / 2) ** 2
        s, c = math.sin(anomaly), math.cos(anomaly)
        return self.case(c - e, b * s, -s / radius, b * c / radius, dt * 2 * math.pi * self.sign())

    def conic(self, e, p, nu, dt):
        """Semi-latus rectum p, true anomaly nu."""
        s, c = math.sin(nu), math.cos(nu)
        radius = p / (1 + e * c)
        return self.case(radius * c, radius * s, -s / math.sqrt(p), (e + c) / math.sqrt(p), dt * self.sign())

    def hyperbola(self, dt):
        e = self.random.uniform(1.01, 10)
        return self.conic(e, e * e - 1, self.random.uniform(-0.9, 0.9) * (math.pi - math.acos(1 / e)), dt)

    def radial_fall(self):
        radius = self.random.uniform(0.1, 2)
        speed = math.sqrt(max(2 / radius - 1, 0)) * self.sign()
        anomaly = math.copysign(math.acos(1 - radius), speed)
        mean = anomaly - math.sin(anomaly)
        to_centre = 2 * math.pi - mean if speed > 0 else -mean
        return self.case(radius, 0, speed, 0, to_centre * self.random.uniform(0, 0.98))

    def radial_escape(self):
        radius = self.random.uniform(0.1, 2)
        return self.case(radius, 0, math.sqrt(2 / radius + self.log(1e-2, 1e2)), 0, self.log(1e-2, 1e6))

    def near_parabola(self):
        e = 1 + self.log(1e-12, 1e-3) * self.sign()
        return self.conic(e, 1 + e, self.random.uniform(-2.5, 2.5), self.log(1e-2, 1e2))

    def slim(self, anomaly):
        less = self.log(1e-12, 1e-3)
        return self.ellipse(1 - less, less, anomaly, self.random.random())

    def bound(self, low, high, dt):
        e = self.random.uniform(low, high)
        return self.ellipse(e, 1 - e, self.random.uniform(0, 2 * math.pi), dt)

    def regimes(self):
        u = self.random
        return {
            "e<0.1 dt<0.05P (WH step)": lambda: self.bound(0, 0.1, u.uniform(0, 0.05)),
            "e<0.1 dt<P": lambda: self.bound(0, 0.1, u.random()),
            "e 0.1-0.9 dt<P": lambda: self.bound(0.1, 0.9, u.random()),
            "e 0.9-0.999 dt<P": lambda: self.bound(0.9, 0.999, u.random()),
            "1-e=1e-12..1e-3 dt<P": lambda: self.slim(u.uniform(0, 2 * math.pi)),
            "start at pericentre 1-e=1e-12..1e-3": lambda: self.slim(0),
            "|e-1|=1e-12..1e-3 q=1 (near parabolic)": self.near_parabola,
            "hyperbolic e 1.01-10 dt<10": lambda: self.hyperbola(u.uniform(0, 10)),
            "hyperbolic e 1.01-10 dt 1e3-1e8": lambda: self.hyperbola(self.log(1e3, 1e8)),
            "tiny dt 1e-12..1e-6 P e<0.99": lambda: self.bound(0, 0.99, self.log(1e-12, 1e-6)),
            "many periods dt=1e2..1e6 P e<0.9": lambda: self.bound(0, 0.9, self.log(1e2, 1e6)),
            "radial fall h=0 (bound; before centre)": self.radial_fall,
            "radial escape h=0 hyperbolic": self.radial_escape,
        }


def solved(case):
    exact = [mpf(x) for x in case]
    state, s = truth(exact)
    return state, floors(exact, state, s)


def ask(syzygy, cases):
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as f:
        f.write(",".join(INPUTS) + "\n" + "".join(",".join(map(repr, c)) + "\n" for c in cases))
        f.flush()
        said = subprocess.run([syzygy, "probe", "kepler", "--cases", f.name], capture_output=True, text=True, check=True).stdout
    rows = list(csv.DictReader(said.splitlines()))
    assert len(rows) == len(cases), "a row a case"
    return [[mpf(row[k]) for k in OUTPUTS] for row in rows]


def part(values, p):
    return sorted(values)[min(int(p * len(values)), len(values) - 1)]


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--syzygy", help="the program to measure")
    args.add_argument("--write", help="write the cases, their states and floors to this CSV")
    args.add_argument("--cases", type=int, default=200, help="for each regime")
    args.add_argument("--seed", type=int, default=1)
    args = args.parse_args()
    made = {name: [make() for _ in range(args.cases)] for name, make in Maker(args.seed).regimes().items()}
    if args.write:
        with open(args.write, "w") as out:
            out.write("regime," + ",".join(INPUTS) + "," + ",".join(k + "_after" for k in OUTPUTS) + ",floor_r,floor_v\n")
            for name, cases in made.items():
                for case in cases:
                    state, floor = solved(case)
                    row = [*map(repr, case), *(repr(float(x)) for x in state), *(f"{x:.2e}" for x in floor)]
                    out.write(name + "," + ",".join(row) + "\n")
    if args.syzygy:
        print(f"{'regime':40} {'error: median':>13} {'p99':>8} {'max':>8} {'floor median':>12}   error/floor: median    p99    max   velocity: max   NaN")
        for name, cases in made.items():
            got = ask(args.syzygy, cases)
            error, floor, ratio, ratio_v, lost = [], [], [], [], 0
            for case, state in zip(cases, got):
                exact, (fr, fv) = solved(case)
                if any(x != x for x in state):
                    lost += 1
                    continue
                er, ev = apart(state, exact)
                error.append(er)
                floor.append(fr)
                ratio.append(er / fr)
                ratio_v.append(ev / fv)
            print(
                f"{name:40} {part(error, 0.5):13.1e} {part(error, 0.99):8.1e} {max(error):8.1e} {part(floor, 0.5):12.1e}"
                f"   {part(ratio, 0.5):19.2f} {part(ratio, 0.99):6.2f} {max(ratio):6.2f} {max(ratio_v):15.2f} {lost:5}",
                flush=True,
            )


if __name__ == "__main__":
    started = time.time()
    main()
    print(f"{time.time() - started:.0f} s", file=sys.stderr)
