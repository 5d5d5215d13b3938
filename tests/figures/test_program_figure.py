"""The stroke program figure: tolerance intervals, names of states, travels of the engine."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from figures.drawn import cut_off, legend_of, lines, marks, points, says, untidy
from stepwell import figures, files
from stepwell.mechanism import Band, Cell, Chain
from stepwell.sequences import Program


def nested(count: int, stiffness: float = float("inf")) -> Chain:
    """Every loop of (F1, F0) inside the next one, so that all states can be reached."""
    reach = np.linspace(0.010, 0.030, count) - 0.010
    return Chain([Cell(Band((-0.010, 0.0), (q, 0.0))) for q in reach.tolist()], stiffness)


FORWARD = files.preset("paper-forward")
PROGRAMS = {
    "pair": lambda: FORWARD.program("01", start="10"),
    "full": lambda: FORWARD.program("11"),
    "nothing": lambda: FORWARD.program("00"),
    "three": lambda: nested(3).program("010", start="101"),
    "force": lambda: nested(3, 0.0).program("010"),
    "spring": lambda: nested(3, 30.0).program("010"),
    "six": lambda: nested(6).program("010101"),
}


@cache
def program_of(name: str) -> Program:
    """Several tests ask about the same program."""
    return PROGRAMS[name]()


@cache
def figure_of(name: str) -> Figure:
    """Several tests look at the same figure."""
    return figures.stroke_program(program_of(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", PROGRAMS)
def test_words_stay_apart_and_on_the_page(name):
    figure = figure_of(name)
    assert untidy(figure, 7.0) == []
    assert 25.4 * figure.get_size_inches()[0] == pytest.approx(180.0 if name == "six" else 85.0)


@pytest.mark.parametrize("name", ["pair", "three", "six"])
def test_the_curve_turns_at_the_turning_points(name):
    program = program_of(name)
    figure = figure_of(name)
    drawn = np.concatenate([points(line) for line in lines(figure, "drive")])
    drawn = drawn[np.isfinite(drawn).all(axis=1)]
    drawn = drawn[np.argsort(drawn[:, 0], kind="stable")]
    turning = np.array(program.turning_points) * 1e3
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(turning)))])
    # At constant speed: one millimetre of way for each millimetre of drive.
    assert drawn[:, 1] == pytest.approx(np.interp(drawn[:, 0], way, turning), abs=1e-6)
    assert drawn[-1] == pytest.approx((way[-1], turning[-1]))


@pytest.mark.parametrize(("name", "unit"), [("three", 1e3), ("force", 1.0), ("spring", 1e3)])
def test_windows_are_bars_from_low_to_high(name, unit):
    program = program_of(name)
    bars = [points(line)[:, 1] for line in lines(figure_of(name), "windows")]
    expected = [(turn.low * unit, turn.high * unit) for turn in program.turns]
    if program.high > program.low:
        expected.append((program.low * unit, program.high * unit))
    assert bars == [pytest.approx(bar) for bar in expected]


def test_turns_are_numbered_with_their_value_and_its_half_width():
    program = program_of("pair")
    (turn,) = program.turns
    said = says(figure_of("pair"))
    assert "1" in said
    assert f"{turn.drive * 1e3:.1f} ± {turn.slack * 1e3:.1f}" in said


@pytest.mark.parametrize("name", ["pair", "full", "three", "force", "spring"])
def test_all_states_passed_are_named(name):
    program = program_of(name)
    figure = figure_of(name)
    assert set(program.sequence) <= set(says(figure))
    assert marks(figure, "states") >= len(program.sequence)


def test_snaps_are_marked_on_the_curve_and_in_the_lanes():
    program = program_of("three")
    snaps = [event for event in program.path.events if event.kind.name == "SNAP"]
    figure = figure_of("three")
    assert marks(figure, "snaps") == len(snaps) > 0
    assert len(lines(figure, "jumps")) == sum(len(snap.cells) for snap in snaps)
    heights = np.concatenate([points(line)[:, 1] for line in lines(figure, "snaps")])
    assert heights == pytest.approx([snap.drive * 1e3 for snap in snaps])


def test_lanes_show_the_travel_of_every_cell_innermost_on_top():
    program = program_of("three")
    lower = figure_of("three").axes[1]
    named = [text for text in lower.texts if isinstance(text, Annotation)]
    names = [text for text in named if text.get_text() in program.chain.names]
    assert [text.get_text() for text in names] == list(program.chain.names)
    tops = [text.xy[1] for text in names]
    assert tops == sorted(tops, reverse=True)
    drawn = [line for line in lower.get_lines() if line.get_gid() == "travel"]
    for i in range(3):
        y = np.concatenate([points(line)[:, 1] for line in drawn[2 * i : 2 * i + 2]])
        mine = program.path.travel[:, i] * 1e3
        assert np.ptp(y[np.isfinite(y)]) == pytest.approx(np.ptp(mine))


@pytest.mark.parametrize(
    ("name", "upper", "lower"),
    [
        ("pair", "Stroke $u$ [mm]", "Cumulative drive [mm]"),
        ("force", "Actuator force [N]", "Cumulative drive [N]"),
        ("spring", "Actuator [mm]", "Cumulative drive [mm]"),
    ],
)
def test_axes_name_what_the_actuator_sets_and_its_unit(name, upper, lower):
    above, below = figure_of(name).axes
    assert above.get_ylabel() == upper
    assert below.get_xlabel() == lower
    assert below.get_ylabel() == "Travel $s$ [mm]"
    assert above.get_xlim() == below.get_xlim()
    assert above.get_position().x0 == below.get_position().x0


def test_the_legend_lists_what_there_is():
    assert legend_of(figure_of("pair")) == [
        "loading", "unloading", "snap", "tolerance interval",
    ]  # fmt: skip
    assert legend_of(figure_of("full")) == ["loading", "snap"]
    assert legend_of(figure_of("nothing")) == []


@pytest.mark.slow
def test_a_long_chain_is_shown_in_shades():
    program = nested(13).program("0" * 12 + "1")
    figure = figures.stroke_program(program)
    assert figure.axes[1].get_ylabel() == "Cell (white at 0, black at 1)"
    assert untidy(figure) == []


def test_long_names_of_cells_stay_on_the_page():
    cells = [replace(c, name=f"a cell of many words {k}") for k, c in enumerate(FORWARD.cells)]
    figure = figures.stroke_program(Chain(cells).program("01", start="10"))
    assert cut_off(figure) == []
