"""Transition maps over any two parameters of a chain, and the curves between their regions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import __version__
from stepwell.design.maps.between import between
from stepwell.design.maps.outcomes import Bools, Floats, Ints, Outcomes, snapping_steps
from stepwell.design.maps.pathways import IMPOSSIBLE, TIED, UNSOLVED
from stepwell.design.maps.transition_map import TIE
from stepwell.design.parameters import Parameter, parameter, require_places
from stepwell.design.plane import RESOLVED, Boundary, BoundaryKind, Line, trace
from stepwell.design.tolerances import WAY
from stepwell.mechanism import Chain, SlipError

if TYPE_CHECKING:
    import xarray as xr

Axis = tuple[str, ArrayLike]

# Bisection in the closed form goes on down to rounding, which leaves this part of an axis.
_EXACT = 1e-13
# Longest chain whose sequences are written out; those of longer ones are told by their orders.
_SHORT = 12
_BYTES = 60  # of a place, on the way and in the result
_WORDS = {IMPOSSIBLE: "no mechanism", UNSOLVED: "no answer", TIED: "a tie decides"}


@dataclass(frozen=True, eq=False)
class ParameterBoundary(Boundary):
    """A curve in the plane of two parameters, across which the chain does something else.

    As a `Boundary`, with these differences:

    Attributes:
        points: (m, 2) along the curve, each column in the SI unit of its parameter.
        error: farthest a point is from the curve, as a part of the axes.
        parameters: names of the two parameters.
        units: their units.
        sequences: what the chain does on either side; words where that is no sequence.
    """

    parameters: tuple[str, str]
    units: tuple[str, str]
    sequences: tuple[str, str]

    def __repr__(self):
        return (
            f"ParameterBoundary({self.changes}; {len(self.points)} points, {self.method}, within "
            f"{self.error:.1g} of the axes)"
        )


def parameter_map(
    chain: Chain,
    x: Axis,
    y: Axis,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """What a chain does for every value of two of its parameters.

    Any two parameters of any cells, of the actuator's stiffness or of friction; names as in
    `parameter`. Designs of concave cells of equal travel under a rigid actuator are sorted in
    closed form; all others go through the general engine one by one (a millisecond or so each).
    `attrs` counts both.

    Args:
        chain: any number of cells.
        x, y: name and rising values of a parameter, such as ("inner.stiffness", values), SI.
        progress: called with (done, total) while the general engine works.

    Returns:
        Dataset with dims ("y", "x"):
        sequence, int32, codes in its attrs flag_values and flag_meanings, among them
        "impossible" where a band's ends would meet and "unsolved" where the engine gave up;
        snaps_loading, snaps_unloading, steps from state to state in which the chain snaps
        (a snap that is handed on from cell to cell counts once); -1 where there is no answer;
        degenerate, whether the design sits on a boundary (two forces within 1e-9 of k r, or the
        engine met a tie).

    Raises:
        ValueError: no such parameter, values that do not rise or that it cannot have, or more
            places than the limit.

    Source: Kamp et al. 2024, Fig. 2C, for one anchor of two cells; sorting theorem, theory page.
    """
    parameters, values = _axes(chain, x, y, 1)
    require_places(len(values[0]), len(values[1]), _BYTES)
    outcomes = Outcomes(chain, *parameters, np.array([np.ptp(v) for v in values]))
    shape = (len(values[1]), len(values[0]))
    nodes = np.stack(np.meshgrid(*values), axis=-1).reshape(-1, 2)
    found = outcomes.closed_form(nodes)
    sequence, snaps = found.number.copy(), found.snaps.copy()
    scale = chain.cells[0].bands[0].stiffness * chain.cells[0].lever
    degenerate = (found.gap < TIE * scale) & (sequence != UNSOLVED)
    waiting = np.flatnonzero(sequence == UNSOLVED).tolist()
    for done, i in enumerate(waiting):
        if progress is not None:
            progress(done, len(waiting))
        sequence[i], result = outcomes.by_engine(nodes[i])
        snaps[i] = -1 if result is None else snapping_steps(result)
        degenerate[i] = result is not None and bool(result.degenerate)
    if progress is not None:
        progress(len(waiting), len(waiting))
    fields = {
        "sequence": sequence.reshape(shape).astype(np.int32),
        "snaps_loading": snaps[:, 0].reshape(shape).astype(np.int32),
        "snaps_unloading": snaps[:, 1].reshape(shape).astype(np.int32),
        "degenerate": degenerate.reshape(shape),
    }
    return _labelled(outcomes, fields, values, asked=len(waiting))


def parameter_boundaries(
    chain: Chain,
    x: Axis,
    y: Axis,
    *,
    search: int = 61,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[ParameterBoundary, ...]:
    """The curves between the regions of a map over two parameters.

    A grid is asked, and every change between two neighbouring nodes is bisected: to rounding
    where the closed form holds ("exact"), else to 1e-9 of the axis by the general engine
    ("search"). A curve ends up to one grid step short of a point where three regions meet, and
    features finer than the grid are not seen.

    Args:
        chain: any number of cells.
        x, y: name and rising values of a parameter, two or more. The grid keeps their spacing:
            np.geomspace makes it logarithmic.
        search: nodes of the grid each way.
        progress: called with (done, total) while the general engine works.

    Returns:
        The curves, each with the sequences on both sides and what changes between them.

    Raises:
        ValueError: no such parameter, values that do not rise or that it cannot have, or fewer
            than 2 nodes.
    """
    parameters, values = _axes(chain, x, y, 2)
    if search < 2:
        raise ValueError(f"search = {search}: must be 2 or more nodes each way.")
    require_places(search, search, _BYTES)
    outcomes = Outcomes(chain, *parameters, np.array([np.ptp(v) for v in values]))

    def place(t: Floats) -> Floats:
        # From the unit square to the parameters, with the spacing of the user's values.
        spots = [np.linspace(0.0, 1.0, len(v)) for v in values]
        return np.stack([np.interp(t[:, k], spots[k], values[k]) for k in (0, 1)], axis=-1)

    line = np.linspace(0.0, 1.0, search)
    grid = np.stack(np.meshgrid(line, line), axis=-1)
    number, _ = outcomes.label(place(grid.reshape(-1, 2)), progress)

    def centre(row: int, column: int) -> int:
        middle = (grid[row, column] + grid[row + 1, column + 1]) / 2
        return int(outcomes.label(place(middle[None]))[0][0])

    found: list[ParameterBoundary] = []
    for traced in trace(number.reshape(search, search), centre, ignore=IMPOSSIBLE):
        for t, labels, exact in _curves(outcomes, place, grid, traced):
            kind, changes, sides = _told(outcomes, labels)
            found.append(
                ParameterBoundary(
                    kind,
                    place(t),
                    changes,
                    "exact" if exact else "search",
                    _EXACT if exact else RESOLVED,
                    (parameters[0].name, parameters[1].name),
                    (parameters[0].unit, parameters[1].unit),
                    sides,
                )
            )
    return tuple(found)


def _axes(
    chain: Chain, x: Axis, y: Axis, least: int
) -> tuple[tuple[Parameter, Parameter], tuple[Floats, Floats]]:
    parameters: list[Parameter] = []
    values: list[Floats] = []
    for letter, given in (("x", x), ("y", y)):
        try:
            name, numbers = given
        except (TypeError, ValueError):
            raise ValueError(
                f"{letter} = {given!r}: must be the name of a parameter and its values, such as "
                f"('{chain.names[0]}.stiffness', np.linspace(20, 40, 50))."
            ) from None
        one = parameter(chain, name)
        parameters.append(one)
        values.append(one.values(numbers, least))
        slips = one.slips(chain, max(values[-1].tolist(), key=abs))
        if slips:
            raise SlipError(slips, WAY)
        if "." not in one.part:
            # Values out of range are refused here; an anchor has none.
            for value in values[-1][[0, -1]].tolist():
                one.changed(chain, value)
    if parameters[0] == parameters[1]:
        raise ValueError(f"x and y are both {parameters[0].name!r}: take two parameters.")
    return (parameters[0], parameters[1]), (values[0], values[1])


def _curves(
    outcomes: Outcomes, place: Callable[[Floats], Floats], grid: Floats, line: Line
) -> list[tuple[Floats, tuple[int, int], bool]]:
    """The stretches of a traced line with one pair of labels and one method.

    Points (m, 2) in the unit square, the labels on both sides, and whether it is exact.
    """
    ends = [grid[tuple(side.T)] for side in (line.low, line.high)]
    sides = [outcomes.label(place(end)) for end in ends]
    labels, proved = [s[0] for s in sides], sides[0][1] & sides[1][1]
    edge = float(np.max(np.linalg.norm(ends[1] - ends[0], axis=1)))
    fine = math.ceil(math.log2(edge / RESOLVED))
    every = np.ones(len(proved), np.bool_)
    proved &= _bisect(outcomes, place, ends, labels, every, fine)
    _bisect(outcomes, place, ends, labels, proved, math.ceil(math.log2(edge / _EXACT)) - fine)
    middle = (ends[0] + ends[1]) / 2
    pairs = np.sort(np.stack(labels, axis=-1), axis=1)
    found: list[tuple[Floats, tuple[int, int], bool]] = []

    def alike(i: int) -> tuple[int, int, bool]:
        return int(pairs[i, 0]), int(pairs[i, 1]), bool(proved[i])

    for (a, b, exact), run in groupby(range(len(middle)), alike):
        points = middle[list(run)]
        if len(points) > 1 and IMPOSSIBLE not in (a, b):
            found.append((points, (a, b), exact))
    return found


def _bisect(
    outcomes: Outcomes,
    place: Callable[[Floats], Floats],
    ends: list[Floats],
    labels: list[Ints],
    which: Bools,
    steps: int,
) -> Bools:
    """Halve the marked edges, in place; says of each whether every label was proved."""
    proved = which.copy()
    if not np.any(which):
        return proved
    for _ in range(steps):
        middle = (ends[0][which] + ends[1][which]) / 2
        number, sure = outcomes.label(place(middle))
        first = number == labels[0][which]
        for k, here in ((0, first), (1, ~first)):
            at = np.flatnonzero(which)[here]
            ends[k][at], labels[k][at] = middle[here], number[here]
        proved[which] &= sure
    return proved


def _told(outcomes: Outcomes, labels: tuple[int, int]) -> tuple[BoundaryKind, str, tuple[str, str]]:
    a, b = (_meaning(outcomes, number) for number in labels)
    if min(labels) < 0:
        return BoundaryKind.PATHWAY, f"{a} | {b}", (a, b)
    first, second = (outcomes.sequences[number] for number in labels)
    kind, changes = between(first, second, outcomes.chain.names)
    return kind, changes, (a, b)


def _meaning(outcomes: Outcomes, number: int) -> str:
    if number < 0:
        return _WORDS[number]
    sequence = outcomes.sequences[number]
    if len(outcomes.chain) <= _SHORT:
        return str(sequence)
    # Cells in the order in which they move, by number.
    return "moves:" + ",".join("+".join(map(str, flip)) for flip in sequence.flips)


def _labelled(
    outcomes: Outcomes,
    fields: dict[str, NDArray[np.generic]],
    values: tuple[Floats, Floats],
    asked: int,
) -> xr.Dataset:
    import xarray as xr

    sequence = fields["sequence"]
    impossible, unsolved = (int(np.sum(sequence == code)) for code in (IMPOSSIBLE, UNSOLVED))
    codes = range(len(outcomes.sequences))
    meanings = [*(_meaning(outcomes, code) for code in codes), "impossible", "unsolved"]
    about = {
        "sequence": {
            "long_name": "states visited in a full cycle",
            "flag_values": np.array([*codes, IMPOSSIBLE, UNSOLVED], np.int32),
            "flag_meanings": " ".join(meanings),
        },
        "snaps_loading": {"long_name": "steps that snap while loading", "units": "1"},
        "snaps_unloading": {"long_name": "steps that snap while unloading", "units": "1"},
        "degenerate": {"long_name": "design on a boundary: a tie decides"},
    }
    axes = zip("xy", outcomes.parameters, values, strict=True)
    return xr.Dataset(
        {name: (("y", "x"), fields[name], notes) for name, notes in about.items()},
        coords={
            letter: (letter, array, {"long_name": one.name, "units": one.unit})
            for letter, one, array in axes
        },
        attrs={
            "title": outcomes.chain.title or "parameter map",
            "chain": repr(outcomes.chain),
            "closed_form_designs": sequence.size - asked,
            "engine_designs": asked - impossible,
            "impossible_designs": impossible,
            "unsolved_designs": unsolved,
            "assumptions": (
                "quasi-static cycle from all cells at 0 to all at 1 and back; overdamped snaps at "
                "fixed stroke; closed form only where all cells are proved taut with falling "
                "force, share one full travel, and the actuator is rigid, the general engine "
                "elsewhere"
            ),
            "source": f"stepwell {__version__}, parameter_map",
        },
    )
