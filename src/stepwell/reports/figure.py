"""A figure for publication: panels of a design, selected by name, on one page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from operator import attrgetter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import stepwell as sw
from stepwell.base import InputError, nearest_word
from stepwell.mechanism import Cell, Chain, Element
from stepwell.robot import Robot

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# About the height of a page [mm].
TALLEST = 247.0
# Anchor positions of a map [m], the defaults of `stepwell map`.
_ACROSS, _UP, _PLACES = (0.0, 0.020), (-0.015, 0.015), 200
# Cycles of a walk, so that the gait has settled.
_CYCLES = 4


class Panel(NamedTuple):
    """A panel: description, function of `figures`, its arguments, and the type of design."""

    shows: str
    figure: str  # If empty, the argument is a function that draws the panel.
    given: str  # Attributes of the subject.
    of: type[Chain | Robot] = Chain

    def draw(self, subject: _Subject) -> Figure:
        """The panel of a design."""
        given = [attrgetter(name)(subject) for name in self.given.split()]
        return getattr(sw.figures, self.figure)(*given) if self.figure else given[0]()


@dataclass(frozen=True)
class _Subject:
    """A design with the results that panels need, each computed once."""

    design: Any  # a chain or a robot
    given: sw.Program | None
    recordings: Sequence[sw.lab.Recording]
    mass: float | None
    damping: float | None

    @cached_property
    def cycle(self) -> sw.Cycle:
        return self.design.cycle()

    @cached_property
    def graph(self) -> sw.TransitionGraph:
        return self.design.graph()

    @cached_property
    def prediction(self) -> sw.robot.Prediction:
        return self.design.predict()

    @cached_property
    def walk(self) -> sw.simulation.Walk:
        return self.design.walk(_CYCLES)

    @property
    def program(self) -> sw.Program:
        if self.given is None:
            raise InputError("the design has no program: write one with `stepwell program`.")
        return self.given

    @property
    def levers(self) -> list[Cell]:
        levers = [cell for cell in self.design.cells if isinstance(cell, Cell)]
        if not levers:
            raise InputError("the chain has no cell with a lever: use the panel elements.")
        return levers

    @property
    def elements(self) -> Mapping[str, Element]:
        named = zip(self.design.names, self.design.cells, strict=True)
        elements = {name: cell for name, cell in named if isinstance(cell, Element)}
        if not elements:
            raise InputError("the chain has no element: use the panel cell-force.")
        return elements

    @property
    def force(self) -> Callable[[], Figure]:
        return partial(sw.figures.force_stroke, self.cycle, measured=self.recordings)

    @cached_property
    def map(self) -> Callable[[], Figure]:
        from stepwell.design import boundaries, transition_map

        chain, outer = self.design, len(self.design) - 1
        cell = chain.cells[outer]
        if not isinstance(cell, Cell):
            raise InputError(
                "the outer cell is an element without an anchor: use the panel elements instead."
            )
        x, y = np.linspace(*_ACROSS, _PLACES), np.linspace(*_UP, _PLACES)
        anchors = {band.q for band in cell.bands}
        marked = {"this design": anchors.pop()} if len(anchors) == 1 else {}
        data, curves = transition_map(chain, outer, x=x, y=y), boundaries(chain, outer, x=x, y=y)
        return partial(sw.figures.transition_map, data, curves, marked)

    @cached_property
    def yields(self) -> Callable[[], Figure]:
        from stepwell.design import Tolerances, yields

        spread = Tolerances(anchor=sw.base.USUAL_ANCHOR, stiffness=sw.base.USUAL_STIFFNESS)
        return partial(sw.figures.yield_bars, yields(self.design, spread, sensitivity=True))

    @cached_property
    def snap(self) -> Mapping[str, sw.statics.InertialLanding]:
        if self.mass is None or self.damping is None:
            raise InputError("the panel snap needs the mass and the damping of each cell.")
        if not np.any(self.cycle.path.snap_after):
            raise InputError("this chain has no snap in its cycle: use the panel force instead.")
        each = [self.mass] * len(self.design), [self.damping] * len(self.design)
        return {"first snap": self.cycle.path.inertial_landing(0, *each, history=True)}


_robots = partial(Panel, of=Robot)
PANELS: MappingProxyType[str, Panel] = MappingProxyType(
    {
        "mechanism": Panel(
            "the mechanism in every state of its cycle, up to 12 cells", "mechanism", "design cycle"
        ),
        "force": Panel("actuator force over the stroke, with recordings", "", "force"),
        "travel": Panel("travel of each cell over the stroke", "travel_stroke", "cycle"),
        "landscape": Panel("energy over both travels, for two cells", "landscape", "cycle"),
        "elements": Panel("force of each element over its travel", "element_curves", "elements"),
        "graph": Panel("states and transitions", "transition_graph", "graph"),
        "map": Panel("state sequence for each anchor of the outer cell", "", "map"),
        "cell-force": Panel(
            "force of each cell over its lever's angle", "unit_cell_force", "levers"
        ),
        "cell-energy": Panel(
            "energy of each cell over its lever's angle", "unit_cell_energy", "levers"
        ),
        "plane": Panel(
            "snap-through against snap-back force of each cell", "force_plane", "design"
        ),
        "program": Panel("the stroke program in the design", "stroke_program", "program"),
        "yield": Panel("yield with the usual tolerances", "", "yields"),
        "snap": Panel(
            "travels over time in the first snap; needs --mass and --damping",
            "snap_motion",
            "design snap",
        ),
        "drawing": _robots("the robot from above and side", "robot_drawing", "design"),
        "above": _robots("the robot from above", "robot_above", "design"),
        "side": _robots("the robot from its right", "robot_side", "design"),
        "prediction": _robots(
            "the gait that statics predicts, and its margins", "prediction", "prediction"
        ),
        "gait": _robots("a simulated walk: travels over time", "gait", "walk"),
        "trajectory": _robots("a simulated walk: its path from above", "trajectory", "walk"),
    }
)


def panels_of(design: Chain | Robot) -> tuple[str, ...]:
    """The default panels of a design."""
    if isinstance(design, Robot):
        return "side", "prediction"
    return "mechanism", "force", "landscape" if len(design) == 2 else "travel"


def figure(
    design: Chain | Robot,
    panels: Sequence[str | Sequence[str]] = (),
    *,
    program: sw.Program | None = None,
    measured: Sequence[sw.lab.Recording] = (),
    mass: float | None = None,
    damping: float | None = None,
    **page: Any,
) -> Figure:
    """A figure of a design for publication, with panels selected by name.

    Args:
        design: a chain or a robot.
        panels: names in `PANELS`; a list makes a row. By default mechanism, force, and landscape or
            travel; for a robot side and prediction; without the last ones if the figure would be
            higher than a page.
        program: stroke program for the panel of that name.
        measured: recordings drawn behind the force, at most four.
        mass: outside each cell [kg], for the panel snap.
        damping: of each cell [N s/m], for the panel snap.
        page: `width`, `height` [mm], `columns` and `letters`, as in `figures.compose`; the default
            width is two columns of a journal, 180 mm.

    Returns:
        The figure.

    Raises:
        ValueError: an unknown panel, a panel that the design does not have, or a page too small.
    """
    subject = _Subject(design, program, measured, mass, damping)
    rows = panels or panels_of(design)
    drawn = [
        _panel(one, subject) if isinstance(one, str) else [_panel(name, subject) for name in one]
        for one in rows
    ]
    if measured and not any("force" in ([one] if isinstance(one, str) else one) for one in rows):
        raise InputError("measured: recordings need the panel force: add it to the panels.")
    made = sw.figures.compose(drawn, **page)
    while (
        not panels
        and len(drawn) > 1 + bool(measured)
        and made.get_size_inches()[1] * 25.4 > TALLEST
    ):
        drawn.pop()
        made = sw.figures.compose(drawn, **page)
    return made


def _panel(name: str, subject: _Subject) -> Callable[[], Figure]:
    """Function that draws a panel, with its name in every error."""
    panel = PANELS.get(name)
    here = [known for known, one in PANELS.items() if isinstance(subject.design, one.of)]
    kind = "a robot" if isinstance(subject.design, Robot) else "a chain"
    if panel is None:
        near = nearest_word(name, PANELS)
        guess = f" Did you mean {near}?" if near else f" {kind.capitalize()} has {', '.join(here)}."
        raise InputError(f"panel {name!r}: unknown name.{guess}")
    if name not in here:
        raise InputError(f"panel {name!r}: not available for {kind}. Use {', '.join(here)}.")

    def draw() -> Figure:
        try:
            return panel.draw(subject)
        except InputError as error:
            raise InputError(f"panel {name!r}: {error}") from None

    return draw
