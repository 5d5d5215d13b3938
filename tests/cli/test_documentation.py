"""The pages about design files and commands are complete, and their examples run as shown."""

import math
import re
import shlex
import sys
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
import typer

import stepwell as sw
from lab.machine import pair, recording, tension, there, unit
from sizes import SIZE
from stepwell import files, lab, studies
from stepwell.accounts import account
from stepwell.cli import app
from stepwell.design import (
    Impossible,
    MapView,
    Run,
    Tolerances,
    boundaries,
    design,
    parameter_boundaries,
    parameter_map,
    reprogram,
    survival,
    transition_map,
    yields,
)
from stepwell.files.arena import TABLES as ARENA_TABLES
from stepwell.files.schema.chain import TABLES, LeverKeys
from stepwell.files.schema.elements import ElementKeys, LibraryKeys
from stepwell.files.schema.keys import field_of, written
from stepwell.files.schema.robot import TABLES as ROBOT_TABLES
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Chain
from stepwell.paper import Verdicts
from stepwell.sequences import Unreachable

DOCS = Path(__file__).resolve().parents[2] / "docs"
FENCE = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.M | re.S)

VERDICT: Any = MagicMock(**{"claim.id": "claim"})


COMMANDS = typer.main.get_command(app)
# The groups of --help, in its order, each with its commands; the page of each has its name.
GROUPS: dict[str, list[str]] = {}
for _name in COMMANDS.list_commands(MagicMock()):  # type: ignore[attr-defined]
    GROUPS.setdefault(COMMANDS.commands[_name].rich_help_panel, []).append(_name)  # type: ignore[attr-defined]


def page_of(group: str) -> str:
    return f"commands/{group.lower().replace(' ', '-')}"


def page(name: str) -> str:
    """A page; `commands` is all pages of commands, in the order in which their examples run."""
    names = ["commands/index", *map(page_of, GROUPS), "commands/common"]
    shown = names if name == "commands" else [name]
    return "\n".join((DOCS / f"{one}.md").read_text("utf-8") for one in shown)


# What these hold goes by the names of laws, parameters, samples, sequences or files.
BY_NAME = {"values", "each", "correlations", "fractions", "data_sha256", "designs_sha256"}


def keys_of(value) -> set[str]:
    if isinstance(value, dict):
        inside = (item for key, item in value.items() if key not in BY_NAME)
        return set(value) | {key for item in inside for key in keys_of(item)}
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
            assert f"`{key}`" in text or f"[{key}]" in text, f"docs/design-files.md lacks `{key}`"


def test_the_documented_defaults_of_a_robot_are_the_ones_that_hold():
    text = page("design-files").split("\n## Robots\n")[1].split("\n## ")[0]
    robot = files.loads(preset_of_defaults()).robot
    table = ""
    rows: dict[tuple[str, str], str] = {}
    for cells in (row.split(" | ") for row in re.findall(r"^\| (.*) \|$", text, re.M)):
        if len(cells) == 4:  # the rows below it leave their table out
            table = cells[0].strip("`[]")
        for key in re.findall(r"`(\w+)`", cells[-3]) if len(cells) > 2 else ():
            rows[table, key] = cells[-1]
    for name in ("body", "foot", "blocks", "floor", "drive"):
        for key in ROBOT_TABLES[name].names():
            value = getattr(getattr(robot, name), field_of(key))
            # What is not given is another number of the table, or has no limit.
            known = {None: "`mass_g`", math.inf: "no limit"}
            default = known[value] if value in known else written(key, value)
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
        ("actuator_stiffness_N_per_m", ("1e-6", "1e12")),
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
            "stiffness_N_per_m": "[chain]\nunusual = true\nband = {{ {0} }}\n{1}",
            "friction_N": "[chain]\nunusual = true\n{1}{0}",
        }.get(key, "[chain]\nunusual = true\n{0}\n{1}")
        cell = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
        files.loads(text.format(value.format(limit), cell))
        with pytest.raises(files.DesignError):
            files.loads(text.format(value.format(repr(outside)), cell))


def test_every_command_and_option_is_documented():
    text = page("commands")
    commands = dict(COMMANDS.commands)  # type: ignore[attr-defined]
    commands |= {f"lab {name}": command for name, command in commands["lab"].commands.items()}
    for name, command in commands.items():
        mark = "\n### " if " " in name else "\n## "
        head = f"{mark}{'new, presets' if name in ('new', 'presets') else name}\n"
        assert f"stepwell {name}" in text and head in text, f"docs/commands lacks{head}"
        section = text.split(head)[1].split(mark)[0]
        for parameter in command.params:
            for option in parameter.opts:
                if option.startswith("--") and option != "--help":
                    assert f"`{option}" in section, f"docs/commands, {name}: lacks {option}"


