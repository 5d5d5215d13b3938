"""Requests of the page and answers: keys with bounds, designs, views."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import InputError, StepwellError, from_unit, nearest_word, to_unit
from stepwell.design import DEFAULT_TOLERANCES, Tolerances
from stepwell.files import DesignError, DesignFile, WrittenProgram, loads_tables
from stepwell.mechanism import Chain
from stepwell.robot import Robot


@dataclass(frozen=True, slots=True)
class View:
    """An answer of a panel: a JSON header with units in names, and arrays by name."""

    header: Mapping[str, Any]
    blocks: Mapping[str, np.ndarray[Any, Any]] = field(default_factory=dict)


Report = Callable[[float, float], None]
Show = Callable[[View], None]


def _silent(*_told: object) -> None: ...


class Ask:
    """The keys of a request, each taken once, or a ValueError; `close` refuses what is left.

    Args:
        keys: of the JSON object.
        report: called with (done, total) by slow panels.
        show: called by slow panels with partial answers.
        studies: the server's folder of studies, or None.
    """

    def __init__(
        self,
        keys: Mapping[str, Any] | None = None,
        report: Report = _silent,
        show: Show = _silent,
        studies: Path | None = None,
    ):
        self._keys = dict(keys or {})
        self._known: list[str] = []
        self.report, self.show, self.studies = report, show, studies

    def number(self, key: str, least: float, most: float, default: float | None = None) -> float:
        """A number between two bounds."""
        value = self._take(key, default)
        real = isinstance(value, int | float) and not isinstance(value, bool)
        if not real or not isfinite(value) or not least <= value <= most:
            raise _wrong(key, value, f"from {least:g} to {most:g}")
        return float(value)

    def whole(self, key: str, least: int, most: int, default: int | None = None) -> int:
        """A whole number between two bounds."""
        value = self._take(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
            raise _wrong(key, value, f"a whole number from {least} to {most}")
        return value

    def switch(self, key: str, *, default: bool) -> bool:
        """True or false."""
        value = self._take(key, default)
        if not isinstance(value, bool):
            raise _wrong(key, value, "true or false")
        return value

    def text(self, key: str, longest: int, default: str | None = None) -> str:
        """Text of a length."""
        value = self._take(key, default)
        if not isinstance(value, str) or len(value) > longest:
            raise _wrong(key, value, f"text of at most {longest} letters")
        return value

    def tolerances(self) -> Tolerances:
        """Tolerances with the keys anchor_mm and stiffness_percent, both with usual defaults."""
        usual = DEFAULT_TOLERANCES.most
        anchor = self.number("anchor_mm", 0.0, 1000.0, to_unit(usual.anchor, "mm"))
        percent = to_unit(usual.stiffness, "percent")
        stiffness = self.number("stiffness_percent", 0.0, 24.9, percent)
        return Tolerances(anchor=from_unit(anchor, "mm"), stiffness=from_unit(stiffness, "percent"))

    def has(self, key: str) -> bool:
        """Whether the request has the key."""
        self._known.append(key)
        return key in self._keys

    def pair(self, key: str, least: float, most: float) -> tuple[float, float]:
        """Two numbers between two bounds, the first below the second."""
        value = self._take(key)
        if isinstance(value, list) and len(value) == 2:
            low, high = (Ask({key: one}).number(key, least, most) for one in value)
            if low < high:
                return low, high
        allowed = f"two numbers from {least:g} to {most:g}, the first below the second"
        raise _wrong(key, value, allowed)

    def numbers(
        self, key: str, longest: int, least: float, most: float, *, least_many: int = 1
    ) -> list[float]:
        """Numbers of a list, each between two bounds."""
        value = self._take(key)
        if not isinstance(value, list) or not least_many <= len(value) <= longest:
            raise _wrong(key, value, f"a list of {least_many} to {longest} numbers")
        return [Ask({key: one}).number(key, least, most) for one in value]

    def wholes(self, key: str, longest: int, least: int, most: int) -> list[int]:
        """Whole numbers of a list, each between two bounds."""
        value = self._take(key)
        if not isinstance(value, list) or not 1 <= len(value) <= longest:
            raise _wrong(key, value, f"a list of 1 to {longest} whole numbers")
        return [Ask({key: one}).whole(key, least, most) for one in value]

    def table(self, key: str) -> dict[str, Any]:
        """An object with keys of its own, which the caller checks."""
        value = self._take(key)
        if not isinstance(value, dict):
            raise _wrong(key, value, "an object")
        return value

    def parts(self, key: str, longest: int) -> "list[Ask]":
        """The objects of a list, as requests."""
        value = self._take(key)
        whole = isinstance(value, list) and 1 <= len(value) <= longest
        if not whole or not all(isinstance(one, dict) for one in value):
            raise _wrong(key, value, f"a list of 1 to {longest} objects")
        return [Ask(one) for one in value]

    def close(self) -> None:
        """Raise an error about the first unused key."""
        for key in self._keys:
            near = nearest_word(key, self._known)
            known = ", ".join(dict.fromkeys(self._known)) or "none"
            advice = f"Did you mean {near}?" if near else f"Known here: {known}."
            raise InputError(f"ask.{_shown(key)}: unknown key. {advice}")

    def _take(self, key: str, default: Any = None) -> Any:
        self._known.append(key)
        return self._keys.pop(key, default)


def _wrong(key: str, value: Any, allowed: str) -> InputError:
    return InputError(f"ask.{key} = {_shown(value)}: must be {allowed}.")


def _shown(value: Any) -> str:
    text = "nothing" if value is None else ascii(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


# Limit for the display, and for updates while an anchor is dragged.
MOST_CELLS = 64


class PageDesign:
    """The design on the page; it is checked at the first access, with a ValueError if invalid.

    Args:
        tables: of a design file, from JSON; None if the request has no design.
        leg: the leg of a robot whose chain is used.
    """

    def __init__(self, tables: dict[str, Any] | None, leg: int = 0):
        self.tables, self.leg = tables, leg

    @cached_property
    def read(self) -> DesignFile:
        """The design file of the tables."""
        if self.tables is None:
            raise InputError("design: is missing; send the tables of a design file.")
        return _read(self.tables)

    @property
    def chain(self) -> Chain:
        """The chain, or the chain of one leg of the robot, within the limit of the studio."""
        chain = self.read.subject
        if isinstance(chain, Robot):
            if self.leg >= len(chain.legs):
                raise DesignError("design", [f"leg[{self.leg}]: there are {len(chain.legs)}."])
            chain = chain.legs[self.leg].chain
        if len(chain) > MOST_CELLS:
            most = f"the limit of the studio is {MOST_CELLS}"
            way = "`stepwell run` accepts more"
            raise InputError(f"chain.cell: {len(chain)} cells: {most}; {way}.")
        return chain

    @property
    def robot(self) -> Robot:
        """The robot; a chain is refused."""
        if isinstance(subject := self.read.subject, Robot):
            return subject
        raise DesignError("design", ["is a chain, and this needs a robot."])

    @property
    def program(self) -> WrittenProgram | None:
        """The program of the design, if any."""
        return self.read.program


class _Read(NamedTuple):
    """The tables of a design as texts, its cells and all else, and its file."""

    cells: list[str]
    rest: str
    file: DesignFile


_last: _Read | None = None


def _read(tables: dict[str, Any]) -> DesignFile:
    """The design file of tables; of a chain only the cells that the last one had not are read."""
    global _last
    last, (cells, rest) = _last, _parted(tables)
    # Texts, because 1, 1.0 and True are equal, and only two of them are numbers.
    texts, around = [repr(cell) for cell in cells], repr(rest)
    file = None
    if last is not None and last.rest == around and len(last.cells) == len(cells):
        places = [
            i for i, (old, new) in enumerate(zip(last.cells, texts, strict=True)) if old != new
        ]
        file = _changed(last.file, cells, places, rest)
    file = file or loads_tables(tables)
    _last = _Read(texts, around, file)
    return file


def _parted(tables: dict[str, Any]) -> tuple[list[Any], dict[str, Any]]:
    """The cells of a chain, and the tables without them."""
    chain: Any = tables.get("chain")
    cells: Any = chain.get("cell") if isinstance(chain, dict) else None
    if not isinstance(cells, list):
        return [], tables
    return cells, {**tables, "chain": {**chain, "cell": []}}


def _changed(
    last: DesignFile, cells: list[Any], places: list[int], rest: dict[str, Any]
) -> DesignFile | None:
    """The last chain with the cells of some places; None if all of it must be read."""
    if not places:
        return last
    if not isinstance(last.value, Chain) or last.program is not None:
        return None
    chain = {**rest["chain"], "cell": [cells[i] for i in places]}
    try:
        few = loads_tables({**rest, "chain": chain}).subject
        assert isinstance(few, Chain)
        new = dict(zip(places, few.cells, strict=True))
        made = tuple(new.get(i, cell) for i, cell in enumerate(last.value.cells))
        return replace(last, subject=replace(last.value, cells=made))
    except StepwellError:  # whose messages are to name the cells of the whole chain
        return None
