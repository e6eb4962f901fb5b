"""MuJoCo, the oracle itself (f64): links as spatial tendons, 100 steps a call.

Its tendons go over any number of joints, so each step it computes their Jacobians: general, hence slow here.
"""

import free_shell
import mujoco

from . import BATCH, Rival


def rivals(shell):
    model, data = free_shell.build(shell)

    def run(steps):
        for _ in range(steps // BATCH):
            mujoco.mj_step(model, data, BATCH)

    yield Rival("MuJoCo, tendons", "f64", run, lambda: shell.position + data.qpos.reshape(-1, 3))
