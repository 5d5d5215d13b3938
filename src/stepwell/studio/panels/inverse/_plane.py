"""The plane of two parameters of a chain in units of the bench: places, pictures, curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from stepwell.base import Floats, InputError, Quantity, nearest_word, told_in
from stepwell.design import (
    Boundary,
    BoundaryKind,
    Parameter,
    parameter_boundaries,
    parameter_map,
    parameters,
)
from stepwell.mechanism import Chain
from stepwell.studio.wire import Ask

_FARTHEST = 1e6
_MOST_PIXELS = 1000
_PERCENT = "%", 100.0
Blocks = dict[str, np.ndarray[Any, Any]]
Progress = Callable[[float, float], None]


class Unproved(InputError):
    """No closed form tells what the chain does everywhere on the plane."""


@dataclass(frozen=True)
class Axis:
    """One of the two parameters, and how far its values reach, in SI."""

    parameter: Parameter
    low: float
    high: float

    def middles(self, count: int) -> Floats:
        """(count,) the middle of every pixel, in SI."""
        edges = np.linspace(self.low, self.high, count + 1)
        return (edges[1:] + edges[:-1]) / 2


@dataclass(frozen=True)
class Plane:
    """A chain without its place on the plane, so that designs that only differ there are equal.

    Attributes:
        chain: at some place of the plane.
        axes: of x and of y.
        here: where the design is, in SI.
    """

    chain: Chain
    axes: tuple[Axis, Axis]
    here: tuple[float, float]

    @classmethod
    def asked(cls, chain: Chain, ask: Ask) -> Plane:
        """The plane of the keys x, y, x_range and y_range.

        Raises:
            ValueError: no such parameter, or no such range.
        """
        axes = _axis(chain, ask, "x"), _axis(chain, ask, "y")
        here = tuple(float(axis.parameter.value(chain)) for axis in axes)  # type: ignore[arg-type]
        try:
            for axis in axes:
                chain = axis.parameter.changed(chain, axis.low)
        except ValueError:  # no design can be there; then this one has to stand for all
            pass
        return cls(chain, axes, (here[0], here[1]))

    def painted(self, wide: int, high: int, progress: Progress) -> tuple[dict[str, Any], Blocks]:
        """The sequences that are on the plane, and the image (high, wide) of numbers into them."""
        sized = zip(self.axes, (wide, high), strict=True)
        x, y = ((axis.parameter, axis.middles(count)) for axis, count in sized)
        found = parameter_map(self.chain, x, y, progress=progress)
        flags = found.sequence.attrs
        words = flags["flag_meanings"].split(" ")
        numbers = np.asarray(flags["flag_values"])
        codes, image, counts = np.unique(
            found.sequence.values, return_inverse=True, return_counts=True
        )
        order = np.argsort(numbers)
        texts = [words[order[k]] for k in np.searchsorted(numbers, codes, sorter=order)]
        shares = (counts / counts.sum()).tolist()
        header = {"sequences": texts, "shares": shares}
        blocks: Blocks = {"image": image.reshape(high, wide).astype(np.int32)}
        for letter, (parameter, values) in (("x", x), ("y", y)):
            blocks[letter] = values * unit_of(parameter)[1]
        return header, blocks

    def curves(self, search: int, progress: Progress) -> tuple[Boundary, ...]:
        """The boundaries on the plane, looked for on `search` nodes each way where not exact."""
        x, y = ((axis.parameter, np.array([axis.low, axis.high])) for axis in self.axes)
        return parameter_boundaries(self.chain, x, y, search=search, progress=progress)

    def proved_curves(self) -> tuple[Boundary, ...]:
        """The boundaries where closed forms tell all of them.

        Raises:
            Unproved: they do not.
        """
        # Where the design is does not change the curves: while it moves they are known.
        return _proved_curves(replace(self, here=(0.0, 0.0)))

    def told(self, curves: Iterable[Boundary]) -> tuple[dict[str, Any], Blocks]:
        """The curves in units of the bench, and how far the design is from the nearest."""
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
        header = {
            "here": [value if math.isfinite(value) else None for value in here.tolist()],
            "units": [x, y],
            "boundaries": listed,
            "nearest": ways,
        }
        return header, blocks


def pixels(ask: Ask) -> tuple[int, int]:
    """How many the image has, across and up; fewer where each stands for `coarse` by `coarse`."""
    wide, high = (int(n) for n in ask.numbers("pixels", 2, 2, _MOST_PIXELS, least_many=2))
    coarse = ask.whole("coarse", 1, 64, 1)
    return max(2, -(-wide // coarse)), max(2, -(-high // coarse))


def asked_parameter(chain: Chain, ask: Ask, letter: str) -> Parameter:
    """The parameter that key x or y names, as panel `parameters` lists them.

    Raises:
        ValueError: no such parameter.
    """
    known = {key_of(one): one for one in parameters(chain) if not one.is_anchor}
    key = ask.text(letter, 60)
    if key not in known:
        near = nearest_word(key, list(known))
        advice = f"Did you mean {near!r}?" if near else "Panel `parameters` lists them."
        raise InputError(f"ask.{letter} = {key!r}: no such parameter of this chain. {advice}")
    return known[key]


def key_of(parameter: Parameter) -> str:
    """By which a parameter is asked for; cells by number from 1, since names may repeat."""
    return parameter.name if parameter.cell is None else f"{parameter.cell + 1}.{parameter.part}"


def unit_of(parameter: Parameter) -> tuple[str, float]:
    """In which a parameter is told, and how many of it make one in SI."""
    told, factor = told_in(parameter.unit)
    return _PERCENT if told == "1" else (Quantity("", told).sign, factor)


def unproved(_done: float, total: float) -> None:
    """Refuse to follow a single place.

    Raises:
        Unproved: one would have to be followed.
    """
    if total:
        raise Unproved(f"{total:.0f} places have to be followed one by one.")


@lru_cache(maxsize=16)
def _proved_curves(plane: Plane) -> tuple[Boundary, ...]:
    # The grid only finds places where the proof ends, and there this is given up.
    return plane.curves(61, unproved)


def _axis(chain: Chain, ask: Ask, letter: str) -> Axis:
    parameter = asked_parameter(chain, ask, letter)
    factor = unit_of(parameter)[1]
    low, high = ask.pair(f"{letter}_range", -_FARTHEST, _FARTHEST)
    return Axis(parameter, low / factor, high / factor)


def _ways(
    here: Floats, curves: Iterable[Boundary], blocks: Blocks, units: tuple[str, str]
) -> list[dict[str, Any]]:
    """The shortest way to another sequence, or along each axis where they have unlike units."""
    found: dict[str, dict[str, Any]] = {}
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
            if along not in found or far < found[along]["distance"]:
                found[along] = {
                    "along": along,
                    "distance": far,
                    "unit": units["xy".find(along)] if along in "xy" else units[0],
                    "at": at.tolist(),
                    "sequences": list(curve.sequences),
                    "method": curve.method.name.lower(),
                }
    return list(found.values())


def _closest(here: Floats, points: Floats) -> Floats | None:
    """The place of a polyline (m, 2) that is closest."""
    start, way = points[:-1], np.diff(points, axis=0)
    length = np.maximum(np.sum(way**2, axis=1), 1e-300)
    share = np.clip(np.sum((here - start) * way, axis=1) / length, 0.0, 1.0)
    places = start + share[:, None] * way
    if not len(places):
        return None
    return places[np.argmin(np.sum((places - here) ** 2, axis=1))]


def _met(here: Floats, points: Floats, axis: int) -> Floats | None:
    """Where a polyline (m, 2) is met first on a straight way along one axis, if it is."""
    off = points[:, 1 - axis] - here[1 - axis]
    k = np.flatnonzero((off[:-1] <= 0) != (off[1:] <= 0))
    if not len(k):
        return None
    share = off[k] / (off[k] - off[k + 1])
    met = points[k, axis] + share * (points[k + 1, axis] - points[k, axis])
    at = here.copy()
    at[axis] = met[np.argmin(np.abs(met - here[axis]))]
    return at
