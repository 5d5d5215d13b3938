"""The page about commands names every option and every JSON name of the robot's commands."""

from dataclasses import replace
from pathlib import Path

import pytest
import typer

from cli.test_documentation import keys_of
from stepwell import files, results, simulation
from stepwell.cli import app
from stepwell.cli.screen.outcomes import EXIT_CODES

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "commands.md").read_text("utf-8")
ROBOT = typer.main.get_command(app).commands["robot"].commands  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ROBOT)
def test_every_subcommand_and_option_of_robot_is_documented(name):
    section = PAGE.split("\n## robot\n")[1].split("\n## ")[0]
    assert f"stepwell robot {name}" in section
    for parameter in ROBOT[name].params:
        for option in parameter.opts:
            if option.startswith("--") and option != "--help":
                assert f"`{option}" in section, option


@pytest.mark.parametrize("arguments", [(), ("show",), ("sweep",), ("converge",)])
def test_the_help_of_robot_ends_with_the_exit_codes(stepwell, arguments):
    text = stepwell("robot", *arguments, "-h").stdout
    assert " ".join(text.split()).endswith(EXIT_CODES)


@pytest.fixture(scope="module")
def records():
    robot, cylinder = files.load("preset:robot-explorer").robot, files.load_arena("cylinder")
    # With one antenna a prediction has all the names that it has with two, in half the time.
    return [
        results.robot_record(robot, replace(robot, antennas=robot.antennas[:1]).predict()),
        results.walk_record(robot.walk(1)),
        results.maze_record(robot.maze(cylinder, limit=36.0)),
        results.convergence_record(simulation.convergence(robot, (1e-3, 5e-4))),
        results.sweep_record(simulation.sweep([robot], values={"foot.below_mm": [0.3]}, cycles=1)),
    ]


@pytest.mark.slow
def test_every_name_of_the_robots_json_is_documented(records):
    names = {name for record in records for name in keys_of(record)}
    assert {"pushes", "flips", "contacts", "changes", "trials"} <= names
    assert [name for name in sorted(names) if f"`{name}`" not in PAGE] == []
