#!/usr/bin/env python3
"""Writes lugre_stick_slip.toml: period and peak force of LuGre's canonical stick-slip, by scipy's solve_ivp.

    M*dv/dt = k*(pull*t - x) - F         dz/dt = v - sigma0*|v|/g(v)*z         g = Fc + (Fs - Fc)*exp(-(v/vs)^2)
    F = sigma0*z + sigma1*dz/dt + sigma2*v

From rest. Period: mean time between the breaks-away (v rising through half the pull's speed) of the settled cycles.
Peak force: the largest F, and the largest pull of the spring, in these cycles. The script refuses to write unless a
tighter tolerance gives the same to 1e-6.

C. Canudas de Wit et al., IEEE Transactions on Automatic Control 40 (1995), section IV. Exit code 0 when written, 1
when the tolerances disagree, 2 when scipy is missing; nothing is written then.
"""

import argparse
import pathlib
import sys

try:
    import numpy as np
    import scipy
    from scipy.integrate import solve_ivp
except ModuleNotFoundError as missing:
    print(f"lugre_stick_slip: {missing.name} is not installed; pip install scipy==1.17.1", file=sys.stderr)
    sys.exit(2)

OUTPUT = pathlib.Path(__file__).with_suffix(".toml")
SIGMA0, SIGMA1, SIGMA2 = 1e5, 1e5**0.5, 0.4
FC, FS, VS = 1.0, 1.5, 1e-3
MASS, STIFFNESS, PULL = 1.0, 2.0, 0.1
END, SETTLED = 120.0, 40.0
AGREEMENT = 1e-6


def friction(v, z):
    g = FC + (FS - FC) * np.exp(-((v / VS) ** 2))
    rate = v - SIGMA0 * np.abs(v) / g * z
    return SIGMA0 * z + SIGMA1 * rate + SIGMA2 * v, rate


def derivative(t, state):
    x, v, z = state
    force, rate = friction(v, z)
    return [v, (STIFFNESS * (PULL * t - x) - force) / MASS, rate]


def rising(_, state):
    return state[1] - 0.5 * PULL


rising.direction = 1.0


def measure(tolerance):
    run = solve_ivp(
        derivative, (0.0, END), [0.0, 0.0, 0.0], "Radau", rtol=tolerance, atol=1e-3 * tolerance, events=rising
    )
    breaks = run.t_events[0][run.t_events[0] > SETTLED]
    cycles = (run.t >= breaks[0]) & (run.t <= breaks[-1])
    x, v, z = run.y[:, cycles]
    return {
        "period_s": (breaks[-1] - breaks[0]) / (len(breaks) - 1),
        "peak_friction_n": friction(v, z)[0].max(),
        "peak_spring_n": (STIFFNESS * (PULL * run.t[cycles] - x)).max(),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=OUTPUT, help="default: %(default)s")
    arguments = parser.parse_args()
    loose, tight = measure(1e-8), measure(1e-10)
    worst = max(abs(loose[name] / tight[name] - 1.0) for name in tight)
    print(f"scipy {scipy.__version__}: {tight}; the tolerances differ by {worst:.1e}, at most {AGREEMENT:.0e}")
    if not worst <= AGREEMENT:
        sys.exit("lugre_stick_slip: the tolerances disagree: nothing written")
    problem = {
        "sigma0_n_per_m": SIGMA0, "sigma1_n_s_per_m": SIGMA1, "sigma2_n_s_per_m": SIGMA2,
        "fc_n": FC, "fs_n": FS, "vs_m_per_s": VS,
        "mass_kg": MASS, "stiffness_n_per_m": STIFFNESS, "pull_m_per_s": PULL,
        "end_s": END, "settled_s": SETTLED,
    }
    text = f"# scipy {scipy.__version__}, desktop/oracle/friction/lugre_stick_slip.py\n"
    text += "".join(f"{name} = {value!r}\n" for name, value in problem.items())
    text += "".join(f"{name} = {value:.12f}\n" for name, value in tight.items())
    arguments.output.write_text(text)
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
