"""Without MuJoCo a user is told in one line how to get it, and all else works."""

import subprocess
import sys

import pytest

from facts import says
from stepwell.base import install

# Each asks a process of its own.
pytestmark = pytest.mark.slow
WITHOUT = "import sys; sys.modules['mujoco'] = None\n"


def run(code: str) -> subprocess.CompletedProcess[str]:
    """Run code in an interpreter that finds no MuJoCo."""
    return subprocess.run([sys.executable, "-c", WITHOUT + code], capture_output=True, text=True)


def test_the_simulation_says_in_one_line_how_to_install_it():
    result = run("from stepwell.simulation import walk, maze, mjcf")
    assert result.returncode != 0
    line = result.stderr.splitlines()[-1]
    says(line, "stepwell.base.errors.ExtraError: ", "MuJoCo", install("robot"))
    # One error, not a chain of them.
    assert result.stderr.count("Traceback") == 1


def test_chains_and_robots_as_values_need_no_simulator():
    result = run(
        "import stepwell as sw, stepwell.robot\n"
        "robot = sw.preset('robot-forward')\n"
        "print(robot.legs[0].chain.cycle().sequence)"
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == "00>10>11>01>00"


def test_what_robots_are_can_be_shown_without_a_simulator():
    result = run(
        "import stepwell as sw\nfrom stepwell.accounts import schema_kinds, schema_of\n"
        "assert 'actuator' in sw.preset('robot-forward')._repr_html_()\n"
        "assert all(map(schema_of, schema_kinds()))"
    )
    assert result.returncode == 0, result.stderr
