"""Newton (Linux Foundation; PyPI `newton`, once `newton-physics`), its solver for explicit steps: SolverSemiImplicit.

f32 only. Called from Python it spends 64 ns per link on launching kernels; recorded once as a graph, which the CPU
supports too, 7.4. Its kernel goes by links and adds to both nodes atomically. The particle grid and contacts are off.
"""

import newton
import numpy as np
import warp as wp

from . import BATCH, Rival


def rivals(shell):
    wp.config.log_level = wp.LOG_ERROR
    model = build(shell)
    solver = newton.solvers.SolverSemiImplicit(model, enable_tri_contact=False)
    control = model.control()
    here, there = model.state(), model.state()

    def two_steps():
        for before, after in ((here, there), (there, here)):
            before.clear_forces()
            solver.step(before, after, control, None, shell.dt)

    two_steps()  # Compiles.
    with wp.ScopedCapture(device="cpu") as recorded:
        for _ in range(BATCH // 2):
            two_steps()
    here.particle_q.assign(shell.position.astype(np.float32))
    here.particle_qd.assign(shell.velocity.astype(np.float32))

    def run(steps):
        for _ in range(steps // BATCH):
            wp.capture_launch(recorded.graph)

    yield Rival("Newton SemiImplicit, CPU graph", "f32", run, here.particle_q.numpy)


def build(shell):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    for position, velocity, mass in zip(shell.position, shell.velocity, shell.mass):
        builder.add_particle(wp.vec3(*position), wp.vec3(*velocity), float(mass))
    for near, far in zip(shell.near, shell.far):
        builder.add_spring(int(near), int(far), shell.stiffness, shell.damping, control=0.0)
    builder.spring_rest_length = shell.rest_length.tolist()
    model = builder.finalize(device="cpu")
    model.particle_grid = None
    model.particle_max_velocity = 1e9
    return model
