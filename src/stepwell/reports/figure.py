"""A figure for a paper: panels of a design by their names, on one page."""

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


# Of a map, the places of an anchor [m], as `stepwell map` takes them.
_ACROSS, _UP, _PLACES = (0.0, 0.020), (-0.015, 0.015), 200
# A robot's gait is shown after it has settled.
_CYCLES = 4


class Panel(NamedTuple):
    """What a panel shows, the figure of `figures`, what it is given, and of what kind of design."""

    shows: str
    figure: str  # Without one, what is given draws itself.
    given: str  # Attributes of the subject.
    of: type[Chain | Robot] = Chain

    def draw(self, subject: _Subject) -> Figure:
        """The panel of a design."""
        given = [attrgetter(name)(subject) for name in self.given.split()]
        return getattr(sw.figures, self.figure)(*given) if self.figure else given[0]()


@dataclass(frozen=True)
class _Subject:
    """A design, with what panels ask of it, each computed once."""

    design: Any  # a chain or a robot, as its panels take it
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
            raise InputError("the design has no program: `stepwell program` writes one into it.")
        return self.given

    @property
    def levers(self) -> list[Cell]:
        found = [cell for cell in self.design.cells if isinstance(cell, Cell)]
        if not found:
            raise InputError("the chain has no cell with a lever: see the panel elements.")
        return found

    @property
    def elements(self) -> Mapping[str, Element]:
        named = zip(self.design.names, self.design.cells, strict=True)
        found = {name: cell for name, cell in named if isinstance(cell, Element)}
        if not found:
            raise InputError("the chain has no element: see the panel cell-force.")
        return found

    @property
    def force(self) -> Callable[[], Figure]:
        return partial(sw.figures.force_stroke, self.cycle, measured=self.recordings)

    @cached_property
    def map(self) -> Callable[[], Figure]:
        from stepwell.design import boundaries, transition_map

        chain, outer = self.design, len(self.design) - 1
        cell = chain.cells[outer]
        if not isinstance(cell, Cell):
            raise InputError("the outer cell is an element and has no anchor to be moved.")
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
            raise InputError("how cells move in a snap needs a mass and a damping of each cell.")
        if not np.any(self.cycle.path.snap_after):
            raise InputError("this chain does not snap in its cycle.")
        each = [self.mass] * len(self.design), [self.damping] * len(self.design)
        return {"first snap": self.cycle.path.inertial_landing(0, *each, history=True)}


_robots = partial(Panel, of=Robot)
PANELS: MappingProxyType[str, Panel] = MappingProxyType(
    {
        "mechanism": Panel(
            "the mechanism in every state of its cycle, up to 12 cells",
            "mechanism",
            "design cycle.sequence",
        ),
        "force": Panel("force of the actuator over its stroke, recordings behind it", "", "force"),
        "travel": Panel("travel of each cell over the stroke", "travel_stroke", "cycle"),
        "landscape": Panel("energy over both travels, of two cells", "landscape", "cycle"),
        "elements": Panel("force of each element over its travel", "element_curves", "elements"),
        "graph": Panel("states and the ways between them", "transition_graph", "graph"),
        "map": Panel("what it does for each anchor of the outer cell", "", "map"),
        "cell-force": Panel(
            "force of each cell over its lever's angle", "unit_cell_force", "levers"
        ),
        "cell-energy": Panel(
            "energy of each cell over its lever's angle", "unit_cell_energy", "levers"
        ),
        "plane": Panel("force there against force back, of each cell", "force_plane", "design"),
        "program": Panel("the stroke program in the design", "stroke_program", "program"),
        "yield": Panel("the share that works, built with the usual tolerances", "", "yields"),
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
    """The panels of a figure of a design where nobody says which."""
    if isinstance(design, Robot):
        return "drawing", "prediction"
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
    """A figure of a design for a paper, its panels chosen by name.

    Args:
        design: a chain or a robot.
        panels: names of `PANELS`; several in a list make a row. By default mechanism, force, and
            landscape or travel; of a robot drawing and prediction.
        program: for the panel of that name.
        measured: recordings to be drawn behind the force, four at most.
        mass: outside each cell [kg], for the panel snap.
        damping: of each cell [N s/m], for the panel snap.
        page: `width`, `height` [mm], `columns` and `letters`, as for `figures.compose`; two columns
            of a journal, 180 mm, wide by default.

    Returns:
        The figure.

    Raises:
        ValueError: a panel that is unknown or that the design does not have, or a page too small.
    """
    subject = _Subject(design, program, measured, mass, damping)
    rows = panels or panels_of(design)
    drawn = [
        _panel(one, subject) if isinstance(one, str) else [_panel(name, subject) for name in one]
        for one in rows
    ]
    if measured and not any("force" in ([one] if isinstance(one, str) else one) for one in rows):
        raise InputError(
            "measured: recordings are drawn in the panel force, which is not asked for."
        )
    return sw.figures.compose(drawn, **page)


def _panel(name: str, subject: _Subject) -> Callable[[], Figure]:
    """What draws a panel, with its name in every refusal."""
    panel = PANELS.get(name)
    here = [known for known, one in PANELS.items() if isinstance(subject.design, one.of)]
    kind = "a robot" if isinstance(subject.design, Robot) else "a chain"
    if panel is None:
        near = nearest_word(name, PANELS)
        guess = f" Did you mean {near}?" if near else f" {kind.capitalize()} has {', '.join(here)}."
        raise InputError(f"panel {name!r}: there is none of that name.{guess}")
    if name not in here:
        raise InputError(f"panel {name!r}: {kind} has none. It has {', '.join(here)}.")

    def draw() -> Figure:
        try:
            return panel.draw(subject)
        except InputError as error:
            raise InputError(f"panel {name!r}: {error}") from None

    return draw
