#!/usr/bin/env python3
"""Writes chain.csv: both spans of the belt of gears/belt/at5-16.toml as chains of point masses, which move the output under a load.

Each span has NODES masses between the pulleys; springs with dampers beside them join neighbours. A link pulls with the pretension and what
spring and damper add, and never pushes: without tension in the spring it has none. Half of a link's mass at each end and the belt on a
pulley turn with it. No friction, no pitch error. The motor turns as prescribed, from rest to rest; the output is free. The load first
pulls it backwards, then forwards by more than twice the pretension can hold, so that the forward span goes slack and is caught again.

Absolute places and speeds of all masses, and angle and speed of the output, by scipy's solve_ivp (DOP853, error 1e-11). Refused
unless RK45 gives the same to 1e-6 of the largest value of each column.

Exit code 0 when written, 1 when the methods disagree, 2 when numpy or scipy is missing; nothing is written then.
"""

import argparse
import pathlib
import sys
import tomllib

try:
    import numpy as np
    import scipy
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq
except ModuleNotFoundError as missing:
    print(f"chain: {missing.name} is not installed; pip install numpy scipy==1.17.1", file=sys.stderr)
    sys.exit(2)

FOLDER = pathlib.Path(__file__).parent
# The run; also in desktop/src/verify/belt/oracle.rs.
NODES = 4
ANGLE, TURN = 3.0, 0.1
BACKWARDS, FORWARDS = -4.0, 45.0
RISE, FIRST, SECOND = 0.02, 0.02, 0.12
END, EVERY = 0.2, 5e-4

COLUMNS = ["theta_out_rad", "f_forward_n", "f_backward_n", "tau_motor_nm"]


class Belt:
    """Masses, springs and dampers of a belt file."""

    def __init__(self, file):
        belt, pulleys = file["belt"], [file["motor_pulley"], file["output_pulley"]]
        pitch = belt["pitch_m"]
        self.radii = [pulley["teeth"] * pitch / (2 * np.pi) for pulley in pulleys]
        step, total = self.radii[1] - self.radii[0], belt["teeth"] * pitch
        distance = brentq(lambda c: self.around(c) - total, sum(self.radii), total, xtol=1e-15)
        length = np.sqrt(distance**2 - step**2)
        wrap = np.pi + 2 * np.arcsin(step / distance)
        links = NODES + 1
        self.pretension = belt["pretension_n"]
        self.stiffness = links * belt["stiffness_n"] / length
        self.mass = belt["mass_kg_per_m"] * length / links

        def inertia(link_mass):
            on_pulley = belt["mass_kg_per_m"] * wrap * self.radii[1] + link_mass
            return pulleys[1]["inertia_kg_m2"] + on_pulley * self.radii[1] ** 2

        self.inertia = inertia(self.mass)
        # Damping of the output's mode on massless spans.
        torsional = 2 * belt["stiffness_n"] / length * self.radii[1] ** 2
        omega = np.sqrt(torsional / inertia(belt["mass_kg_per_m"] * length))
        self.damping = self.stiffness * 2 * file["damping"]["output_mode_ratio"] / omega

    def around(self, distance):
        """Length of a belt around both pulleys at a centre distance."""
        step = self.radii[1] - self.radii[0]
        lean = np.arcsin(step / distance)
        straight = 2 * np.sqrt(distance**2 - step**2)
        return straight + (np.pi - 2 * lean) * self.radii[0] + (np.pi + 2 * lean) * self.radii[1]

    def tensions(self, t, state):
        """Of all links, forward span first, each from the output's pulley to the motor's."""
        places, speeds = state.reshape(2, 2 * NODES + 1)
        motor = [self.radii[0] * value for value in turn(t)]

        def span(values, end, sign):
            ends = [[self.radii[1] * values[-1]], [end]]
            nodes = values[:NODES] if sign > 0 else values[NODES:-1]
            return sign * np.diff(np.concatenate([ends[0], nodes, ends[1]]))

        found = []
        for sign in (1, -1):
            elastic = self.pretension + self.stiffness * span(places, motor[0], sign)
            pull = np.maximum(0, elastic + self.damping * span(speeds, motor[1], sign))
            found.append(np.where(elastic > 0, pull, 0))
        return found

    def rates(self, t, state):
        """Rates of all places and speeds."""
        forward, backward = self.tensions(t, state)
        nodes = np.concatenate([np.diff(forward), -np.diff(backward)]) / self.mass
        output = (self.radii[1] * (forward[0] - backward[0]) + load(t)) / self.inertia
        return np.concatenate([state[2 * NODES + 1 :], nodes, [output]])

    def row(self, t, state):
        forward, backward = self.tensions(t, state)
        return [state[2 * NODES], forward[0], backward[0], self.radii[0] * (forward[-1] - backward[-1])]


def turn(t):
    """Angle and speed of the motor."""
    x = np.clip(t / TURN, 0, 1)
    angle = ANGLE * (x - np.sin(2 * np.pi * x) / (2 * np.pi))
    return angle, ANGLE / TURN * (1 - np.cos(2 * np.pi * x))


def load(t):
    def risen(start):
        return np.sin(0.5 * np.pi * np.clip((t - start) / RISE, 0, 1)) ** 2

    return BACKWARDS * risen(FIRST) + (FORWARDS - BACKWARDS) * risen(SECOND)


def solved(belt, method, **options):
    times = np.arange(round(END / EVERY) + 1) * EVERY
    # A step may not pass over a rise.
    run = solve_ivp(belt.rates, (0, END), np.zeros(4 * NODES + 2), method, times, max_step=EVERY, **options)
    if not run.success:
        sys.exit(f"chain: {method}: {run.message}: nothing written")
    return times, np.array([belt.row(t, state) for t, state in zip(run.t, run.y.T)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, default=FOLDER, help="default: %(default)s")
    folder = parser.parse_args().folder
    belt = Belt(tomllib.loads((FOLDER / "../../../gears/belt/at5-16.toml").read_text()))
    times, rows = solved(belt, "DOP853", rtol=1e-11, atol=1e-13)
    _, other = solved(belt, "RK45", rtol=1e-9, atol=1e-12)
    off = np.max(np.abs(rows - other) / np.max(np.abs(rows), axis=0))
    slack = np.sum(rows[:, 1] == 0)
    print(f"numpy {np.__version__}, scipy {scipy.__version__}: methods differ by {off:.1e}; slack in {slack} rows")
    if not off <= 1e-6:
        sys.exit("chain: the methods disagree: nothing written")
    lines = [",".join(["t_s", *COLUMNS])]
    lines += [f"{time:.4f}," + ",".join(f"{value:.12g}" for value in row) for time, row in zip(times, rows)]
    (folder / "chain.csv").write_text("\n".join(lines) + "\n")
    print(f"wrote chain.csv in {folder}")


if __name__ == "__main__":
    main()
