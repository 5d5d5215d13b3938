"""Design map of a chain over two of its parameters: image, boundaries, position of the design."""

import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from stepwell import files
from stepwell.base import Floats, InputError, Quantity, display_unit, nearest_word
from stepwell.design import (
    Boundary,
    BoundaryKind,
    Parameter,
    parameter_boundaries,
    parameter_map,
    parameters,
)
from stepwell.mechanism import Cell, Chain
from stepwell.studio.ask import Ask, PageDesign, View

_FARTHEST = 1e6
_MOST_PIXELS = 1000
_PERCENT = "%", 100.0
Blocks = dict[str, np.ndarray[Any, Any]]
Progress = Callable[[float, float], None]


class Unproved(InputError):
    """The sequence is not known in closed form everywhere on the plane."""


@dataclass(frozen=True)
class PlaneAxis:
    """One of the two parameters, and the range of its values in SI."""

    parameter: Parameter
    low: float
    high: float

    def middles(self, count: int) -> Floats:
        """(count,) the middle of every pixel, in SI."""
        edges = np.linspace(self.low, self.high, count + 1)
        return (edges[1:] + edges[:-1]) / 2


@dataclass(frozen=True)
class Plane:
    """A chain and two parameters; designs that differ only in these parameters are equal."""

    chain: Chain  # at any position of the plane
    axes: tuple[PlaneAxis, PlaneAxis]  # of x and of y
    # Position of the design in SI; other results do not depend on it.
    here: tuple[float, float] = field(compare=False)

    @classmethod
    def asked(cls, chain: Chain, ask: Ask) -> "Plane":
        """The plane of the keys x, y, x_range and y_range."""
        axes = _axis(chain, ask, "x"), _axis(chain, ask, "y")
        x, y = (float(axis.parameter.value(chain)) for axis in axes)  # type: ignore[arg-type]
        with suppress(
            ValueError
        ):  # no valid design there; then the chain itself represents the plane
            for axis in axes:
                chain = axis.parameter.changed(chain, axis.low)
        return cls(chain, axes, (x, y))

    def painted(self, wide: int, high: int, progress: Progress) -> tuple[dict[str, Any], Blocks]:
        """The sequences on the plane, and an image (high, wide) of indices into them."""
        sized = zip(self.axes, (wide, high), strict=True)
        x, y = ((axis.parameter, axis.middles(count)) for axis, count in sized)
        nodes = parameter_map(self.chain, x, y, progress=progress)
        flags = nodes.sequence.attrs
        numbers = np.asarray(flags["flag_values"]).tolist()
        words = dict(zip(numbers, flags["flag_meanings"].split(" "), strict=True))
        codes, image, counts = np.unique(
            nodes.sequence.values, return_inverse=True, return_counts=True
        )
        fractions = (counts / counts.sum()).tolist()
        header = {"sequences": [words[code] for code in codes.tolist()], "fractions": fractions}
        blocks: Blocks = {"image": image.reshape(high, wide).astype(np.int32)}
        for letter, (parameter, values) in (("x", x), ("y", y)):
            blocks[letter] = values * unit_of(parameter)[1]
        return header, blocks

    def curves(self, search: int, progress: Progress) -> tuple[Boundary, ...]:
        """The boundaries on the plane, searched on `search` nodes per axis if not exact."""
        x, y = ((axis.parameter, np.array([axis.low, axis.high])) for axis in self.axes)
        return parameter_boundaries(self.chain, x, y, search=search, progress=progress)

    def boundary_view(self, curves: Iterable[Boundary]) -> tuple[dict[str, Any], Blocks]:
        """The curves in units of the page, and the distance of the design from the nearest."""
        (x, x_factor), (y, y_factor) = (unit_of(axis.parameter) for axis in self.axes)
        factors = np.array([x_factor, y_factor])
        here = np.array(self.here) * factors
        blocks: Blocks = {f"boundary {k}": c.points * factors for k, c in enumerate(curves)}
        listed = [
            {
                "block": f"boundary {k}",
                "kind": curve.kind.name.lower(),
                "changes": curve.changes,
                "method": curve.method.name.lower(),
                "sequences": list(curve.sequences),
            }
            for k, curve in enumerate(curves)
        ]
        ways = _ways(here, curves, blocks, (x, y)) if np.all(np.isfinite(here)) else []
        place = [value if math.isfinite(value) else None for value in here.tolist()]
        return {"here": place, "units": [x, y], "boundaries": listed, "nearest": ways}, blocks


