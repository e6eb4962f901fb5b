#!/usr/bin/env python3
"""Writes eigenvalues.csv and motion.csv: a beam of Hermite elements, clamped at the joint, with a payload at its tip.

Consistent mass and stiffness of Euler-Bernoulli elements (cubic Hermite), payload mass and inertia at the last node. No mode of a
continuous beam and no code of the library is used.

eigenvalues.csv: lambda_1 to lambda_4 of omega = lambda^2*sqrt(EI/(mu*L^4)) for payloads m = M/(mu*L), j = J/(mu*L^3). The generalised
eigenproblem is solved for the largest eigenvalues of the flexibility, which have full relative accuracy. Two meshes, extrapolated; refused
unless the finer one agrees with that to 1e-7.

motion.csv: torque that the joint must supply, and deflection of the tip, while the joint turns about a horizontal axis by
theta = a*(x - sin(2*pi*x)/(2*pi)), x = t/T, from rest, holds, and a force pulls at the tip; the payload's weight and the beam's
own bend it. All modes of the mesh have one damping ratio. The mesh starts in its static equilibrium and is stepped by the matrix
exponential, loads linear between samples. The torque is the reaction at the clamp, not a balance of momentum. Refused unless half
the elements give the same to 1e-5 of the largest torque.

Exit code 0 when written, 1 when the meshes disagree, 2 when numpy or scipy is missing; nothing is written then.
"""

import argparse
import pathlib
import sys

try:
    import numpy as np
    import scipy
    from scipy.linalg import cho_factor, cho_solve, eigh, expm
except ModuleNotFoundError as missing:
    print(f"beam: {missing.name} is not installed; pip install numpy scipy==1.17.1", file=sys.stderr)
    sys.exit(2)

FOLDER = pathlib.Path(__file__).parent
PAYLOADS = [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (10.0, 0.0), (0.0, 0.1), (1.0, 0.1), (0.5, 0.01), (5.0, 2.0), (100.0, 1.0)]
# The link of the motion; also in desktop/src/verify/link/motion.rs.
LENGTH, STIFFNESS, DENSITY, MASS, INERTIA = 0.6, 90.0, 0.5, 0.4, 4e-4
DAMPING, GRAVITY = 0.01, 9.81
ANGLE, DURATION, END, STEP, EVERY = 1.2, 0.4, 0.8, 1e-4, 20
FORCE, PULL = 2.0, 0.5


def matrices(elements, length=1.0, stiffness=1.0, density=1.0, mass=0.0, inertia=0.0):
    """Mass and stiffness of all nodes (w, w' each), the clamped one first."""
    h = length / elements
    k = stiffness / h**3 * np.array(
        [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
         [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]])
    m = density * h / 420 * np.array(
        [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
         [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]])
    size = 2 * (elements + 1)
    stiff, heavy = np.zeros((size, size)), np.zeros((size, size))
    for element in range(elements):
        at = slice(2 * element, 2 * element + 4)
        stiff[at, at] += k
        heavy[at, at] += m
    heavy[-2, -2] += mass
    heavy[-1, -1] += inertia
    return heavy, stiff


def eigenvalues(elements, mass, inertia):
    heavy, stiff = (matrix[2:, 2:] for matrix in matrices(elements, mass=mass, inertia=inertia))
    factor = cho_factor(stiff)
    root = np.linalg.cholesky(heavy)
    flexibility = root.T @ cho_solve(factor, root)
    largest = np.sort(eigh(0.5 * (flexibility + flexibility.T), eigvals_only=True))[::-1][:4]
    return largest**-0.25


def extrapolated(mass, inertia):
    coarse, fine = (eigenvalues(elements, mass, inertia) for elements in (60, 120))
    # The error falls with the fourth power of the element.
    best = fine + (fine - coarse) / 15
    return best, np.max(np.abs(fine / best - 1))


def joint(t):
    x = np.clip(t / DURATION, 0, 1)
    turn = 2 * np.pi * x
    angle = ANGLE * (x - np.sin(turn) / (2 * np.pi))
    return angle, ANGLE * 2 * np.pi / DURATION**2 * np.sin(turn)


def force(t):
    return FORCE * np.sin(np.pi * np.clip((t - PULL) / 0.1, 0, 1)) ** 2


