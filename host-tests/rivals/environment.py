"""Virtual environments that the programs here run themselves in."""

import os
import subprocess
import sys
import venv


class Missing(Exception):
    """What is missing here, for people."""


def last_line(text):
    return (text.strip().splitlines() or ["no reason given"])[-1]


def require_python():
    """Refuses what is older than the pinned packages need."""
    if sys.version_info < (3, 11):
        raise Missing(f"Python is {sys.version.split()[0]}, 3.11 or later is needed")


def make(folder):
    """The interpreter of the virtual environment in this folder, which is made where it is missing."""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        try:
            venv.create(folder, with_pip=True)
        except (OSError, subprocess.CalledProcessError):
            raise Missing(f"no virtual environment can be made in {folder}; Debian has it in python3-venv") from None
    return python


def install(python, requirements):
    """Why the requirements cannot be installed; None when they are."""
    command = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *requirements]
    done = subprocess.run(command, capture_output=True, text=True)
    return last_line(done.stderr) if done.returncode else None


def run_again(python, settings):
    """Exit code of this program in the environment of the interpreter, with further variables."""
    return subprocess.run([python, "-B", *sys.argv], env=os.environ | settings).returncode
