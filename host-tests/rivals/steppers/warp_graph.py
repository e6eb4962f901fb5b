"""NVIDIA warp, kernels of our own: links add to their nodes atomically, nodes move; 100 steps in one CPU graph.

All steps in one kernel of one thread, without atomics, take as long (6.3 ns f64, 5.8 ns f32), `fast_math` or not: the
CPU back end does not vectorise a scatter.
"""

import numpy as np
import warp as wp

from . import BATCH, Rival


def rivals(shell):
    wp.config.log_level = wp.LOG_ERROR
    yield rival(shell, "f64", wp.float64, wp.vec3d, np.float64)
    yield rival(shell, "f32", wp.float32, wp.vec3f, np.float32)


def kernels(scalar, vector):
    scalars, vectors, indices = wp.array(dtype=scalar), wp.array(dtype=vector), wp.array(dtype=int)

    @wp.kernel(module="unique", enable_backward=False)
    def pull(
        position: vectors,
        velocity: vectors,
        force: vectors,
        near: indices,
        far: indices,
        rest_length: scalars,
        stiffness: scalar,
        damping: scalar,
    ):
        link = wp.tid()
        a, b = near[link], far[link]
        reach = position[b] - position[a]
        length = wp.length(reach)
        unit = reach / length
        rate = wp.dot(velocity[b] - velocity[a], unit)
        tension = unit * (stiffness * (length - rest_length[link]) + damping * rate)
        wp.atomic_add(force, a, tension)
        wp.atomic_sub(force, b, tension)

    @wp.kernel(module="unique", enable_backward=False)
    def move(position: vectors, velocity: vectors, force: vectors, dt_over_mass: scalars, dt: scalar):
        node = wp.tid()
        faster = velocity[node] + force[node] * dt_over_mass[node]
        velocity[node] = faster
        position[node] = position[node] + faster * dt
        force[node] = vector()

    return pull, move


def rival(shell, precision, scalar, vector, number):
    def array(values, kind=scalar):
        return wp.array(values.astype(number if kind is not int else np.int32), dtype=kind, device="cpu")

    pull, move = kernels(scalar, vector)
    position, velocity = array(shell.position, vector), array(shell.velocity, vector)
    force = array(0.0 * shell.position, vector)
    near, far = array(shell.near, int), array(shell.far, int)
    rest_length, dt_over_mass = array(shell.rest_length), array(shell.dt / shell.mass)
    links = [position, velocity, force, near, far, rest_length, scalar(shell.stiffness), scalar(shell.damping)]
    nodes = [position, velocity, force, dt_over_mass, scalar(shell.dt)]

    def step():
        wp.launch(pull, len(shell.near), inputs=links, device="cpu")
        wp.launch(move, len(shell.mass), inputs=nodes, device="cpu")

    step()  # Compiles.
    with wp.ScopedCapture(device="cpu") as recorded:
        for _ in range(BATCH):
            step()
    position.assign(shell.position.astype(number))
    velocity.assign(shell.velocity.astype(number))

    def run(steps):
        for _ in range(steps // BATCH):
            wp.capture_launch(recorded.graph)

    return Rival("warp, CPU graph", precision, run, position.numpy)
