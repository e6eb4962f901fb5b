#!/usr/bin/env python3
"""How fast others step the flexspline's mesh, beside ours, in one run on one thread.

The problem is desktop/oracle/free_shell.toml: 36 x 4 nodes, 828 damped links, explicit steps of 1 us. Every rival's
nodes must stand, after 1000 steps, where MuJoCo's stand in free_shell.csv, to its precision; then its best of 100
batches counts. Ours is the best of criterion's 100 (`cargo bench -p strainwave-host-tests --bench flexspline`), of the
same links with driven rim, rigid flange and tooth contact.

Needs Python 3.11 or later with venv, and cargo. Makes a virtual environment in target/rivals, installs the rivals
there from PyPI, each pinned (about 1 GB), and runs itself in it. A rival that cannot be installed is named and left
out.

What was found about each stands in steppers/. Ways that were tried and are slower are named there too.

Exit code 0; 1 when ours is not at least 4 times faster than Newton's SemiImplicit solver in either precision, or
takes more than 1.6 ns (f64) or 1.2 ns (f32) per link and step, when Newton is missing, or when a rival does not solve
the same problem; 2 when something is missing here.
"""

import argparse
import importlib
import importlib.metadata
import json
import os
import pathlib
import subprocess
import sys
import time

sys.dont_write_bytecode = True  # nothing beside the sources
import environment
from environment import last_line

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
ORACLE = REPOSITORY / "desktop" / "oracle"
# What stands in steppers/, and what it needs.
RIVALS = {
    "newton_semi_implicit": ["newton==1.8.0", "warp-lang==1.19.0"],
    "warp_graph": ["warp-lang==1.19.0"],
    "numba_compiled": ["numba==0.68.1"],
    "taichi_compiled": ["taichi==1.7.4"],
    "numpy_arrays": [],
    "mujoco_tendons": ["mujoco==4.0.0"],
}
REQUIRED = "newton_semi_implicit"
COMMON = ["numpy==2.4.6"]
# Times that ours must be faster than the required rival; and ours at most, per link and step (ns).
FASTER = 4.0
BOUNDS = {"f64": 1.6, "f32": 1.2}
# Largest distance from the oracle (m): rounding over 1000 steps at 0.03 m, where f32 resolves 2e-9.
AGREEMENT = {"f64": 1e-12, "f32": 5e-7}
COMPARED_STEPS = 1000
THREADS = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"]
BENCH = ["cargo", "bench", "--quiet", "--package", "strainwave-host-tests", "--bench", "flexspline"]


def main():
    arguments = parse()
    target = target_directory()
    folder = target / "rivals" / "venv"
    try:
        environment.require_python()
        if pathlib.Path(sys.prefix) != folder:
            sys.exit(run_within(folder))
    except environment.Missing as missing:
        stop(missing)
    call(BENCH + ["--no-run"])
    use_one_processor()
    rows, problems = measure_rivals(arguments.batches)
    ours = measure_ours(target)
    print_table(ours, rows)
    problems += misses(ours, rows)
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    meaning = "batches of 1000 steps of which the best counts, 1..1000; default: %(default)s"
    parser.add_argument("--batches", type=batches, default=100, help=meaning)
    return parser.parse_args()


def batches(text):
    if not text.isdecimal() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"{text} is not within 1..1000")
    return int(text)


def stop(message):
    print(f"rivals: {message}", file=sys.stderr)
    sys.exit(2)


def call(command):
    """The command's output; stops with its last line when it fails."""
    try:
        done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True)
    except FileNotFoundError:
        stop(f"{command[0]} is not installed")
    if done.returncode:
        stop(f"`{' '.join(command)}` failed: {last_line(done.stderr)}")
    return done.stdout


def target_directory():
    metadata = call(["cargo", "metadata", "--no-deps", "--format-version", "1"])
    return pathlib.Path(json.loads(metadata)["target_directory"])


