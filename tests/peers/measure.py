#!/usr/bin/env python3
"""Run REBOUND's IAS15 and heyoka's Taylor method on the ten cases of tests/reference/orbit_cases.json.

Prints JSON: [{case, method, options, cpu_s, force_evals, steps, position_error, energy_error}], units of the case.
cpu_s is process CPU time of the integration alone, the least of several repeats; set-up and heyoka's compilation are left out.
position_error is the largest |x - x_ref| over the bodies at the end, the positions being what the method returns in f64.

    python3 tests/peers/measure.py --venv /some/folder --out peers.json            # all cases, a few minutes
    python3 tests/peers/measure.py --case LEO_1000orb --case FIG8_100T             # some
    python3 tests/peers/measure.py --also 'target/release/syzygy bench orbit ...'  # a command run between the peers; its JSON is merged

The virtual environment is made on the first call (packages rebound, heyoka, numpy by name) and used again later.
"""
import argparse
import json
import os
import shlex
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

CASES = Path(__file__).resolve().parent.parent / "reference" / "orbit_cases.json"
# PYTHAG is chaotic: at 70 every method has lost its digits, at 10 it is a measure. `case@t` ends at an earlier reference time.
NAMES = ["LEO_1000orb", "KEP_e0.99_1000orb", "KEP_e0.999_1000orb", "EMS_1yr", "ARENSTORF_1T", "PYTHAG_70", "PYTHAG_70@10", "FIG8_100T",
         "OSS5_10000yr", "SS9_100yr", "SS11_100yr"]
IAS15 = [("PRS23", eps) for eps in (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4)] + [("GLOBAL", 1e-9), ("GLOBAL", 1e-7)]
HEYOKA = [(1e-9, False), (1e-12, False), (1e-15, False), (None, False), (None, True), (1e-18, True)]


def enter_venv(folder):
    """Re-run this script inside a virtual environment that has the peers, making it where it is missing."""
    python = Path(folder) / "bin" / "python"
    if Path(sys.prefix).resolve() == Path(folder).resolve():
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "--quiet", "rebound", "heyoka", "numpy"], check=True, stdout=sys.stderr)
    os.execv(python, [str(python), *sys.argv])


def load(name):
    case_name, _, at = name.partition("@")
    case = json.loads(CASES.read_text())[case_name]
    bodies = [[float.fromhex(x) for x in row[1:]] for row in case["bodies_hex"]]
    reference = next(r for r in case["reference"] if float(r["t"]) == float(at)) if at else case["reference"][-1]
    return bodies, float.fromhex(reference["t_hex"]), [[Fraction(x) for x in row[:3]] for row in reference["state"]]


def position_error(positions, reference):
    def length(p, r):
        return float(sum((Fraction(float(a)) - b) ** 2 for a, b in zip(p, r))) ** 0.5

    return max(length(p, r) for p, r in zip(positions, reference))


def energy(bodies):
    """Total energy, or, with one massive body, that of the massless ones for unit mass; None where neither is kept."""
    massive = sum(1 for b in bodies if b[0] > 0.0)
    if massive == 0 or (massive > 1 and massive < len(bodies)):
        return None
    total = Fraction(0)
    for i, b in enumerate(bodies):
        weight = Fraction(b[0]) if massive > 1 else Fraction(int(b[0] == 0.0))
        total += weight * sum(Fraction(x) ** 2 for x in b[4:7]) / 2
        for c in bodies[:i]:
            r2 = sum((Fraction(p) - Fraction(q)) ** 2 for p, q in zip(b[1:4], c[1:4]))
            # 1/√(r²) to far beyond f64 by one Newton step from the float.
            y = Fraction(float(r2) ** -0.5)
            y = y * (3 - r2 * y * y) / 2
            total -= (Fraction(b[0]) * Fraction(c[0]) if massive > 1 else Fraction(b[0] + c[0])) * y
    return total


def timed(make, run, repeats, budget):
    best, result, spent = float("inf"), None, 0.0
    for _ in range(repeats):
        state = make()
        start = time.process_time()
        result = run(state)
        took = time.process_time() - start
        best, spent = min(best, took), spent + took
        if spent > budget:
            break
    return best, result


