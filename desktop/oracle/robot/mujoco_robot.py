"""Rigid arms by MuJoCo, which shares no code with ours: writes swing.csv and chain.csv beside itself.

swing.csv: the arm of examples/arm/arm.toml without motors, gears or friction falls from its start, RK4 of 0.1 ms.
chain.csv: torques that given angles, speeds and accelerations of chain.toml need, by inverse dynamics.
"""

import csv
import math
import tomllib
from pathlib import Path

import mujoco
import numpy

HERE = Path(__file__).parent
STEP = 1e-4
ROWS = 20


def body(joints):
    """A link and what it carries, as MJCF; the pose in the parent is that of the link before."""
    if not joints:
        return ""
    (before, link), *rest = joints
    twist = 0.5 * before.get("twist_rad", 0.0)
    pose = f'{before.get("length_m", 0.0)} 0 {before.get("offset_m", 0.0)}'
    centre = " ".join(str(link.get(key, 0.0)) for key in ("centre_m", "centre_y_m", "centre_z_m"))
    inertia = " ".join(str(link[key]) for key in ("inertia_x_kg_m2", "inertia_y_kg_m2", "inertia_kg_m2"))
    return (
        f'<body pos="{pose}" quat="{math.cos(twist)!r} {math.sin(twist)!r} 0 0"><joint type="hinge" axis="0 0 1"/>'
        f'<inertial pos="{centre}" mass="{link["mass_kg"]}" diaginertia="{inertia}"/>{body(rest)}</body>'
    )


def build(path):
    file = tomllib.loads(path.read_text())
    links = file["joint"]
    gravity = " ".join(str(file["robot"].get(f"gravity_{axis}_m_per_s2", 0.0)) for axis in "xyz")
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="{gravity}" timestep="{STEP}" integrator="RK4"/>'
        f"<worldbody>{body(list(zip([{}] + links, links)))}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model), links


def write(name, header, rows):
    with (HERE / name).open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([repr(float(value)) for value in row] for row in rows)


def swing():
    model, data, links = build(HERE / "../../../examples/arm/arm.toml")
    data.qpos[:] = [link.get("start_rad", 0.0) for link in links]
    for tenth in range(ROWS + 1):
        yield [tenth / 10, *data.qpos, *data.qvel]
        mujoco.mj_step(model, data, round(0.1 / STEP))


def chain():
    model, data, links = build(HERE / "chain.toml")
    random = numpy.random.default_rng(1)
    for _ in range(ROWS):
        data.qpos[:], data.qvel[:], data.qacc[:] = random.uniform(-2, 2, (3, len(links)))
        mujoco.mj_inverse(model, data)
        yield [*data.qpos, *data.qvel, *data.qacc, *data.qfrc_inverse]


write("swing.csv", ["t_s", "q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s"], swing())
names = [f"{what}{joint}_{unit}" for what, unit in (("q", "rad"), ("dq", "rad_s"), ("ddq", "rad_s2"), ("tau", "nm")) for joint in (1, 2, 3)]
write("chain.csv", names, chain())
