"""Names in figures are text: never mathematics, never left out, in a font with their letters."""

import logging
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

import stepwell as sw
from cards.values import of_robots as held_of_robots
from hoppers import jumped
from lab.machine import pair, unit
from sizes import cases
from stepwell import figures, files, lab, simulation
from stepwell.build import MotionSweep
from stepwell.design import (
    Tolerances,
    boundaries,
    margin,
    parameter_boundaries,
    parameter_map,
    transition_map,
    yields,
)
from stepwell.figures.common import words as _names
from stepwell.figures.common.words import literal
from stepwell.lab.series import paper_cell
from stepwell.paper import Effect, Sensitivity
from stepwell.studies import Axis, DecidingNumbers, Influence, Space, sweep

# Mathematics, a field of a format, a name that legends leave out, letters that cannot be printed.
NAMES = cases(
    ["$\\frac$", "{}", "_hidden", "a\u202eb", "$$", "$a$", "a_b^c", "%", "\\", "\x1b[1m"],
    ["_hidden{}", "$\\frac$a\u202eb"],
)
ALL = "$\\frac$_^%"


def named(chain: sw.Chain, name: str) -> sw.Chain:
    cells = [replace(cell, name=f"{name}{i}") for i, cell in enumerate(chain.cells)]
    return replace(chain, cells=tuple(cells), title=name)


def of_chains(name: str) -> Iterator[partial[object]]:
    """Every figure of a chain, with its names."""
    chain = named(sw.preset("paper-forward"), name)
    cycle, x, y = chain.cycle(), np.linspace(0, 0.02, 4), np.linspace(-0.015, 0.015, 4)
    parameters = (f"{name}1.q.x", [0.0, 0.01, 0.02]), (f"{name}0.stiffness", [20.0, 30.0])
    spread = yields(chain, Tolerances(anchor=0.003), samples=40, sensitivity=True)
    yield partial(figures.standard, cycle)
    yield partial(figures.overview, cycle)
    yield partial(figures.compose, {name: [partial(figures.force_stroke, cycle)]})
    yield partial(figures.margins, margin(chain))
    yield partial(figures.unit_cell_force, chain.cells)
    yield partial(figures.unit_cell_energy, chain.cells)
    cell = sw.Cell(sw.Band(p=(-0.010, 0.0), q=(0.010, 0.0)), name=name)
    yield partial(figures.labelled_cell, cell)
    yield partial(figures.layers, sw.build(chain, samples=20))
    yield partial(figures.labelled_chain, chain)
    yield partial(figures.holes, chain)
    yield partial(
        figures.transition_map,
        transition_map(chain, 1, x=x, y=y),
        boundaries(chain, 1, x=x, y=y),
        {name: (0.01, 0.0)},
    )
    yield partial(
        figures.transition_map,
        parameter_map(chain, *parameters),
        parameter_boundaries(chain, *parameters),
        {name: (0.01, 30.0)},
    )
    snap = cycle.path.inertial_landing(0, [0.01, 0.01], [0.3, 0.3], history=True)
    yield partial(figures.snap_motion, chain, {name: snap})
    yield partial(figures.stroke_program, chain.program("01"))
    yield partial(figures.transition_graph, chain.graph())
    yield partial(figures.yield_bars, spread)
    yield partial(figures.force_plane, chain, clouds=spread.end_forces(20))
    element = sw.elements.trilinear(name=name)
    yield partial(figures.element_curve, element, source=name)
    yield partial(figures.element_curves, {name: element})
    effects = [Effect(name, 0.1, 0.2, 0.3, 0.4)]
    decided = DecidingNumbers(name, "", 60, 0.01, (Influence(name, 0.5, 0.4),))
    yield partial(figures.influences, [decided])
    yield partial(figures.tornado, Sensitivity("fraction", 0.35, effects))


def of_robots(name: str) -> Iterator[partial[object]]:
    """Every figure of a robot, with its names."""
    robot = files.load("preset:robot-explorer").robot
    legs = [replace(leg, name=name + leg.name, chain=named(leg.chain, name)) for leg in robot.legs]
    antennas = [replace(a, name=name + a.name, leg=name + a.leg, cell=0) for a in robot.antennas]
    robot = replace(robot, legs=legs, antennas=antennas, title=name)
    maze = robot.maze(replace(files.load_arena("cylinder"), title=name), limit=4)
    yield partial(figures.robot_drawing, robot)
    yield partial(figures.robot_above, robot)
    yield partial(figures.robot_side, robot)
    yield partial(figures.prediction, replace(robot, antennas=antennas[:1]).predict())
    free = MotionSweep(True, (), (), (), 0, 0)
    yield partial(figures.robot_parts, sw.build(replace(robot, antennas=()), swept=free))
    yield partial(figures.maze, maze)
    yield partial(figures.maze_timeline, maze)
    for draw in (figures.gait, figures.trajectory, figures.contacts):
        yield partial(draw, maze.walk)
    yield partial(figures.trajectories, {name: maze.walk})
    jump = jumped()
    hopper = replace(jump.hopper, title=name, chain=named(jump.hopper.chain, name))
    for draw in (figures.energy_flow, figures.flight):
        yield partial(draw, replace(jump, hopper=hopper))
    yield partial(figures.gait_plane, held_of_robots()["CompiledRobot"])
    trial = simulation.Trial(0.1, 0.0, 0.1, (name, name), 0.0, "")
    for n in (1, 2, 3):
        values = {f"leg.{name}.{i}": [0.3, 0.5] for i in range(n)}
        yield partial(figures.sweep, simulation.Sweep(values, (trial, trial)))