def row(name, method, options, cpu, steps, final, bodies, reference):
    first, last = energy(bodies), energy(final)
    return {
        "case": name, "method": method, "options": options, "cpu_s": cpu, "force_evals": None, "steps": steps,
        "position_error": position_error([b[1:4] for b in final], reference),
        "energy_error": None if first is None else abs(float((last - first) / first)),
    }


def ias15(name, repeats, budget):
    import rebound

    bodies, end, reference = load(name)
    massive = sum(1 for b in bodies if b[0] > 0.0)
    for mode, eps in IAS15:
        def make():
            sim = rebound.Simulation()
            sim.G = 1.0
            sim.integrator = "ias15"
            sim.integrator.epsilon = eps
            sim.integrator.adaptive_mode = mode
            for m, x, y, z, vx, vy, vz in bodies:
                sim.add(m=m, x=x, y=y, z=z, vx=vx, vy=vy, vz=vz)
            sim.N_active = massive
            return sim

        def run(sim):
            sim.integrate(end, exact_finish_time=1)
            return sim

        cpu, sim = timed(make, run, repeats, budget)
        final = [[p.m, p.x, p.y, p.z, p.vx, p.vy, p.vz] for p in sim.particles]
        yield row(name, "rebound-ias15", f"eps={eps:g} mode={mode}", cpu, int(sim.steps_done), final, bodies, reference)


def heyoka(name, repeats, budget):
    import heyoka as hy

    bodies, end, reference = load(name)
    massive = sum(1 for b in bodies if b[0] > 0.0)
    # One massive body stands still: fewer equations, the kindest form for the peer.
    alone = massive == 1 and len(bodies) == 2
    if alone:
        system = hy.model.fixed_centres(Gconst=1.0, masses=[bodies[0][0]], positions=[[0.0, 0.0, 0.0]])
        state = bodies[1][1:]
    else:
        system = hy.model.nbody(len(bodies), masses=[b[0] for b in bodies[:massive]])
        state = [x for b in bodies for x in b[1:]]
    for compact in ([False, True] if len(bodies) <= 5 else [True]):
        for tol, accurate in HEYOKA:
            method = hy.taylor_adaptive(system, state, compact_mode=compact, high_accuracy=accurate, **({} if tol is None else {"tol": tol}))

            def make():
                method.time = 0.0
                method.state[:] = state
                return method

            def run(ta):
                return ta.propagate_until(end)[3]

            cpu, steps = timed(make, run, repeats, budget)
            s = [float(x) for x in method.state]
            final = [bodies[0], [0.0, *s]] if alone else [[b[0], *s[6 * i:6 * i + 6]] for i, b in enumerate(bodies)]
            options = f"order={method.order} tol={method.tol:g}" + (" high_accuracy" if accurate else "") + (" compact" if compact else "")
            yield row(name, "heyoka-taylor", options, cpu, int(steps), final, bodies, reference)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", action="append", help="a case, or case@t; may be given several times (default: all)")
    parser.add_argument("--venv", default=str(Path(__file__).resolve().parents[2] / "target" / "peers"), help="where the peers are installed")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--budget", type=float, default=2.0, help="seconds after which a run is not repeated")
    parser.add_argument("--also", action="append", default=[], help="a command that prints rows of the same form for '{case}'")
    parser.add_argument("--method", choices=["ias15", "heyoka"], action="append")
    parser.add_argument("--out")
    args = parser.parse_args()
    enter_venv(args.venv)
    rows = []
    for name in args.case or NAMES:
        for method, kind in (("ias15", ias15), ("heyoka", heyoka)):
            if method in (args.method or ["ias15", "heyoka"]):
                for r in kind(name, args.repeats, args.budget):
                    print(f"{name} {r['method']} {r['options']}: {r['cpu_s']:.6f} s, {r['steps']} steps, error {r['position_error']:.3g}", file=sys.stderr)
                    rows.append(r)
        for command in args.also:
            rows += json.loads(subprocess.run(shlex.split(command.replace("{case}", name)), check=True, capture_output=True).stdout)
    text = json.dumps(rows, indent=1)
    if args.out:
        Path(args.out).write_text(text + "\n")
    else:
        print(text)


if __name__ == "__main__":
    main()