def test_the_page_of_a_group_describes_its_commands_in_the_order_of_the_help():
    overview = page("commands/index")
    for group, names in GROUPS.items():
        file = page_of(group)
        headings = re.findall(r"^## (.*)$", page(file), re.M)
        assert [name for one in headings for name in one.split(", ")] == names, file
        linked = re.findall(rf"\[([\w-]+)\]\({file.partition('/')[2]}\.md#", overview)
        assert [name for name in linked if name in names] == names, group


def lab_records() -> list[dict[str, Any]]:
    """What every command of the lab prints, for recordings of a machine of our own."""
    cells = {"MB": (0.0, 0.0), "MM": (0.010, 0.0), "MT": (0.020, 0.0)}
    runs = [unit("friction_1.txt", None), pair("2unit_friction_1.txt", None)]
    for code, q in cells.items():
        cell = paper_cell().with_anchors(q=q)
        runs += [unit(f"1unit_{code}_{k}.txt", cell, noise=0.001, seed=k) for k in (1, 2)]
    runs.append(pair("2unit_MMT_1.txt", sw.preset("paper-forward")))
    bump = recording("1unit_MLB_1.txt", way := there(0.020), 300.0 * way)
    still = np.random.default_rng(0).normal(0.0, 0.01, 4000)
    pulls = [tension(s, 5, lambda u: 28.5 * u, noise=still) for s in (1, 2)]
    test = lab.band_test(pulls)
    fit = lab.fit_bands(test, lab.choose_law(test))
    compared = lab.compare([*runs, bump])
    assert compared.cells[-1].rises
    calibration = lab.calibrate(lab.prepare(lab.sort_series(runs).series))
    return [
        account(value).record
        for value in (lab.Batch(tuple(pulls), (lab.LabError("", ""),)), fit, compared, calibration)
    ]


def motion_records() -> list[dict[str, Any]]:
    """What the commands about programs, graphs and designs print, with every name in it."""
    forward, wave = sw.preset("paper-forward"), sw.preset("three-wave")
    axes = ("outer.q.x", [0.0, 0.01, 0.02]), ("inner.stiffness", [20.0, 30.0, 40.0])
    spread = Tolerances(anchor=0.002, stiffness=0.1)
    program = forward.program("01")
    x, y = [0.0, 0.01, 0.02], [-0.01, 0.0, 0.01]
    with pytest.raises(Unreachable) as unreachable:
        sw.preset("used-before").program("01")
    with pytest.raises(Impossible) as impossible:
        design("00>01>11>10>00", holes=0.04)
    values = (
        wave.graph(),
        wave.graph("force"),
        sw.preset("countdown").graph(),
        wave.implicit_graph("force").walked(),
        program,
        sw.preset("force-control").program("01"),
        unreachable.value,
        design("00>01>11>10>00", samples=100),
        impossible.value,
        yields(forward, spread, samples=500, sensitivity=True),
        sw.check(forward, None, spread, samples=100),
        survival(forward, program.turning_points, "01", spread, samples=3),
        reprogram(forward, None, "inner.p"),
        reprogram(sw.preset("balloon"), None, "thin.force_scale"),
        MapView(parameter_map(forward, *axes), parameter_boundaries(forward, *axes)),
        MapView(transition_map(forward, 1, x=x, y=y), boundaries(forward, 1, x=x, y=y)),
        Run.of(forward),
        Run.of(sw.preset("force-control")),
    )
    return [account(value).record for value in values]


@pytest.mark.slow
def test_every_name_of_the_json_is_documented():
    text = page("commands")
    records = [*lab_records(), *motion_records(), account(Verdicts([VERDICT])).record]
    names = {name for record in records for name in keys_of(record)} - {"unsolved"}
    for name in sorted(names):
        # Drives that are forces end in _N, as the page says once for all of them.
        forms = (name, re.sub("_N$", "_mm", name))
        assert any(f"`{one}`" in text or f'"{one}"' in text for one in forms), name


# In the quick run all commands once, on their own page, and two shorter ones.
SHOWN = ["design-files", "commands", "how-to/bring-your-own-element"]
if SIZE == "full":
    SHOWN += ["how-to/first-one", "how-to/many-designs", "atlas"]
# Pictures of a page that its own commands draw.
PICTURES = {
    "atlas": {"three/machines.svg": "atlas.svg"},
    "how-to/many-designs": {"unsure/outcomes.svg": "many-designs.svg"},
}