def check(draw: Callable[[], object], name: str) -> int:
    """Draw it, and say how many texts show the name; none has it raw where that would be read."""
    drawn: Any = draw()
    shown = 0
    for figure in [drawn] if isinstance(drawn, Figure) else drawn.values():
        figure.draw_without_rendering()
        texts = [text.get_text() for text in figure.findobj(Text)]
        shown += sum(literal(name).lstrip("\u200b") in text for text in texts)
        if "$" in name or not name.isprintable():
            assert not [text for text in texts if name in text]
    return shown


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_drawn_letter_by_letter(name):
    cycle = named(sw.preset("paper-forward"), name).cycle()
    assert check(partial(figures.standard, cycle), name) > 0
    assert check(partial(figures.unit_cell_force, cycle.chain.cells), name) > 0


@pytest.fixture(scope="module")
def chains():
    return list(of_chains(ALL))


@pytest.fixture(scope="module")
def robots():
    return list(of_robots(ALL))


@pytest.mark.slow
def test_every_figure_of_a_chain_draws_names_as_text(chains):
    # A transition graph and layers call cells by their places; a lettered cell has no name.
    assert sum(check(draw, ALL) > 0 for draw in chains) == len(chains) - 3


@pytest.mark.slow
def test_every_figure_of_a_robot_draws_names_as_text(robots):
    assert sum(check(draw, ALL) > 0 for draw in robots) >= 10


@pytest.mark.slow
def test_no_figure_is_left_out_here(chains, robots, tmp_path):
    tried = {draw.func.__name__ for draw in (*chains, *robots)}
    elsewhere = {
        # Each draws what `standard` draws.
        "mechanism", "landscape", "force_stroke", "travel_stroke",
        # No figures.
        "save", "svg", "standard_draws", "length", "JournalWidth", "JOURNAL_WIDTHS",
        "PRINT_DPI",
        # One of the others.
        "plot",
        # Names of laws and numbers, all ours.
        "band_laws", "calibration", "graph_classes",
        # Below.
        "animation", "moving", "measured_forces", "measured_energies", "measured_pairs",
        "recording", "recordings", "measured_element", "outcomes",
    }  # fmt: skip
    assert tried | elsewhere == set(figures.__all__), "draw it with names in `of_chains` or below"
    cycle = named(sw.preset("paper-forward"), ALL).cycle()
    figures.animation(cycle, tmp_path / "a.gif", seconds=0.5, fps=2)
    drawn = figures.moving(cycle, tmp_path / "a.svg", seconds=0.5).read_text("utf-8")
    assert ALL in "".join(ElementTree.fromstring(drawn).itertext())
    runs = [unit("friction_1.txt", None), pair("2unit_friction_1.txt", None)]
    cells = lab.compare([*runs, unit("1unit_MM_1.txt", paper_cell())]).cells
    pairs = lab.compare([*runs, pair("2unit_MMT_1.txt", cycle.chain)], [cycle.chain]).pairs
    for draw, tests in (
        (figures.measured_forces, cells),
        (figures.measured_energies, cells),
        (figures.measured_pairs, pairs),
    ):
        assert tests
        check(partial(draw, tests), ALL)
    other = ALL.replace("\\", "")  # which no column may have in its name
    space = Space((Axis(f"{other}1.q.x", 0.0, 0.02, 3),))
    study = sweep(named(cycle.chain, other), "cycle", space, tmp_path / "s.zarr", workers=1).study
    assert check(partial(figures.outcomes, study), f"{other}1.q.x") > 0
    assert check(partial(figures.recording, replace(runs[0], source=ALL)), ALL) == 1
    assert check(partial(figures.recordings, [replace(runs[0], source=ALL)]), ALL) == 1
    travel = np.linspace(0.0, 0.01, 200)
    hinge = lab.measure_element(
        replace(runs[0], time=travel, stroke=travel, force=50.0 * travel), ALL
    )
    check(partial(figures.measured_element, hinge), ALL)


@pytest.mark.slow
def test_letters_that_a_font_has_are_drawn_and_others_are_reported_once(monkeypatch, caplog):
    monkeypatch.setattr(_names, "families", lambda: ("DejaVu Sans",))
    monkeypatch.setattr(_names, "_logged", set())
    cycle = named(sw.preset("paper-forward"), "漢字 Ж é").cycle()
    with caplog.at_level(logging.WARNING, "stepwell"):
        for figure in figures.standard(cycle).values():
            figure.draw_without_rendering()
    (record,) = caplog.records
    assert "Noto Sans CJK" in record.getMessage()
    assert literal("漢字 Ж é") == "□□ Ж é"
    monkeypatch.setattr(_names, "families", lambda: ("DejaVu Sans", "a font of East Asia"))
    monkeypatch.setattr(
        _names,
        "letters_of",
        lambda family, known=_names.letters_of: (
            known(family) if family == "DejaVu Sans" else frozenset(map(ord, "漢字"))
        ),
    )
    assert literal("漢字") == "漢字"