def run_within(folder):
    """Installs what can be installed and runs this script again there, with one thread a library."""
    python = environment.make(folder)
    if reason := install(python, COMMON):
        stop(f"{COMMON[0]} cannot be installed: {reason}")
    for module, requirements in RIVALS.items():
        if reason := install(python, COMMON + requirements):
            print(f"{module}: {', '.join(requirements)} cannot be installed: {reason}", flush=True)
    settings = dict.fromkeys(THREADS, "1")
    settings["ENABLE_TAICHI_HEADER_PRINT"] = "0"
    settings["WARP_CACHE_PATH"] = str(folder.parent / "warp")
    return environment.run_again(python, settings)


def install(python, requirements):
    """As in any environment, telling what."""
    print("installing", *requirements, flush=True)
    return environment.install(python, requirements)


def use_one_processor():
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def measure_rivals(count):
    """Rows (module, name, precision, ns per link and step), and what went wrong."""
    sys.path += [str(ORACLE), str(pathlib.Path(__file__).parent)]
    shell = importlib.import_module("shell_problem").Shell()
    oracle = read_oracle(len(shell.mass))
    rows, problems = [], []
    for module in filter(is_installed, RIVALS):
        for rival in importlib.import_module(f"steppers.{module}").rivals(shell):
            print(f"measuring {rival.name}, {rival.precision}", flush=True)
            rival.run(COMPARED_STEPS)
            distance = abs(rival.positions() - oracle).max()
            bound = AGREEMENT[rival.precision]
            if not distance <= bound:
                problems.append(f"{rival.name}, {rival.precision}: {distance:.1e} m off the oracle, at most {bound}")
            rows.append((module, rival.name, rival.precision, best(rival, count) / len(shell.near)))
    return rows, problems


def is_installed(module):
    for requirement in RIVALS[module]:
        name, version = requirement.split("==")
        try:
            found = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found = "nothing"
        if found != version:
            print(f"{module} is left out: it needs {requirement}, {found} is installed")
            return False
    return True


def read_oracle(nodes):
    """Positions of all nodes after the compared steps."""
    import numpy as np

    table = np.loadtxt(ORACLE / "free_shell.csv", delimiter=",", skiprows=2)
    positions = table[table[:, 0] == COMPARED_STEPS, 3:]
    if positions.shape != (nodes, 3):
        stop(f"free_shell.csv has {len(positions)} nodes at step {COMPARED_STEPS}, {nodes} are needed")
    return positions


def best(rival, count):
    """Nanoseconds a step, in the best batch."""
    times = []
    for _ in range(count):
        started = time.perf_counter()
        rival.run(COMPARED_STEPS)
        times.append(time.perf_counter() - started)
    return min(times) / COMPARED_STEPS * 1e9


def measure_ours(target):
    """Nanoseconds per link and step by precision, by criterion in this run."""
    print("measuring strainwave", flush=True)
    call(BENCH + ["--", "36x4"])
    group = target / "criterion" / "flexspline"
    return {precision: best_sample(group / precision / "36x4" / "new") for precision in BOUNDS}


def best_sample(folder):
    """The best batch, as of the rivals: criterion's own estimates also hold what else ran on the machine."""
    sample = json.loads((folder / "sample.json").read_text())
    links = json.loads((folder / "benchmark.json").read_text())["throughput"]["Elements"]
    return min(time / steps for time, steps in zip(sample["times"], sample["iters"])) / links


def print_table(ours, rows):
    print(f"\n{'':34}{'precision':>10}{'ns per link':>13}{'times ours':>12}")
    own = [(None, "strainwave", precision, time) for precision, time in ours.items()]
    for _, name, precision, nanoseconds in own + sorted(rows, key=lambda row: row[3]):
        print(f"{name:34}{precision:>10}{nanoseconds:13.2f}{nanoseconds / ours[precision]:12.1f}")


def misses(ours, rows):
    """Every bound that is missed, a line each."""
    for precision, bound in BOUNDS.items():
        if not ours[precision] <= bound:
            yield f"strainwave, {precision}: {ours[precision]:.2f} ns per link and step, at most {bound}"
    required = [nanoseconds for module, _, _, nanoseconds in rows if module == REQUIRED]
    if not required:
        yield f"{REQUIRED} is missing, with which ours is compared"
    for nanoseconds in required:
        times = nanoseconds / max(ours.values())
        if not times >= FASTER:
            yield f"strainwave is {times:.1f} times faster than Newton, at least {FASTER} are asked"


if __name__ == "__main__":
    main()
