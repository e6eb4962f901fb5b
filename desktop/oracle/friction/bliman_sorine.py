#!/usr/bin/env python3
"""Writes bliman_sorine.toml: 20 random stable, dissipative systems of eq. (8), p = 1..4, and their force along a path.

A = (J - R) Q with J skew, R and Q positive definite, and C = B^T Q: dissipative with the storage x^T Q x / 2. Each
path is of strokes from 1e-6 to 10 of the system's longest distance, either way. The force after each is by scipy's
expm; the script refuses to write unless solve_ivp arrives at the same.

Exit code 0 when written, 1 when the two disagree, 2 when scipy is missing; nothing is written then.
"""

import argparse
import pathlib
import sys

try:
    import numpy as np
    import scipy
    from scipy.integrate import solve_ivp
    from scipy.linalg import expm
except ModuleNotFoundError as missing:
    print(f"bliman_sorine: {missing.name} is not installed; pip install scipy==1.17.1", file=sys.stderr)
    sys.exit(2)

OUTPUT = pathlib.Path(__file__).with_suffix(".toml")
SYSTEMS = 20
STROKES = 24
# Largest relative difference of the two (of the kinetic level): the tolerance of solve_ivp.
AGREEMENT = 1e-10


def positive_definite(random, p):
    root = random.normal(size=(p, p))
    return root @ root.T + 0.1 * np.eye(p)


def system(random, p):
    skew = random.normal(size=(p, p))
    storage = positive_definite(random, p)
    per_distance = 10.0 ** random.uniform(-1.0, 4.0)
    a = per_distance * (2.0 * (skew - skew.T) - positive_definite(random, p)) @ storage
    b = per_distance * random.normal(size=p)
    return a, b, (b @ storage) / per_distance


def strokes(random, a):
    longest = 1.0 / -np.linalg.eigvals(a).real.max()
    sizes = longest * 10.0 ** random.uniform(-6.0, 1.0, STROKES)
    return sizes * random.choice([-1.0, 1.0], STROKES)


def by_expm(a, b, x, stroke):
    target = -np.linalg.solve(a, b) * np.sign(stroke)
    return target + expm(a * abs(stroke)) @ (x - target)


def by_solve_ivp(a, b, x, stroke):
    drive = b * np.sign(stroke)
    solution = solve_ivp(
        lambda _, x: a @ x + drive, (0.0, abs(stroke)), x, "Radau", rtol=1e-13, atol=1e-14, jac=lambda *_: a
    )
    return solution.y[:, -1]


def walk(step, a, b, c, path):
    x, forces = np.zeros(len(b)), []
    for stroke in path:
        x = step(a, b, x, stroke)
        forces.append(c @ x)
    return np.array(forces)


def numbers(values):
    return "[" + ", ".join(f"{value:.17e}" for value in values) + "]"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=OUTPUT, help="default: %(default)s")
    arguments = parser.parse_args()
    random = np.random.default_rng(1)
    text, worst = f"# scipy {scipy.__version__}, desktop/oracle/friction/bliman_sorine.py\n", 0.0
    for k in range(SYSTEMS):
        a, b, c = system(random, 1 + k % 4)
        path = strokes(random, a)
        forces = walk(by_expm, a, b, c, path)
        level = -c @ np.linalg.solve(a, b)
        worst = max(worst, np.abs(walk(by_solve_ivp, a, b, c, path) - forces).max() / level)
        text += "\n[[system]]\n"
        text += "a_per_m = [" + ", ".join(numbers(row) for row in a) + "]\n"
        text += f"b = {numbers(b)}\nc = {numbers(c)}\nlevel_n = {level:.17e}\n"
        text += f"strokes_m = {numbers(path)}\nforces_n = {numbers(forces)}\n"
    print(f"scipy {scipy.__version__}: expm and solve_ivp differ by {worst:.1e} of the level, at most {AGREEMENT:.0e}")
    if not worst <= AGREEMENT:
        sys.exit("bliman_sorine: the two disagree: nothing written")
    arguments.output.write_text(text)
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
