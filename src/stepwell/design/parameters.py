"""Parameters of a chain by name: value, unit, and the chain with another value."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Measure, Vec2, join_first, nearest_word
from stepwell.mechanism import Band, Cell, Chain, Element, Slip, geometry, sizes
from stepwell.statics import Designs, batch, drive_weights

# Action for values that are intended.
WAY = "If the value is intended, set unusual=True for a cell of the chain."

_ACTUATOR = "actuator_stiffness"
# Parameters of a cell and of an element with their units; friction has that of a force.
_OF_CELL = dict.fromkeys(("p", "q", "p.x", "p.y", "q.x", "q.y"), "m")
_OF_CELL |= {"stiffness": "N/m", "rest_length": "m", "lever": "m", "limit": "rad", "friction": ""}
_OF_ELEMENT = {"force_scale": "1", "travel_scale": "1", "friction": ""}
_PARTS = _OF_CELL | _OF_ELEMENT
ANCHORS = ("p", "q")
_AXES = ("x", "y")
# Number of cells named in a message.
_NAMED = 8


@dataclass(frozen=True, slots=True, eq=False)
class Parameter(ByValue):
    """One parameter of a chain.

    If a cell has several bands, the value is that of the first one, and another value changes all:
    anchors are shifted alike, stiffnesses and rest lengths scaled alike.

    Attributes:
        name: such as "outer.q.x" or "actuator_stiffness".
        cell: index of the cell in chain.cells; None for the actuator.
        part: such as "p", "q.x", "stiffness" or "force_scale".
        measure: kind of travel and force of the chain.
    """

    name: str
    cell: int | None
    part: str
    measure: Measure = Measure.TRAVEL

    @property
    def unit(self) -> str:
        """SI unit of the parameter."""
        if self.cell is None:
            return self.measure.stiffness_unit
        return _PARTS[self.part] or self.measure.force_unit

    @property
    def is_anchor(self) -> bool:
        """Whether its value is a place (x, y) and not a number."""
        return self.part in ANCHORS

    def value(self, chain: Chain) -> float | Vec2:
        """Value of the parameter in a chain, in SI."""
        if self.cell is None:
            return chain.actuator_stiffness
        cell: Any = chain.cells[self.cell]
        anchor, _, axis = self.part.partition(".")
        if anchor in ANCHORS:
            place: Vec2 = getattr(cell.bands[0], anchor)
            return place[_AXES.index(axis)] if axis else place
        owner = cell.bands[0] if self.part in ("stiffness", "rest_length") else cell
        return float(getattr(owner, self.part))

    def changed(self, chain: Chain, value: float | Vec2) -> Chain:
        """The chain with another value of this parameter, in SI; ValueError if not allowed."""
        if self.cell is None:
            return replace(chain, actuator_stiffness=_number(self, value))
        cells = list(chain.cells)
        cells[self.cell] = replace(cells[self.cell], **self._in_cell(cells[self.cell], value))
        return replace(chain, cells=tuple(cells))

    def put(self, designs: Designs, chain: Chain, values: Floats) -> None:
        """Write other values (m,) in SI, of an anchor (m, 2), into m designs of a chain of lever
        cells.

        The same designs as `changed` makes one by one.
        """
        if self.cell is None:
            chains = (replace(chain, actuator_stiffness=value) for value in values.tolist())
            designs.drives[:] = [*map(drive_weights, chains)]
            return
        cell = chain.levers[self.cell]
        first = int(designs.laws.band_first[self.cell])
        cells = designs.cells[:, self.cell]
        bands = designs.bands[:, first : first + len(cell.bands)]
        if self.part.partition(".")[0] in ANCHORS:
            self._put_anchors(bands, cell.bands, values)
        elif self.part in ("stiffness", "rest_length"):
            column = 2 + (self.part == "rest_length")
            old = [float(getattr(band, self.part)) for band in cell.bands]
            # Bands that cannot be scaled make no design; building it raises the error.
            ratio = values / old[0] if old[0] else np.full(len(values), np.nan)
            for k, own in enumerate(old):
                bands[:, k, column] = values if own == old[0] else own * ratio
        elif self.part == "limit":
            cells[:, batch.SIN_LIMIT] = [math.sin(value) for value in values.tolist()]
        else:
            cells[:, batch.FRICTION if self.part == "friction" else batch.LEVER] = values
        sine = cells[:, batch.SIN_LIMIT]
        cells[:, batch.FULL] = geometry.travel_of(sine, cells[:, batch.LEVER], sine)

    def _put_anchors(self, out: Floats, bands: tuple[Band, ...], values: Floats) -> None:
        """Write q - p [m] of a cell's bands, out (m, bands, ...), by values of an anchor."""
        anchor, _, axis = self.part.partition(".")
        for column in range(2) if not axis else [_AXES.index(axis)]:
            to = values if axis else values[:, column]
            was = getattr(bands[0], anchor)[column]
            for k, band in enumerate(bands):
                spot = getattr(band, anchor)[column]
                here = to if spot == was else spot + (to - was)
                p, q = (here if end == anchor else getattr(band, end)[column] for end in "pq")
                out[:, k, column] = q - p

    def displaced(self, chain: Chain, move: ArrayLike) -> Chain:
        """The chain with this anchor moved by (dx, dy) [m]."""
        place = self.value(chain) + np.asarray(move, float)
        return self.changed(chain, (float(place[0]), float(place[1])))

    def scaled(self, chain: Chain, ratio: float) -> Chain:
        """The chain with this number multiplied by `ratio`."""
        return self.changed(chain, float(self.value(chain)) * ratio)  # type: ignore[arg-type]

    def values(self, values: ArrayLike, least: int) -> Floats:
        """`values` as `least` or more rising floats; raises ValueError otherwise."""
        array, name = np.array(values, float), self.name
        if self.is_anchor:
            raise InputError(f"{name} is a point, not a number: use {name}.x or {name}.y.")
        if array.ndim != 1 or len(array) < least or not np.all(np.isfinite(array)):
            raise InputError(
                f"values of {name} have shape {array.shape}: must be {least} or more finite "
                f"numbers in a row [{self.unit}], for example from np.linspace or np.geomspace."
            )
        if np.any(np.diff(array) <= 0):
            raise InputError(
                f"values of {name} must rise [{self.unit}]: sort them and remove repeats."
            )
        return array

    def slips(self, chain: Chain, value: float) -> tuple[Slip, ...]:
        """Probable unit errors: a value far above the sizes of the chain."""
        if self.cell is None or chain.unusual:
            return ()
        cell = chain.cells[self.cell]
        if isinstance(cell, Element):
            return ()
        if self.part == "friction":
            return tuple(sizes.force(self.name, value, sizes.own_force(cell, cell.lever)))
        return tuple(sizes.far(self.name, value, cell.lever)) if self.unit == "m" else ()

    def _in_cell(self, cell: Any, value: float | Vec2) -> dict[str, Any]:
        anchor, _, axis = self.part.partition(".")
        if self.is_anchor:
            new = _place(self, value)
            return {"band": [_shifted(band, anchor, cell.bands[0], new) for band in cell.bands]}
        number = _number(self, value)
        if axis:
            x, y = getattr(cell.bands[0], anchor)
            new = (number, y) if axis == "x" else (x, number)
            return {"band": [_shifted(band, anchor, cell.bands[0], new) for band in cell.bands]}
        if self.part in ("stiffness", "rest_length"):
            return {"band": _scaled(cell.bands, self, number)}
        return {self.part: number}


