"""What is too big is refused with its number and the way to allow it, before it costs anything."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stepwell as sw
from facts import says
from stepwell import figures, files, lab, simulation
from stepwell.base import limits as _limits
from stepwell.base.limits import LIMITS, VARIABLE
from stepwell.design import (
    Tolerances,
    boundaries,
    parameter_boundaries,
    parameter_map,
    transition_map,
    yields,
)
from stepwell.figures.graphs import MOST_STATES
from stepwell.files import DesignError, preset_text
from stepwell.files.schema import wording
from stepwell.robot import Arena, Body, Cylinder, Patch, Plate, Wall
from stepwell.sequences.planning import _MOST_BRANCHES
from stepwell.simulation.drawing import VideoError

CHAIN = preset_text("paper-forward")
ROBOT = preset_text("robot-forward")
ARENA = "[[wall]]\nfrom_mm = [900, 0]\nto_mm = [900, 100]\n" * 2
CELL = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"
ANTENNA = (
    '[[antenna]]\nname = "{}"\npivot_mm = [110, -25]\nlength_mm = 130\nangle_deg = 63\n'
    'leg = "{}"\nmoves_mm = [-1, 0]\n'
)
BAND = "{p_mm = [-10, 0], q_mm = [10, 0]}"
BANDS = f"[[chain.cell]]\nbands = [{BAND}, {BAND}]\n"


def leg() -> sw.Chain:
    return files.loads(CHAIN).chain


def robot() -> sw.Robot:
    return files.loads(ROBOT).robot


def simulated(**changes) -> simulation.Settings:
    return simulation.Settings(settle=0.0, **changes)


# Of each limit: its name, work that comes to this number, and the number.
CASES = {
    "a file's chain": ("cells", lambda: files.loads(CHAIN).chain, 2),
    "the chain of a leg": ("cells", lambda: files.loads(ROBOT).robot, 2),
    "a chain": ("cells", lambda: sw.Chain([*leg().cells, *leg().cells]), 4),
    "a file's bands": ("bands", lambda: files.loads(BANDS).chain, 2),
    "a cell's bands": ("bands", lambda: sw.Cell(2 * leg().levers[0].bands), 2),
    "a load": (
        "rows",
        lambda: files.loads(f"[chain]\n{CELL}load_mm_N = [[0, 1], [5, 1], [9, 1]]").chain,
        3,
    ),
    "a law": (
        "rows",
        lambda: files.loads(f"[chain]\nband = {{ shape_mm = [[0, 0], [9, 9]] }}\n{CELL}").chain,
        2,
    ),
    "a program": (
        "turns",
        lambda: files.loads(f"{CHAIN}[program]\nturning_points_mm = [0, 40, 0]").program,
        3,
    ),
    "a file's legs": ("legs", lambda: files.loads(ROBOT).robot, 2),
    "legs": ("legs", lambda: robot(), 2),
    "antennas": (
        "antennas",
        lambda: (
            files.loads(ROBOT + ANTENNA.format("a", "left") + ANTENNA.format("b", "right")).robot
        ),
        2,
    ),
    "a file's supports": (
        "supports",
        lambda: files.loads(f"{ROBOT}[body]\nsupports_mm = [[-55, 0], [38, 45], [38, -45]]").robot,
        3,
    ),
    "supports": ("supports", Body, 3),
    "a file's walls": ("obstacles", lambda: files.loads_arena(ARENA), 2),
    "a drawn arena": ("obstacles", lambda: files.loads_arena("cell 100 mm\nS..#.#..o"), 3),
    "obstacles": (
        "obstacles",
        lambda: Arena([Wall((1.0, 0.0), (1.0, 1.0))], [Cylinder((2.0, 0.0))]),
        2,
    ),
    "patches": (
        "patches",
        lambda: Arena(
            patches=[Patch((1.0, 0.0), (2.0, 1.0))],
            plates=[Plate((3.0, 0.0), (0.1, 0.1), 1e-3, 0.01)],
        ),
        2,
    ),
    "sources": (
        "sources",
        lambda: (
            files.loads(
                preset_text("robot-forward").split("[source]")[0]
                + '[source]\npaper = ["foot.link_mm", "foot.span_mm", "foot.mass_g"]'
            ).robot
        ),
        3,
    ),
    "a map": ("letters", lambda: files.loads_arena("cell 100 mm\n....\n.S.."), 8),
    "a file's keys": ("keys", lambda: files.loads(CHAIN).chain, CHAIN.count("=")),
    "a key": ("depth", lambda: files.loads(CHAIN).chain, 2),
    "places": (
        "points",
        lambda: transition_map(leg(), x=np.linspace(0, 0.02, 3), y=np.linspace(0, 0.01, 2)),
        6,
    ),
    "places of two parameters": (
        "points",
        lambda: parameter_map(
            leg(), ("outer.q.x", [0.015, 0.020]), ("outer.q.y", [0.0, 0.001, 0.002])
        ),
        6,
    ),
    "yields": ("samples", lambda: yields(leg(), Tolerances(anchor=1e-4), samples=70), 70),
    "robots": ("robots", lambda: simulation.sweep([robot()] * 2, cycles=1, settings=FAST), 2),
    "a walk": ("steps", lambda: robot().walk(0.01, settings=simulated()), 20),
    "a maze": ("steps", lambda: robot().maze(Arena(), limit=0.02, settings=simulated()), 20),
    "a sweep's walk": ("steps", lambda: simulation.sweep([robot()], cycles=1, settings=FAST), 400),
    "an animation": (
        "frames",
        lambda: figures.animation(leg().cycle(), NOWHERE, seconds=0.2, fps=20),
        4,
    ),
    "a graph": ("graph_cells", lambda: leg().graph(), 2),
    "a graph of relays": ("relays", lambda: leg().graph("force"), 2),
    "nodes of a walk": ("walked", lambda: [*leg().implicit_graph().walk(most=4)], 4),
    "branches": ("branches", lambda: leg().graph(), 2),
}
FAST = simulated(time_step=5e-3, contact_time=1e-2)
NOWHERE = "no such folder/cycle.gif"


def outcome(work):
    """What the work comes to, a folder that is not there left aside."""
    try:
        work()
    except FileNotFoundError:
        return None
    except ValueError as error:
        return str(error)
    return None


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_at_the_limit_it_is_done_and_one_less_is_refused_with_the_number_and_a_way_out(
    case, monkeypatch
):
    name, work, count = CASES[case]
    monkeypatch.setenv(VARIABLE, f"{name}={count}")
    assert outcome(work) is None
    monkeypatch.setenv(VARIABLE, f"{name}={count - 1}")
    message = outcome(work)
    assert (
        message is not None
        and f"{count} {LIMITS[name].of}: at most {count - 1} are taken" in message
    )
    # What the message says works.
    (advice,) = re.findall(rf"{VARIABLE}=(\w+=\d+)", message)
    monkeypatch.setenv(VARIABLE, advice)
    assert outcome(work) is None


def test_a_file_is_not_read_beyond_its_limit(tmp_path, monkeypatch):
    drawing, recording = tmp_path / "leg.toml", tmp_path / "run.csv"
    drawing.write_text(CHAIN, "utf-8")
    recording.write_text("Displacement (mm), Force (N)\n0, 1\n1, 2\n", "utf-8")
    for name, read, file in (
        ("design_bytes", files.load, drawing),
        ("recording_bytes", lab.read, recording),
    ):
        size = file.stat().st_size
        monkeypatch.setenv(VARIABLE, f"{name}={size}")
        read(file)
        monkeypatch.setenv(VARIABLE, f"{name}={size - 1}")
        with pytest.raises(ValueError, match=f"{size} bytes.*{VARIABLE}={name}={size} in"):
            read(file)


def test_a_run_that_would_fill_the_memory_is_refused(monkeypatch):
    with pytest.raises(ValueError, match=r"(1e\+09|2e\+09) s .*steps"):
        robot().walk(1e9)
    slow = replace(robot(), drive=replace(robot().drive, period=1e6))
    with pytest.raises(ValueError, match=r"8e\+06 s .*0\.001 s .* 8000\d* time steps"):
        slow.walk()
    monkeypatch.setenv(VARIABLE, "readings=100")
    with pytest.raises(ValueError, match=r"[0-9]+ numbers .*[0-9]+ readings.* 100"):
        robot().walk(0.2, settings=simulated())


def test_a_video_of_too_many_frames_is_refused_before_any_is_drawn(tmp_path, monkeypatch):
    walk = robot().walk(0.2, settings=simulated())
    monkeypatch.setenv(VARIABLE, "frames=3")
    with pytest.raises(VideoError, match=r"\d+ frames .* at most 3 .* speed"):
        simulation.video(walk, tmp_path / "walk.gif")
    assert not list(tmp_path.iterdir())


def test_a_map_tells_the_memory_that_it_would_take():
    axis = np.linspace(0.0, 0.02, 10**5)
    with pytest.raises(ValueError, match=r"100000 x 100000, which take 558\.8 GiB"):
        transition_map(leg(), x=axis, y=axis)
    with pytest.raises(ValueError, match=r"which take .* GiB"):
        parameter_map(leg(), ("outer.q.x", axis), ("outer.q.y", axis))
    with pytest.raises(ValueError, match=r"which take .* GiB"):
        boundaries(leg(), x=axis[:5], y=axis[:5], search=10**5)
    with pytest.raises(ValueError, match=r"which take .* GiB"):
        parameter_boundaries(leg(), ("outer.q.x", axis[:5]), ("outer.q.y", axis[:5]), search=10**5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cell=5", r"'cell' is no limit\. Did you mean cells\?"),
        ("xyz=5", r"'xyz' is no limit\. Known: cells, bands"),
        ("cells", r"'cells': must be cells and a whole number"),
        ("cells=many", r"'cells=many': must be cells and a whole number"),
        ("cells=0", r"'cells=0': must be cells and a whole number of 1 or more"),
        ("cells=-5, bands=3", r"'cells=-5': must be"),
        ("cells=1e4", r"'cells=1e4': must be .* as in cells=\d+0000"),
    ],
)
def test_what_raises_nothing_is_reported(text, message, monkeypatch):
    monkeypatch.setenv(VARIABLE, text)
    with pytest.raises(ValueError, match=message):
        leg()


def test_several_limits_are_raised_at_once(monkeypatch):
    monkeypatch.setenv(VARIABLE, "cells=5, bands=7 ,legs=9")
    assert [_limits.most(name) for name in ("cells", "bands", "legs")] == [5, 7, 9]
    assert _limits.most("turns") == LIMITS["turns"].most
    monkeypatch.setenv(VARIABLE, "")
    assert _limits.most("cells") == LIMITS["cells"].most


def test_the_page_has_every_limit_and_its_number():
    page = (Path(__file__).resolve().parents[1] / "docs" / "limits.md").read_text("utf-8")
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \| (\d+) \|", page, re.MULTILINE)
    held = [(name, limit.of, str(limit.most)) for name, limit in LIMITS.items()]
    assert rows == held, "say it in the table of docs/limits.md"
    tested = {name for name, _, _ in CASES.values()}
    elsewhere = {"built_cells", "design_bytes", "recording_bytes", "readings"}
    assert LIMITS.keys() - tested == elsewhere, "give the limit a case above"


def test_the_page_says_at_which_size_which_question_is_answered():
    page = (Path(__file__).resolve().parents[1] / "docs" / "limits.md").read_text("utf-8")
    named = re.findall(r"(\d+) \w+ \(`(\w+)`\)", page)
    assert {name for _, name in named} == {"relays", "graph_cells", "branches", "cells", "walked"}
    assert [LIMITS[name].most for _, name in named] == [int(number) for number, _ in named]
    assert f"| {MOST_STATES} states |" in page
    assert f"else {_MOST_BRANCHES} branches are looked at |" in page


@pytest.mark.slow
def test_a_map_of_every_second_square_is_drawn_in_one_pass():
    size = 400
    rows = ["".join("#" if (i + j) % 2 else "." for i in range(size)) for j in range(size)]
    rows[0] = "S" + rows[0][1:]
    # Every square touches others at corners alone, so the walls are the diagonals of one sense;
    # the one that was a square alone is the start.
    arena = files.loads_arena("cell 100 mm\n" + "\n".join(rows))
    assert len(arena.walls) == size - 1
    length = math.fsum(wall.length for wall in arena.walls)
    assert length == pytest.approx(size * size / 2 * 0.1 * math.sqrt(2.0), rel=1e-3)


@pytest.mark.parametrize("key", ["[x{}]", "x{} = 1", "y = 2\n  x{} = 1", "y = {{ x{} = 1 }}"])
@pytest.mark.parametrize("part", [".a", " . 'a.b'", '."a\\".b"'])
def test_a_deep_key_is_refused_before_it_is_read(key, part):
    with pytest.raises(DesignError, match=r"line \d+: .*30001 names .* at most 100"):
        files.loads(CHAIN + key.format(30_000 * part))


def test_dots_that_are_no_keys_are_left_alone():
    dotted = ".".join(100 * ["a"])
    text = f"# {dotted}.{dotted}\ntitle = '{dotted}'\n{CHAIN.replace('title', '# title')}"
    assert files.loads(text).chain.title == dotted


def test_of_many_unknown_keys_the_first_are_advised_and_all_are_counted(monkeypatch):
    asked: list[str] = []
    kept = wording.nearest_word
    monkeypatch.setattr(wording, "nearest_word", lambda *args: asked.append("") or kept(*args))
    text = CHAIN + "".join(f"key_{i} = 1\n" for i in range(20_000))
    with pytest.raises(DesignError) as error:
        files.loads(text)
    says(str(error.value).splitlines()[-1], "19960 more")
    assert len(asked) < 1200
    with pytest.raises(DesignError, match="cell: is missing"):
        files.loads("[chain]\n" + "".join(f"key_{i} = 1\n" for i in range(3000)))
