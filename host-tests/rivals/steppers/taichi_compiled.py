"""Taichi, one kernel for all steps, serial, over the list of links. Its last release is from 2025."""

import numpy as np
import taichi as ti

from . import Rival


def rivals(shell):
    yield rival(shell, "f64", ti.f64, np.float64)
    yield rival(shell, "f32", ti.f32, np.float32)


def rival(shell, precision, scalar, number):
    ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=scalar, fast_math=True, offline_cache=False)
    nodes, links = len(shell.mass), len(shell.near)
    position, velocity, force = (ti.Vector.field(3, scalar, nodes) for _ in range(3))
    near, far = ti.field(ti.i32, links), ti.field(ti.i32, links)
    rest_length, dt_over_mass = ti.field(scalar, links), ti.field(scalar, nodes)
    position.from_numpy(shell.position.astype(number))
    velocity.from_numpy(shell.velocity.astype(number))
    near.from_numpy(shell.near.astype(np.int32))
    far.from_numpy(shell.far.astype(np.int32))
    rest_length.from_numpy(shell.rest_length.astype(number))
    dt_over_mass.from_numpy((shell.dt / shell.mass).astype(number))
    stiffness, damping, dt = shell.stiffness, shell.damping, shell.dt

    @ti.kernel
    def run(steps: ti.i32):
        ti.loop_config(serialize=True)
        for _ in range(steps):
            for link in range(links):
                a, b = near[link], far[link]
                reach = position[b] - position[a]
                length = reach.norm()
                inverse = 1 / length
                rate = (velocity[b] - velocity[a]).dot(reach) * inverse
                tension = (stiffness * (length - rest_length[link]) + damping * rate) * inverse
                force[a] += tension * reach
                force[b] -= tension * reach
            for node in range(nodes):
                velocity[node] += force[node] * dt_over_mass[node]
                position[node] += velocity[node] * dt
                force[node] = ti.Vector([0.0, 0.0, 0.0])

    run(0)  # Compiles.
    return Rival("Taichi", precision, run, position.to_numpy)
