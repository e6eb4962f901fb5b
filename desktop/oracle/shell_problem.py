"""The free shell of free_shell.toml: nodes, links, initial motion, and its stepping in plain numpy (f64).

Every equation and unit stands in free_shell.toml. Node j*n + i is node i around of slice j.
"""

import pathlib
import tomllib

import numpy as np

DIRECTIONS = [(1, 0), (0, 1), (1, 1), (-1, 1), (2, 0), (0, 2), (2, 2), (-2, 2)]
PROBLEM = pathlib.Path(__file__).with_name("free_shell.toml")


class Shell:
    """Arrays of the problem: a row a node, or a row a link."""

    def __init__(self, path=PROBLEM):
        problem = tomllib.loads(path.read_text())
        shell, run = problem["shell"], problem["run"]
        self.n, self.m = shell["nodes_around"], shell["slices"]
        self.stiffness = shell["link_stiffness_n_per_m"]
        self.damping = shell["link_damping_n_s_per_m"]
        self.dt, self.steps = run["time_step_s"], run["steps"]
        self.near, self.far = self._links()
        self.angle = np.tile(2.0 * np.pi * np.arange(self.n) / self.n, self.m)
        self.height = np.repeat(np.arange(self.m) / (self.m - 1), self.n)
        self.position = self._cylinder(shell["radius_m"], shell["length_m"])
        self.rest_length = np.linalg.norm(self.position[self.far] - self.position[self.near], axis=1)
        self.mass = self._masses(shell["mass_kg"])
        self.velocity = self._velocity(problem["velocity"])

    def _links(self):
        links = [
            (j * self.n + i, (j + along) * self.n + (i + around) % self.n)
            for around, along in DIRECTIONS
            for j in range(self.m - along)
            for i in range(self.n)
        ]
        return np.array(links).T

    def _cylinder(self, radius, length):
        x, y = radius * np.cos(self.angle), radius * np.sin(self.angle)
        return np.stack([x, y, self.height * length], axis=1)

    def _masses(self, whole):
        slices = np.full(self.m, whole / (self.n * (self.m - 1)))
        slices[[0, -1]] *= 0.5
        return np.repeat(slices, self.n)

    def _velocity(self, motion):
        cosine, sine, zero = np.cos(self.angle), np.sin(self.angle), np.zeros_like(self.angle)
        radial = np.stack([cosine, sine, zero], axis=1)
        tangential = np.stack([-sine, cosine, zero], axis=1)
        axial = np.stack([zero, zero, zero + 1.0], axis=1)
        velocity = motion["translation_m_per_s"] + np.cross(motion["spin_rad_per_s"], self.position)
        for mode in motion["mode"]:
            b = mode["around"] * self.angle + mode["phase_rad"]
            along = np.cos(np.pi * mode["along"] * self.height)
            velocity += (mode["radial_m_per_s"] * along * np.cos(b))[:, None] * radial
            velocity += (mode["tangential_m_per_s"] * along * np.sin(b))[:, None] * tangential
            velocity += (mode["axial_m_per_s"] * along * np.cos(b))[:, None] * axial
        return velocity

    def step(self, position, velocity):
        """Advances both arrays in place by one time step."""
        reach = position[self.far] - position[self.near]
        length = np.sqrt(np.einsum("ij,ij->i", reach, reach))
        unit = reach / length[:, None]
        rate = np.einsum("ij,ij->i", velocity[self.far] - velocity[self.near], unit)
        pull = (self.stiffness * (length - self.rest_length) + self.damping * rate)[:, None] * unit
        for axis in range(3):
            force = np.bincount(self.near, pull[:, axis], len(position))
            force -= np.bincount(self.far, pull[:, axis], len(position))
            velocity[:, axis] += self.dt * force / self.mass
        position += self.dt * velocity

    def strain(self, position):
        """Largest strain of a link."""
        length = np.linalg.norm(position[self.far] - position[self.near], axis=1)
        return np.abs(length / self.rest_length - 1.0).max()

    def trajectory(self):
        """Positions at the stored steps, and the largest strain of a link until then."""
        position, velocity = self.position.copy(), self.velocity.copy()
        stored, strain = {}, 0.0
        for step in range(1, max(self.steps) + 1):
            self.step(position, velocity)
            strain = max(strain, self.strain(position))
            if step in self.steps:
                stored[step] = position.copy()
        return stored, strain