def pixels(ask: Ask) -> tuple[int, int]:
    """Number of pixels of the image, across and up, for blocks of `coarse` by `coarse` pixels."""
    wide, high = (int(n) for n in ask.numbers("pixels", 2, 2, _MOST_PIXELS, least_many=2))
    coarse = ask.whole("coarse", 1, 64, 1)
    return max(2, -(-wide // coarse)), max(2, -(-high // coarse))


def asked_parameter(chain: Chain, ask: Ask, letter: str) -> Parameter:
    """The parameter that key x or y names, as panel `parameters` lists them."""
    known = {key_of(one): one for one in parameters(chain) if not one.is_anchor}
    key = ask.text(letter, 60)
    if key not in known:
        near = nearest_word(key, list(known))
        advice = f"Did you mean {near!r}?" if near else "Panel `parameters` lists them."
        raise InputError(f"ask.{letter} = {key!r}: no such parameter of this chain. {advice}")
    return known[key]


def key_of(parameter: Parameter) -> str:
    """Key of a parameter in a request; cells have numbers from 1, since names may repeat."""
    return parameter.name if parameter.cell is None else f"{parameter.cell + 1}.{parameter.part}"


def unit_of(parameter: Parameter) -> tuple[str, float]:
    """Unit of a parameter on the page, and its factor from SI."""
    unit, factor = display_unit(parameter.unit)
    return _PERCENT if unit == "1" else (Quantity("", unit).sign, factor)


def unproved(_done: float, total: float) -> None:
    """A progress function that raises as soon as a position has to be simulated."""
    if total:
        raise Unproved(f"{total:.0f} positions have to be simulated one by one.")


@lru_cache(maxsize=16)
def _proved_curves(plane: Plane) -> tuple[Boundary, ...]:
    # The grid only detects positions without a proof, which end the search.
    return plane.curves(61, unproved)


def _axis(chain: Chain, ask: Ask, letter: str) -> PlaneAxis:
    parameter = asked_parameter(chain, ask, letter)
    factor = unit_of(parameter)[1]
    low, high = ask.pair(f"{letter}_range", -_FARTHEST, _FARTHEST)
    return PlaneAxis(parameter, low / factor, high / factor)


def _ways(
    here: Floats, curves: Iterable[Boundary], blocks: Blocks, units: tuple[str, str]
) -> list[dict[str, Any]]:
    """The shortest change to another sequence, or one along each axis if their units differ."""
    nearest: dict[str, dict[str, Any]] = {}
    for k, curve in enumerate(curves):
        if curve.kind is BoundaryKind.BISTABLE:
            continue
        points = blocks[f"boundary {k}"]
        if units[0] == units[1]:
            places = {"plane": _closest(here, points)}
        else:
            places = {"xy"[i]: _met(here, points, i) for i in range(2)}
        for along, at in places.items():
            if at is None:
                continue
            far = float(np.linalg.norm(at - here))
            if along not in nearest or far < nearest[along]["distance"]:
                nearest[along] = {
                    "along": along,
                    "distance": far,
                    "unit": units["xy".find(along)] if along in "xy" else units[0],
                    "at": at.tolist(),
                    "sequences": list(curve.sequences),
                    "method": curve.method.name.lower(),
                }
    return list(nearest.values())


def _closest(here: Floats, points: Floats) -> Floats | None:
    """The closest point of a polyline (m, 2)."""
    start, way = points[:-1], np.diff(points, axis=0)
    length = np.maximum(np.sum(way**2, axis=1), 1e-300)
    share = np.clip(np.sum((here - start) * way, axis=1) / length, 0.0, 1.0)
    places = start + share[:, None] * way
    return places[np.argmin(np.sum((places - here) ** 2, axis=1))] if len(places) else None


def _met(here: Floats, points: Floats, axis: int) -> Floats | None:
    """First intersection of a polyline (m, 2) with a straight line along one axis, if any."""
    off = points[:, 1 - axis] - here[1 - axis]
    k = np.flatnonzero((off[:-1] <= 0) != (off[1:] <= 0))
    if not len(k):
        return None
    share = off[k] / (off[k] - off[k + 1])
    met = points[k, axis] + share * (points[k + 1, axis] - points[k, axis])
    at = here.copy()
    at[axis] = met[np.argmin(np.abs(met - here[axis]))]
    return at


# Half width of the map of an anchor, in lever lengths: the paper's box.
_REACH = 1.06
_WORDS = {
    "p.x": "x of p",
    "p.y": "y of p",
    "q.x": "x of q",
    "q.y": "y of q",
    "limit": "largest angle",
}


def answer_parameters(design: PageDesign, ask: Ask) -> View:
    """All numeric parameters, with value and range in the unit of the page."""
    ask.close()
    chain = design.chain
    return View(
        {"parameters": [_parameter_record(chain, p) for p in parameters(chain) if not p.is_anchor]}
    )


def _parameter_record(chain: Chain, parameter: Parameter) -> dict[str, Any]:
    unit, factor = unit_of(parameter)
    value = float(parameter.value(chain))  # type: ignore[arg-type]
    low, high = (end * factor for end in _range(chain, parameter, value))
    if parameter.cell is not None and "." in parameter.part:
        low, high = math.floor(low), math.ceil(high)
    else:
        low, high = (float(f"{end:.3g}") for end in (low, high))
    of = "" if parameter.cell is None else chain.names[parameter.cell]
    word = _WORDS.get(parameter.part, parameter.part.replace("_", " "))
    return {
        "key": key_of(parameter),
        "cell": parameter.cell,
        "part": parameter.part,
        "label": f"{word} of {of}" if of else word,
        "unit": unit,
        "value": value * factor if math.isfinite(value) else None,
        "range": [low, high],
    }


def _range(chain: Chain, parameter: Parameter, value: float) -> tuple[float, float]:
    if parameter.cell is None:
        travel = max(cell.full_travel for cell in chain.cells)
        usual = max(map(_force, chain.cells)) / travel
        if 0 < value < math.inf:
            return value / 5, value * 5
        return 0.0 if value == 0 else usual / 10, usual * 10  # a given force, or a given stroke
    cell, part = chain.cells[parameter.cell], parameter.part
    if isinstance(cell, Cell) and "." in part:
        return value - _REACH * cell.lever, value + _REACH * cell.lever
    if part == "friction":
        return 0.0, max(2 * value, _force(cell) / 2)
    if part == "limit":
        return 0.6 * value, min(1.4 * value, math.radians(85))
    if part in ("force_scale", "travel_scale"):
        return value / 2, value * 2
    if not value and isinstance(cell, Cell):  # a band without a rest length
        return 0.0, cell.lever
    return value / 2, value * 1.5


def _force(cell: Any) -> float:
    if isinstance(cell, Cell):
        return max(abs(cell.force_0), abs(cell.force_1))
    return cell.largest_force


def answer_map(design: PageDesign, ask: Ask) -> View:
    """An image of indices into `sequences`, rows from low to high y.

    If some positions have to be simulated one by one, there is no image and `aside` is true: panel
    `map_followed` computes it.
    """
    plane = Plane.asked(design.chain, ask)
    wide, high = pixels(ask)
    ask.close()
    try:
        header, blocks = plane.painted(wide, high, unproved)
    except Unproved:
        return View({"aside": True})
    return View({"aside": False, **header}, blocks)


# Each image is shown as soon as it is complete; a position takes about a millisecond.
_COARSE = 16, 8, 5, 2, 1
_MOST_FOLLOWED = 2000
# Nodes per axis from which boundaries are bisected.
_SEARCH = 21

Known = tuple[dict[str, Any], Blocks, tuple[Boundary, ...]]
# Result of the last plane: while the design moves on it, nothing is recomputed.
_known: dict[Plane, Known] = {}


def answer_map_followed(design: PageDesign, ask: Ask) -> View:
    """As panels `map` and `border` together, with `coarse` by `coarse` pixels as one.

    The coarsest image comes first, and curves with the last.
    """
    plane = Plane.asked(design.chain, ask)
    wide, high = pixels(ask)
    ask.close()
    if plane not in _known:
        known = _found(plane, wide, high, ask)
        _known.clear()
        _known[plane] = known
    header, blocks, curves = _known[plane]
    header_of_curves, lines = plane.boundary_view(curves)
    return View({**header, **header_of_curves}, blocks | lines)


def _found(plane: Plane, wide: int, high: int, ask: Ask) -> Known:
    def few(done: float, total: float) -> None:
        if total > _MOST_FOLLOWED:
            raise Unproved(f"{total:.0f} positions have to be simulated one by one.")
        ask.report(done, max(total, 1))

    header: dict[str, Any] = {}
    blocks: Blocks = {}
    for coarse in _COARSE:
        size = max(2, -(-wide // coarse)), max(2, -(-high // coarse))
        try:
            sequences, blocks = plane.painted(*size, few)
        except Unproved:
            break
        header = {"coarse": coarse, **sequences}
        ask.show(View({**header, **plane.boundary_view(())[0]}, blocks))
    return header, blocks, plane.curves(_SEARCH, ask.report)


def answer_border(design: PageDesign, ask: Ask) -> View:
    """Curves in units of the page, position of the design, and the nearest other sequence.

    If `aside` is true, some curves have no closed form, and panel `map_followed` searches them.
    """
    plane = Plane.asked(design.chain, ask)
    ask.close()
    try:
        curves, aside = _proved_curves(plane), False
    except Unproved:
        curves, aside = (), True
    header, blocks = plane.boundary_view(curves)
    return View({"aside": aside, **header}, blocks)


def answer_jump(design: PageDesign, ask: Ask) -> View:
    """Table `chain` of the design file for the two values `at`, in units of the page."""
    chain = design.chain
    both = [asked_parameter(chain, ask, letter) for letter in "xy"]
    at = ask.numbers("at", 2, -_FARTHEST, _FARTHEST, least_many=2)
    ask.close()
    for parameter, value in zip(both, at, strict=True):
        chain = parameter.changed(chain, value / unit_of(parameter)[1])
    return View({"chain": files.tables_in(files.dumps(chain))["chain"]})