def parameter(chain: Chain, name: str) -> Parameter:
    """The parameter of a name; ValueError with the nearest name if there is none.

    Args:
        chain: the chain of the parameter.
        name: "<cell>.p", "<cell>.q", "<cell>.q.x" and the like, "<cell>.stiffness",
            "<cell>.rest_length", "<cell>.lever", "<cell>.limit", "<cell>.friction"; of an element
            "<element>.force_scale", "<element>.travel_scale", "<element>.friction"; where <cell>
            is a name in chain.names or a number, 1 for the innermost; or "actuator_stiffness".
    """
    if name == _ACTUATOR:
        return Parameter(_ACTUATOR, None, _ACTUATOR, chain.measure)
    names = list(chain.names)
    # A cell's own name comes before a number that reads the same.
    for part in sorted(_PARTS, key=len, reverse=True):
        label = str(name).removesuffix(f".{part}")
        if label == name:
            continue
        if names.count(label) > 1:
            raise InputError(
                f"parameter {name!r}: {names.count(label)} cells are called {label!r}; take a "
                f"number, 1 for the innermost: '{names.index(label) + 1}.{part}'."
            )
        if label in names:
            return _asked(chain, name, names.index(label), part)
        if label.isdecimal() and 1 <= int(label) <= len(names):
            return _asked(chain, name, int(label) - 1, part)
    numbered = (f"{i}.{part}" for i, cell in enumerate(chain.cells, 1) for part in _parts(cell))
    near = nearest_word(str(name), [*(one.name for one in parameters(chain)), *numbered])
    guess = f" Did you mean {near!r}?" if near else ""
    cells = join_first([f"{text!r} or {i}" for i, text in enumerate(names, 1)], _NAMED)
    raise InputError(
        f"parameter {name!r}: the chain has none of that name.{guess} It must be {_ACTUATOR!r} or "
        f"'<cell>.<what>' with <cell> one of {cells}, and <what> one of "
        f"{', '.join(dict.fromkeys(part for cell in chain.cells for part in _parts(cell)))}."
    )


