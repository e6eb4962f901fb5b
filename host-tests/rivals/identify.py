#!/usr/bin/env python3
"""What others identify from the same splits as `strainwave verify identify --rivals`, which starts this and judges.

FOLDER has a folder for each split, with a file for each log (columns u, y, trains; 1 in a row that trains) and the file
`weights`, `bounded` or `signed`. Answers with one JSON object on the standard output: for each split the rms error of
each model over the rows that do not train, of the span of the outputs that train.

line        a straight line, least squares
line_dahl   with Dahl's hysteresis, its length the one of 40 that fits what trains best
nnls        Preisach relays with switching points in the middle of cells and a line, scipy's non-negative least squares;
            the best, on what does NOT train, of four numbers of levels and of outputs that lag and lead: more than
            anybody can choose. Of signed weights the difference of two that are not negative.

Needs Python 3.11 or later with venv. Makes a virtual environment in target/rivals, installs numpy and scipy there from
PyPI, each pinned, and runs itself in it. Exit code 0; 3 when something is missing here, with one line that tells what.
"""

import csv
import json
import os
import pathlib
import sys

sys.dont_write_bytecode = True  # nothing beside the sources
import environment

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
ENVIRONMENT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target")).resolve() / "rivals" / "identify"
REQUIREMENTS = ["numpy==2.4.6", "scipy==1.16.3"]
SKIPPED = 3
LEVELS = [10, 20, 30, 40]
DAHL_LENGTHS = 40
ITERATIONS = 50_000


def main():
    if len(sys.argv) != 2:
        stop("one argument is needed, the folder of the splits")
    try:
        environment.require_python()
        if pathlib.Path(sys.prefix).resolve() != ENVIRONMENT:
            sys.exit(run_within())
    except environment.Missing as missing:
        stop(missing)
    splits = sorted(path for path in pathlib.Path(sys.argv[1]).iterdir() if path.is_dir())
    json.dump({path.name: errors(path) for path in splits}, sys.stdout)


def stop(message):
    print(f"rivals: {message}", file=sys.stderr)
    sys.exit(SKIPPED)


def run_within():
    python = environment.make(ENVIRONMENT)
    if reason := environment.install(python, REQUIREMENTS):
        stop(f"{', '.join(REQUIREMENTS)} cannot be installed: {reason}")
    return environment.run_again(python, {})


def errors(folder):
    """Held-out error of each model on one split."""
    import numpy as np

    logs = [read(path) for path in sorted(folder.glob("*.csv"))]
    signed = (folder / "weights").read_text().strip() == "signed"
    output = np.concatenate([log[:, 1] for log in logs])
    trains = np.concatenate([log[:, 2] for log in logs]) > 0.5
    inputs = [log[:, 0] for log in logs]
    span = np.ptp(output[trains])
    low, high = np.min(np.concatenate(inputs)), np.max(np.concatenate(inputs))
    inputs = [2 * (input - low) / (high - low) - 1 for input in inputs]
    output = (output - output[trains].mean()) / span
    held_out = lambda predicted: float(np.sqrt(np.mean((predicted - output)[~trains] ** 2)))
    line = np.stack([np.ones(len(output)), np.concatenate(inputs)], 1)
    found = {"line": held_out(least_squares(line, output, trains)[0])}
    lengths = np.geomspace(1e-3, 3.0, DAHL_LENGTHS)
    dahl = [np.column_stack([line, np.concatenate([dahl_of(u, length) for u in inputs])]) for length in lengths]
    found["line_dahl"] = held_out(min((least_squares(of, output, trains) for of in dahl), key=lambda fit: fit[1])[0])
    found["nnls"] = min(
        held_out(relays_fitted(np.concatenate([relays(u, levels) for u in inputs]), line, output, trains, signs))
        for levels in LEVELS
        for signs in ([(1, -1)] if signed else [(1,), (-1,)])
    )
    # Where the solver gives up there is no rival.
    return {name: error for name, error in found.items() if np.isfinite(error)}


def read(path):
    import numpy as np

    with path.open() as file:
        rows = list(csv.DictReader(file))
    return np.array([[float(row[name]) for name in ("u", "y", "trains")] for row in rows])


def least_squares(columns, output, trains):
    """What is predicted, and the sum of squares of what trains."""
    import numpy as np

    found = np.linalg.lstsq(columns[trains], output[trains], rcond=None)[0]
    predicted = columns @ found
    return predicted, float(np.sum((predicted - output)[trains] ** 2))


def dahl_of(input, length):
    """dz/du = (1 - z sign(du))/length, exact from sample to sample, from z = 0."""
    import numpy as np

    z, states = 0.0, [0.0]
    for step in np.diff(input):
        end = np.sign(step)
        z = end + (z - end) * np.exp(-abs(step) / length) if step else z
        states.append(z)
    return np.array(states)


def relays(input, levels):
    """State of every relay along an input of -1 to 1, from the demagnetised state."""
    import numpy as np

    middles = (np.arange(levels) + 0.5) * 2 / levels - 1
    alpha, beta = np.array([(middles[i], middles[j]) for i in range(levels) for j in range(i + 1)]).T
    state, states = np.where(alpha + beta < 0, 1.0, -1.0), []
    for place in input:
        state = np.where(place > alpha, 1.0, np.where(place < beta, -1.0, state))
        states.append(state)
    return np.array(states)


def relays_fitted(states, line, output, trains, signs):
    import numpy as np
    from scipy.optimize import nnls

    columns = np.hstack([line, -line, *[sign * states for sign in signs]])
    try:
        found = nnls(columns[trains], output[trains], maxiter=ITERATIONS)[0]
    except RuntimeError:
        return np.full(len(output), np.inf)
    return columns @ found


if __name__ == "__main__":
    main()
