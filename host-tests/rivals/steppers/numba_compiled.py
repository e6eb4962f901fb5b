"""numba, one compiled function for all steps, twice: over the list of links, and as a stencil.

The list is what a reader of eq. (6) writes; its scatter keeps LLVM from vectorising. The stencil is our own order of
work: slices as arrays, a row of parallel links at a time, two nodes of either end of a slice repeated at its other
end. It is vectorised and by far the fastest rival, at the price of being written for this mesh alone; with array
expressions in place of its last two loops it takes three times as long.
"""

import numba
import numpy as np
import shell_problem

from . import Rival


def rivals(shell):
    for precision, number in (("f64", np.float64), ("f32", np.float32)):
        yield by_list(shell, precision, number)
        yield by_stencil(shell, precision, number)


@numba.njit(fastmath=True, error_model="numpy")
def pull(dx, dy, dz, rate, stiffness, damping, rest_length, one):
    """Tension over length of a link; `one` keeps f32 what it is."""
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    inverse = one / length
    return (stiffness * (length - rest_length) + damping * rate * inverse) * inverse


@numba.njit(inline="always")
def move(x, v, f, dt_over_mass, dt):
    for axis in range(3):
        for i in range(x.shape[1]):
            v[axis, i] += dt_over_mass[i] * f[axis, i]
            x[axis, i] += dt * v[axis, i]


@numba.njit(fastmath=True, error_model="numpy")
def step_list(x, v, f, near, far, rest_length, dt_over_mass, stiffness, damping, dt, one, steps):
    for _ in range(steps):
        f[:] = 0
        for link in range(len(near)):
            a, b = near[link], far[link]
            dx, dy, dz = x[0, b] - x[0, a], x[1, b] - x[1, a], x[2, b] - x[2, a]
            rate = dx * (v[0, b] - v[0, a]) + dy * (v[1, b] - v[1, a]) + dz * (v[2, b] - v[2, a])
            p = pull(dx, dy, dz, rate, stiffness, damping, rest_length[link], one)
            f[0, a] += p * dx
            f[1, a] += p * dy
            f[2, a] += p * dz
            f[0, b] -= p * dx
            f[1, b] -= p * dy
            f[2, b] -= p * dz
        move(x, v, f, dt_over_mass, dt)


def by_list(shell, precision, number):
    x, v = shell.position.T.astype(number, order="C"), shell.velocity.T.astype(number, order="C")
    f = np.zeros_like(x)
    links = shell.near.astype(np.int32), shell.far.astype(np.int32), shell.rest_length.astype(number)
    constants = [number(value) for value in (shell.stiffness, shell.damping, shell.dt, 1.0)]
    dt_over_mass = (shell.dt / shell.mass).astype(number)

    def run(steps):
        step_list(x, v, f, *links, dt_over_mass, *constants, steps)

    run(0)  # Compiles.
    return Rival("numba, list of links", precision, run, lambda: x.T)


@numba.njit(inline="always")
def repeat_ends(x, n, width, slices):
    """Nodes that stand beyond an end of a slice's array are those at its other end."""
    for axis in range(3):
        for j in range(slices):
            for h in range(2):
                x[axis, j * width + h] = x[axis, j * width + n + h]
                x[axis, j * width + n + 2 + h] = x[axis, j * width + 2 + h]


@numba.njit(inline="always")
def collect_ends(f, n, width, slices):
    """What was given to the repeated nodes belongs to the originals."""
    for axis in range(3):
        for j in range(slices):
            for h in range(2):
                f[axis, j * width + n + h] += f[axis, j * width + h]
                f[axis, j * width + 2 + h] += f[axis, j * width + n + 2 + h]


@numba.njit(fastmath=True, error_model="numpy")
def step_stencil(x, v, f, row, directions, rest_length, dt_over_mass, stiffness, damping, dt, one, steps, n, slices):
    width = n + 4
    for _ in range(steps):
        repeat_ends(x, n, width, slices)
        repeat_ends(v, n, width, slices)
        f[:] = 0
        for direction in range(len(directions)):
            around, along = directions[direction]
            rest = rest_length[direction]
            for j in range(slices - along):
                s = j * width + 2
                t = s + along * width + around
                x0, x1, x2 = x[0, s : s + n], x[1, s : s + n], x[2, s : s + n]
                y0, y1, y2 = x[0, t : t + n], x[1, t : t + n], x[2, t : t + n]
                u0, u1, u2 = v[0, s : s + n], v[1, s : s + n], v[2, s : s + n]
                w0, w1, w2 = v[0, t : t + n], v[1, t : t + n], v[2, t : t + n]
                p0, p1, p2 = row[0], row[1], row[2]
                for i in range(n):
                    dx, dy, dz = y0[i] - x0[i], y1[i] - x1[i], y2[i] - x2[i]
                    rate = dx * (w0[i] - u0[i]) + dy * (w1[i] - u1[i]) + dz * (w2[i] - u2[i])
                    p = pull(dx, dy, dz, rate, stiffness, damping, rest, one)
                    p0[i], p1[i], p2[i] = p * dx, p * dy, p * dz
                for axis in range(3):
                    pull_row, here, there = row[axis], f[axis, s : s + n], f[axis, t : t + n]
                    for i in range(n):
                        here[i] += pull_row[i]
                    for i in range(n):
                        there[i] -= pull_row[i]
        collect_ends(f, n, width, slices)
        move(x, v, f, dt_over_mass, dt)


def by_stencil(shell, precision, number):
    width = shell.n + 4
    real = (np.arange(shell.m)[:, None] * width + 2 + np.arange(shell.n)).ravel()
    x, v, f = np.zeros((3, 3, shell.m * width), number)
    dt_over_mass = np.zeros(shell.m * width, number)
    x[:, real], v[:, real], dt_over_mass[real] = shell.position.T, shell.velocity.T, shell.dt / shell.mass
    row = np.zeros((3, shell.n), number)
    directions = np.array(shell_problem.DIRECTIONS)
    # Links are listed direction by direction.
    firsts = np.cumsum([0] + [shell.n * (shell.m - along) for _, along in shell_problem.DIRECTIONS[:-1]])
    rest_length = shell.rest_length[firsts].astype(number)
    constants = [number(value) for value in (shell.stiffness, shell.damping, shell.dt, 1.0)]

    def run(steps):
        step_stencil(x, v, f, row, directions, rest_length, dt_over_mass, *constants, steps, shell.n, shell.m)

    run(0)  # Compiles.
    return Rival("numba, stencil", precision, run, lambda: x[:, real].T)
