"""The pages about design files and commands are complete, and their examples run as shown."""

import re
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest
import typer

import stepwell as sw
from stepwell import files
from stepwell.cli import app
from stepwell.design import boundaries
from stepwell.files._arena_schema import TABLES as ARENA_TABLES
from stepwell.files._keys import field_of, written
from stepwell.files._robot_schema import TABLES as ROBOT_TABLES
from stepwell.files._schema import TABLES
from stepwell.mechanism import Chain
from stepwell.paper import record as paper_record

DOCS = Path(__file__).resolve().parents[2] / "docs"
FENCE = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.M | re.S)

VERDICT: Any = MagicMock()


def page(name: str) -> str:
    return (DOCS / f"{name}.md").read_text("utf-8")


def keys_of(value) -> set[str]:
    if isinstance(value, dict):
        return set(value) | {key for item in value.values() for key in keys_of(item)}
    if isinstance(value, list):
        return {key for item in value for key in keys_of(item)}
    return set()


def matches(shown: str, printed: str) -> bool:
    """Whether the printed text is what a page shows; a line `...` stands for any lines."""
    parts = [re.escape(part) for part in re.split(r"^\.\.\.\n", shown, flags=re.M)]
    return re.fullmatch("(?:.*\n)*".join(parts), printed) is not None


def test_every_key_of_a_design_file_is_documented():
    text = page("design-files")
    for keys in (*TABLES.values(), *ROBOT_TABLES.values(), *ARENA_TABLES.values()):
        for key in keys.names():
            assert f"`{key}`" in text or f"[{key}]" in text, key


def test_the_documented_defaults_of_a_robot_are_the_ones_that_hold():
    text = page("design-files").split("\n## Robots\n")[1].split("\n## ")[0]
    robot = files.loads(preset_of_defaults())
    table = ""
    rows: dict[tuple[str, str], str] = {}
    for cells in (row.split(" | ") for row in re.findall(r"^\| (.*) \|$", text, re.M)):
        if len(cells) == 4:  # the rows below it leave their table out
            table = cells[0].strip("`[]")
        for key in re.findall(r"`(\w+)`", cells[-3]) if len(cells) > 2 else ():
            rows[table, key] = cells[-1]
    for name in ("body", "foot", "blocks", "floor", "drive"):
        for key in ROBOT_TABLES[name].names():
            default = written(key, getattr(getattr(robot, name), field_of(key)))
            assert default in rows[name, key], (name, key)
    (antenna,) = robot.antennas
    for key in ("hook_mm", "mass_g", "damping_N_m_s_per_rad", "friction", "connected"):
        assert written(key, getattr(antenna, field_of(key))) in rows["antenna", key], key
    for key in ("swing_deg", "hook_deg"):
        assert f"{getattr(antenna, field_of(key)):g} rad" in rows["antenna", key], key


def preset_of_defaults() -> str:
    """The page's own robot without what it says about the foot."""
    (body,) = (b for _, t, b in FENCE.findall(page("design-files")) if t == "robot.toml")
    return body.replace("[foot]\nbelow_mm = 0.3\n", "")


@pytest.mark.parametrize(
    ("key", "limits"),
    [
        ("lever_mm", ("0.001", "1e6")),
        ("limit_deg", ("0.01", "89.9")),
        ("stiffness_N_per_m", ("1e-6", "1e9")),
        ("actuator_stiffness_N_per_m", ("0", "1e12")),
        ("friction_N", ("0", "1e6")),
    ],
)
def test_the_documented_ranges_are_the_ones_that_hold(key, limits):
    row = next(line for line in page("design-files").splitlines() if line.startswith(f"| `{key}`"))
    for limit, beyond in zip(limits, (-1, 1), strict=True):
        assert limit in row
        outside = float(limit) + beyond * max(abs(float(limit)) * 1e-3, 1e-9)
        value = f"{key} = {{}}"
        text = {
            "stiffness_N_per_m": "[chain]\nband = {{ {0} }}\n{1}",
            "friction_N": "[chain]\n{1}{0}",
        }.get(key, "[chain]\n{0}\n{1}")
        cell = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
        files.loads(text.format(value.format(limit), cell))
        with pytest.raises(files.DesignError):
            files.loads(text.format(value.format(repr(outside)), cell))


def test_every_command_and_option_is_documented():
    text = page("commands")
    group = typer.main.get_command(app)
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        assert f"stepwell {name}" in text, name
        section = text.split(f"\n## {'new, presets' if name in ('new', 'presets') else name}\n")[1]
        section = section.split("\n## ")[0]
        for parameter in command.params:
            for option in parameter.opts:
                if option.startswith("--") and option != "--help":
                    assert f"`{option}" in section, (name, option)


def test_every_name_of_the_json_is_documented():
    text = page("commands")
    chain = sw.preset("paper-forward")
    forced = sw.preset("force-control").cycle()
    x, y = [0.0, 0.01, 0.02], [-0.01, 0.0, 0.01]
    shown, curves = sw.transition_map(chain, 1, x=x, y=y), boundaries(chain, 1, x=x, y=y)
    records = [
        files.run_record(chain.cycle(), sw.margin(chain)),
        files.run_record(forced, sw.margin(forced.chain)),
        files.map_record(shown, curves),
        paper_record([VERDICT]),
    ]
    names = {name for record in records for name in keys_of(record)} - {"unsolved"}
    for name in sorted(names):
        assert f"`{name}`" in text or f'"{name}"' in text, name


@pytest.mark.parametrize("name", ["design-files", "commands"])
def test_the_examples_do_what_the_page_shows(name, stepwell, tmp_path):
    (tmp_path / "forward.toml").unlink()  # the pages make it themselves
    blocks = FENCE.findall(page(name))
    assert "console" in {language for language, _, _ in blocks}
    for language, title, body in blocks:
        if title:
            (tmp_path / title).write_text(body, "utf-8")
        if language == "python":
            exec(compile(body, f"{name}.md", "exec"), {})
        if language == "console":
            for step in re.split(r"^(?=\$ )", body, flags=re.M)[1:]:
                line, shown = step.split("\n", 1)
                program, *arguments = line.removeprefix("$ ").split()
                assert program == "stepwell"
                printed = stepwell(*arguments).output
                assert matches(shown, printed), f"{line}\n{printed}"


def test_every_design_on_the_page_that_is_not_called_wrong_loads():
    for language, title, body in FENCE.findall(page("design-files")):
        if language == "toml" and title not in ("wrong.toml", "broken.toml"):
            if title == "arena.toml":
                assert files.loads_arena(body).walls
                continue
            design = files.loads(body)
            chains = [design] if isinstance(design, Chain) else [leg.chain for leg in design.legs]
            assert all(chain.cycle().sequence for chain in chains)


def test_the_everything_example_uses_every_kind_of_key():
    (body,) = (b for _, t, b in FENCE.findall(page("design-files")) if t == "everything.toml")
    left_out = {"bands", "band", "cell", "chain", "shape_mm"}
    for keys in TABLES.values():
        for key in set(keys.model_fields) - left_out:
            assert key in body, key


def test_copying_a_design_through_python_keeps_it(stepwell, tmp_path):
    (tmp_path / "forward.toml").write_text(files.preset_text("paper-forward"), "utf-8")
    sw.save(sw.load("forward.toml"), "copy.toml")
    assert sw.load("copy.toml") == sw.load("forward.toml")