def motion(elements):
    heavy, stiff = matrices(elements, LENGTH, STIFFNESS, DENSITY, MASS, INERTIA)
    size = heavy.shape[0]
    places = np.linspace(0, LENGTH, elements + 1)
    rigid = np.ravel(np.column_stack([places, np.ones_like(places)]))
    across = np.ravel(np.column_stack([np.ones_like(places), np.zeros_like(places)]))
    tip = np.zeros(size)
    tip[-2] = 1.0
    inner_mass, inner_stiffness = heavy[2:, 2:], stiff[2:, 2:]
    squares, shapes = eigh(inner_stiffness, inner_mass)
    omegas = np.sqrt(squares)
    damping = inner_mass @ shapes @ np.diag(2 * DAMPING * omegas) @ shapes.T @ inner_mass
    inverse = np.linalg.inv(inner_mass)
    inner = size - 2
    free = np.block([[np.zeros((inner, inner)), np.eye(inner)], [-inverse @ inner_stiffness, -inverse @ damping]])
    # Loads: acceleration, weight across, force; their rates are states that stand still within a step.
    per_load = np.column_stack([-heavy @ rigid, -GRAVITY * heavy @ across, tip])
    drive = np.vstack([np.zeros((inner, 3)), inverse @ per_load[2:]])
    whole = np.zeros((2 * inner + 6, 2 * inner + 6))
    whole[: 2 * inner, : 2 * inner] = free
    whole[: 2 * inner, 2 * inner : 2 * inner + 3] = drive
    whole[2 * inner : 2 * inner + 3, 2 * inner + 3 :] = np.eye(3) / STEP
    step = expm(whole * STEP)
    transition, of_load, of_change = step[: 2 * inner, : 2 * inner], step[: 2 * inner, 2 * inner : -3], step[: 2 * inner, -3:]
    times = np.arange(round(END / STEP) + 1) * STEP
    angle, acceleration = joint(times)
    loads = np.column_stack([acceleration, np.cos(angle), force(times)])
    state = np.concatenate([np.linalg.solve(inner_stiffness, per_load[2:] @ loads[0]), np.zeros(inner)])
    # Weight of the bending about the joint, which a straight link has not.
    along = heavy[:, 2:].T @ across
    rows = []
    for index, time in enumerate(times):
        load = loads[index]
        at, rate = state[:inner], state[inner:]
        if index % EVERY == 0:
            change = inverse @ (per_load[2:] @ load - damping @ rate - inner_stiffness @ at)
            # The clamp's rotation, row 1. Damping is internal and turns nothing as a whole: the clamp takes what the rest lacks.
            damped = rigid[2:] @ damping @ rate
            reaction = stiff[1, 2:] @ at + heavy[1, 2:] @ change - per_load[1] @ load - damped
            leaned = GRAVITY * np.sin(angle[index]) * (along @ at)
            rows.append((time, reaction - leaned, at[-2]))
        if index + 1 < len(times):
            state = transition @ state + of_load @ load + of_change @ (loads[index + 1] - load)
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, default=FOLDER, help="default: %(default)s")
    folder = parser.parse_args().folder
    found = [(mass, inertia, *extrapolated(mass, inertia)) for mass, inertia in PAYLOADS]
    worst = max(error for *_, error in found)
    fine, coarse = motion(40), motion(20)
    off = np.max(np.abs(fine[:, 1] - coarse[:, 1])) / np.max(np.abs(fine[:, 1]))
    print(f"numpy {np.__version__}, scipy {scipy.__version__}: eigenvalues differ by {worst:.1e}, torques by {off:.1e}")
    if not (worst <= 1e-7 and off <= 1e-5):
        sys.exit("beam: the meshes disagree: nothing written")
    lines = ["mass,inertia,lambda_1,lambda_2,lambda_3,lambda_4"]
    lines += [",".join([repr(mass), repr(inertia), *(f"{number:.12f}" for number in best)]) for mass, inertia, best, _ in found]
    (folder / "eigenvalues.csv").write_text("\n".join(lines) + "\n")
    lines = ["t_s,tau_joint_nm,tip_deflection_m"]
    lines += [f"{time:.4f},{torque:.9f},{tip:.12f}" for time, torque, tip in fine]
    (folder / "motion.csv").write_text("\n".join(lines) + "\n")
    print(f"wrote eigenvalues.csv and motion.csv in {folder}")


if __name__ == "__main__":
    main()