def parameters(chain: Chain) -> tuple[Parameter, ...]:
    """Every parameter of a chain, the actuator's last."""
    of_cells = (
        of_cell(chain, i, part) for i, cell in enumerate(chain.cells) for part in _parts(cell)
    )
    return (*of_cells, Parameter(_ACTUATOR, None, _ACTUATOR, chain.measure))


def of_cell(chain: Chain, cell: int, part: str) -> Parameter:
    """The parameter of a cell: "p", "q.x", "stiffness" and so on."""
    names = chain.names
    label = names[cell] if names.count(names[cell]) == 1 else str(cell + 1)
    return Parameter(f"{label}.{part}", cell, part, chain.measure)


def _parts(cell: Cell | Element) -> tuple[str, ...]:
    return tuple(_OF_ELEMENT if isinstance(cell, Element) else _OF_CELL)


def _asked(chain: Chain, name: str, cell: int, part: str) -> Parameter:
    has = _parts(chain.cells[cell])
    if part in has:
        return of_cell(chain, cell, part)
    is_element = isinstance(chain.cells[cell], Element)
    one = "an element, a force law without levers or bands" if is_element else "no element"
    raise InputError(f"parameter {name!r}: {chain.names[cell]} is {one}, and has {', '.join(has)}.")


def _number(of: Parameter, value: float | Vec2) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = math.nan
    if math.isnan(number):
        text = value if isinstance(value, float) else repr(value)
        raise InputError(f"{of.name} = {text}: must be a number [{of.unit}].")
    return number


def _place(of: Parameter, value: float | Vec2) -> Vec2:
    try:
        x, y = value  # type: ignore[misc]
        return float(x), float(y)
    except (TypeError, ValueError):
        raise InputError(f"{of.name} = {value!r}: must be a point (x, y) [m].") from None


def _shifted(band: Band, anchor: str, first: Band, new: Vec2) -> Band:
    moves = zip(getattr(band, anchor), getattr(first, anchor), new, strict=True)
    # The first band gets the new place exactly, without rounding.
    x, y = (there if spot == was else spot + (there - was) for spot, was, there in moves)
    return replace(band, **{anchor: (x, y)})


def _scaled(bands: tuple[Band, ...], of: Parameter, value: float) -> list[Band]:
    olds = [float(getattr(band, of.part)) for band in bands]
    if olds[0] == 0 and any(olds):
        raise InputError(
            f"{of.name} = {value}: the first band has {of.part} 0, so the others cannot be scaled "
            f"with it: put a band with another value first."
        )
    news = [value if old == olds[0] else old * (value / olds[0]) for old in olds]
    return [replace(band, **{of.part: new}) for band, new in zip(bands, news, strict=True)]
