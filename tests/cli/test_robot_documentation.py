"""The page about commands names every option and every JSON name of the robot's commands."""

from pathlib import Path

import pytest
import typer

from stepwell.accounts import schema_of
from stepwell.cli import app
from stepwell.cli.screen import EXIT_CODES

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "commands" / "robots.md").read_text("utf-8")
# Names that the JSON of every command has.
COMMON = (DOCS / "commands" / "common.md").read_text("utf-8")
ROBOT = typer.main.get_command(app).commands["robot"].commands  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ROBOT)
def test_every_subcommand_and_option_of_robot_is_documented(name):
    section = PAGE.split("\n## robot\n")[1].split("\n## ")[0]
    assert f"stepwell robot {name}" in section
    for parameter in ROBOT[name].params:
        for option in parameter.opts:
            if option.startswith("--") and option != "--help":
                assert f"`{option}" in section, option


@pytest.mark.parametrize("arguments", [(), ("show",), ("sweep",), ("converge",), ("ranges",)])
def test_the_help_of_robot_ends_with_the_exit_codes(stepwell, arguments):
    text = stepwell("robot", *arguments, "-h").stdout
    assert " ".join(text.split()).endswith(EXIT_CODES)


@pytest.mark.parametrize(
    "kind", ["robot", "walk", "maze", "sweep", "convergence", "ranges", "compile"]
)
def test_every_name_of_the_robots_json_is_documented(kind):
    names = names_of(schema_of(kind))
    assert {"stepwell", "files"} < names
    assert [name for name in sorted(names) if f"`{name}`" not in PAGE + COMMON] == []


def names_of(schema) -> set[str]:
    properties = schema.get("properties", {})
    inside = [*properties.values(), *([schema["items"]] if "items" in schema else [])]
    return {*properties, *(name for part in inside for name in names_of(part))}