def _charted_once(charted):
    charts = {}

    def once(study, *, tolerances, checks, progress):
        key = study.identity, tolerances
        if key not in charts:
            charts[key] = charted(study, tolerances=tolerances, checks=checks, progress=progress)
        return charts[key]

    return once


@pytest.mark.slow
@pytest.mark.shown
@pytest.mark.parametrize("name", SHOWN)
def test_the_examples_do_what_the_page_shows(name, stepwell, tmp_path, monkeypatch):
    monkeypatch.delenv("COLUMNS")
    # In this process: starting others takes longer than the studies of the pages.
    monkeypatch.setattr(sys.modules["stepwell.studies.run"], "cores", lambda: 0)
    # One atlas asked twice for the same tolerances is charted once, with the checks of the first.
    monkeypatch.setattr(studies, "charted", _charted_once(studies.charted))
    (tmp_path / "forward.toml").unlink()  # the pages make it themselves
    blocks = FENCE.findall(page(name))
    assert "console" in {language for language, _, _ in blocks}
    names = {}
    for language, title, body in blocks:
        if title:
            (tmp_path / title).parent.mkdir(exist_ok=True)
            (tmp_path / title).write_text(body, "utf-8")
        if language == "python":
            exec(compile(body, f"{name}.md", "exec"), names)
        if language == "console":
            for step in re.split(r"^(?=\$ )", body, flags=re.M)[1:]:
                line, shown = step.split("\n", 1)
                program, *arguments = shlex.split(line.removeprefix("$ "))
                assert program == "stepwell"
                printed = stepwell(*arguments).output
                assert matches(shown, printed), f"{line}\n{printed}"
    for drawn, shown in PICTURES.get(name, {}).items():
        assert (tmp_path / drawn).read_bytes() == (DOCS / "img" / shown).read_bytes(), shown


@pytest.mark.slow
def test_every_design_on_the_page_that_is_not_called_wrong_loads(tmp_path):
    for language, title, body in FENCE.findall(page("design-files")):
        if title:
            (tmp_path / title).write_text(body, "utf-8")
        if language == "toml" and title not in ("wrong.toml", "broken.toml"):
            if title == "arena.toml":
                assert files.loads_arena(body).walls
                continue
            design = files.load(tmp_path / title).subject
            chains = [design] if isinstance(design, Chain) else [leg.chain for leg in design.legs]
            assert all(chain.cycle().sequence for chain in chains)


def test_the_everything_example_uses_every_kind_of_key():
    (body,) = (b for _, t, b in FENCE.findall(page("design-files")) if t == "everything.toml")
    left_out = {"bands", "band", "cell", "chain", "shape_mm", "turning_points_N", "table_csv"}
    left_out |= {"hopper"}  # It has an example of its own.
    for path, keys in TABLES.items():
        element = path.startswith("chain.cell.") and "band" not in path
        if element or path.startswith("hopper"):
            continue
        fields = LeverKeys.model_fields if path == "chain.cell" else keys.model_fields
        for key in set(fields) - left_out:
            if key_in_other_units(key) not in fields:
                assert key in body, f"docs/design-files.md: everything.toml has no {key}"


def test_the_examples_use_what_elements_have():
    bodies = "".join(b for lang, _, b in FENCE.findall(page("design-files")) if lang == "toml")
    left_out = {"curve", "points_csv", "curve_csv", "sheets", "error_band_N"}
    library = set(LibraryKeys.model_fields) - {"von_mises_truss", "balloon"}
    for key in set(ElementKeys.model_fields) - left_out - library:
        if key_in_other_units(key) not in ElementKeys.model_fields:
            assert f"{key} = " in bodies, f"docs/design-files.md: no example has {key}"


def key_in_other_units(key: str) -> str:
    """The same key in newtons or millimetres, where it has the units of volumes or angles."""
    for other, ours in (("kPa_per_mL", "N_per_m"), ("N_m_per_rad", "N_per_m")):
        if key.endswith(other):
            return key.replace(other, ours)
    word, _, unit = key.rpartition("_")
    others = {"kPa": "N", "mNm": "N", "mL": "mm", "deg": "mm"}
    return f"{word}_{others[unit]}" if unit in others else ""


def test_copying_a_design_through_python_keeps_it(stepwell, tmp_path):
    (tmp_path / "forward.toml").write_text(files.preset_text("paper-forward"), "utf-8")
    sw.save(sw.load("forward.toml"), "copy.toml")
    assert sw.load("copy.toml") == sw.load("forward.toml")
