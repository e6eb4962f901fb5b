#!/usr/bin/env python3
"""Steps the free shell of free_shell.toml in MuJoCo and writes free_shell.csv.

Each node is a point mass on three slide joints, each link a spatial tendon with stiffness, damping and spring
length. Integrator Euler (semi-implicit), everything but springs and dampers disabled; the script refuses to write
unless a step is explicit in the forces, no constraint is active, and plain numpy arrives at the same positions.

Exit code 0 when written, 1 when a check fails, 2 when MuJoCo is missing; nothing is written then.
"""

import argparse
import pathlib
import sys

try:
    import mujoco
    import numpy as np

    import shell_problem
except ModuleNotFoundError as missing:
    print(f"free_shell: {missing.name} is not installed; pip install mujoco==4.0.0", file=sys.stderr)
    sys.exit(2)

OUTPUT = pathlib.Path(__file__).with_suffix(".csv")
# Largest distance from the numpy stepping (m): its rounding, at positions of 0.03 m, over 1000 steps.
AGREEMENT = 1e-15
# Largest error of one explicit velocity update (m/s): two roundings of 10 m/s.
EXPLICIT = 4e-15


def build(shell):
    """The shell as a MuJoCo model, and its data at the start."""
    spec = mujoco.MjSpec()
    spec.option.timestep = shell.dt
    spec.option.gravity = np.zeros(3)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
    everything = (1 << int(mujoco.mjtDisableBit.mjNDISABLE)) - 1
    forces = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    spec.option.disableflags = everything & ~int(forces)
    for node, (position, mass) in enumerate(zip(shell.position, shell.mass)):
        add_node(spec, node, position, mass)
    for near, far, rest_length in zip(shell.near, shell.far, shell.rest_length):
        add_link(spec, shell, near, far, rest_length)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[:] = shell.velocity.ravel()
    return model, data


def add_node(spec, node, position, mass):
    # The inertia is never turned: no joint rotates. It only has to be positive.
    body = spec.worldbody.add_body(pos=position, mass=mass, inertia=[mass * 1e-6] * 3, explicitinertial=True)
    for axis in np.eye(3):
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    body.add_site(name=f"node {node}")


def add_link(spec, shell, near, far, rest_length):
    # The later entries of stiffness and damping are those of higher powers.
    tendon = spec.add_tendon(
        stiffness=[shell.stiffness, 0.0, 0.0],
        damping=[shell.damping, 0.0, 0.0],
        springlength=[rest_length, rest_length],
    )
    tendon.wrap_site(f"node {near}")
    tendon.wrap_site(f"node {far}")


def check_explicit(shell, model):
    """One step must be v + dt*f/m and x + dt*v, with the forces of the state before it."""
    _, data = build(shell)
    mujoco.mj_forward(model, data)
    velocity = data.qvel + shell.dt * data.qfrc_passive / np.repeat(shell.mass, 3)
    mujoco.mj_step(model, data)
    implicit = np.abs(data.qvel - velocity).max()
    require(implicit <= EXPLICIT, f"the velocity is {implicit:.1e} m/s off an explicit step, at most {EXPLICIT:.1e}")
    require((data.qpos == shell.dt * data.qvel).all(), "the position does not follow the new velocity")
    require(not model.dof_damping.any() and not model.dof_armature.any(), "a joint has damping or armature")
    require(data.nefc == 0 and data.ncon == 0, f"{data.nefc} constraints and {data.ncon} contacts, 0 allowed")


def simulate(shell):
    """Positions at the stored steps, by MuJoCo."""
    model, data = build(shell)
    check_explicit(shell, model)
    stored, done = {}, 0
    for step in sorted(shell.steps):
        mujoco.mj_step(model, data, step - done)
        done = step
        stored[step] = shell.position + data.qpos.reshape(-1, 3)
    return stored


def require(holds, otherwise):
    if not holds:
        sys.exit(f"free_shell: {otherwise}")


def lines(shell, stored):
    yield f"# MuJoCo {mujoco.__version__}, desktop/oracle/free_shell.py\n"
    yield "step,i,j,x_m,y_m,z_m\n"
    for step, position in stored.items():
        for node, (x, y, z) in enumerate(position):
            yield f"{step},{node % shell.n},{node // shell.n},{x:.16e},{y:.16e},{z:.16e}\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=OUTPUT, help="default: %(default)s")
    arguments = parser.parse_args()
    shell = shell_problem.Shell()
    stored = simulate(shell)
    plain, strain = shell.trajectory()
    difference = max(np.abs(stored[step] - plain[step]).max() for step in stored)
    print(f"MuJoCo {mujoco.__version__}: {len(shell.near)} links, strained by up to {strain:.2%}")
    print(f"largest difference from numpy {difference:.1e} m, at most {AGREEMENT:.0e}")
    require(difference <= AGREEMENT, "the two disagree: nothing written")
    arguments.output.write_text("".join(lines(shell, stored)))
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
