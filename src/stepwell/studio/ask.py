"""What the page asks and what it gets: keys with bounds, designs, views."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from stepwell.base import InputError, from_unit, nearest_word, to_unit
from stepwell.design import USUAL, Tolerances
from stepwell.files import DesignError, DesignFile, WrittenProgram, loads_tables
from stepwell.mechanism import Chain
from stepwell.robot import Robot


@dataclass(frozen=True, slots=True)
class View:
    """An answer of a panel.

    Attributes:
        header: what JSON can hold, the unit in the name of every number that has one.
        blocks: arrays of floats or of whole numbers, by name.
    """

    header: Mapping[str, Any]
    blocks: Mapping[str, np.ndarray[Any, Any]] = field(default_factory=dict)


Tell = Callable[[float, float], None]
Show = Callable[[View], None]


def _silent(*_told: object) -> None:
    """Report nothing: the default of `tell` and `show`."""


class Ask:
    """The keys of a request. Each is taken once; `close` refuses what is left.

    Args:
        keys: as JSON has them.
        tell: called with (done, total) by panels that take long.
        show: called by them with what they know already.
        studies: the folder in which the server keeps studies; None where it keeps none.
    """

    def __init__(
        self,
        keys: Mapping[str, Any] | None = None,
        tell: Tell = _silent,
        show: Show = _silent,
        studies: Path | None = None,
    ):
        self._keys = dict(keys or {})
        self._known: list[str] = []
        self.tell, self.show, self.studies = tell, show, studies

    def number(self, key: str, least: float, most: float, default: float | None = None) -> float:
        """A number between two bounds.

        Raises:
            ValueError: another value, or none where there is no default.
        """
        value = self._take(key, default)
        real = isinstance(value, int | float) and not isinstance(value, bool)
        if not real or not isfinite(value) or not least <= value <= most:
            raise InputError(f"ask.{key} = {_shown(value)}: must be from {least:g} to {most:g}.")
        return float(value)

    def whole(self, key: str, least: int, most: int, default: int | None = None) -> int:
        """A whole number between two bounds.

        Raises:
            ValueError: another value, or none where there is no default.
        """
        value = self._take(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
            allowed = f"a whole number from {least} to {most}"
            raise InputError(f"ask.{key} = {_shown(value)}: must be {allowed}.")
        return value

    def text(self, key: str, longest: int, default: str | None = None) -> str:
        """Text of a length.

        Raises:
            ValueError: another value, or none where there is no default.
        """
        value = self._take(key, default)
        if not isinstance(value, str) or len(value) > longest:
            allowed = f"text of at most {longest} letters"
            raise InputError(f"ask.{key} = {_shown(value)}: must be {allowed}.")
        return value

    def tolerances(self) -> Tolerances:
        """Tolerances with the keys anchor_mm and stiffness_percent, both with usual defaults.

        Raises:
            ValueError: a value out of bounds.
        """
        anchor = self.number("anchor_mm", 0.0, 1000.0, to_unit(USUAL.anchor, "mm"))
        usual = to_unit(USUAL.stiffness, "percent")
        stiffness = self.number("stiffness_percent", 0.0, 24.9, usual)
        return Tolerances(anchor=from_unit(anchor, "mm"), stiffness=from_unit(stiffness, "percent"))

    def has(self, key: str) -> bool:
        """Whether the request has the key."""
        self._known.append(key)
        return key in self._keys

    def pair(self, key: str, least: float, most: float) -> tuple[float, float]:
        """Two numbers between two bounds, the first below the second.

        Raises:
            ValueError: another value, or none.
        """
        value = self._take(key, None)
        if isinstance(value, list) and len(value) == 2:
            low, high = (Ask({key: one}).number(key, least, most) for one in value)
            if low < high:
                return low, high
        raise InputError(
            f"ask.{key} = {_shown(value)}: must be two numbers from {least:g} to {most:g}, the "
            f"first below the second."
        )

    def numbers(
        self, key: str, longest: int, least: float, most: float, *, least_many: int = 1
    ) -> list[float]:
        """Numbers of a list, each between two bounds.

        Raises:
            ValueError: another value, too few, too many, or none.
        """
        value = self._take(key, None)
        if not isinstance(value, list) or not least_many <= len(value) <= longest:
            allowed = f"a list of {least_many} to {longest} numbers"
            raise InputError(f"ask.{key} = {_shown(value)}: must be {allowed}.")
        return [Ask({key: one}).number(key, least, most) for one in value]

    def table(self, key: str) -> dict[str, Any]:
        """An object with keys of its own, which who takes it checks.

        Raises:
            ValueError: another value, or none.
        """
        value = self._take(key, None)
        if not isinstance(value, dict):
            raise InputError(f"ask.{key} = {_shown(value)}: must be an object.")
        return value

    def parts(self, key: str, longest: int) -> "list[Ask]":
        """The objects of a list, each to be asked by itself.

        Raises:
            ValueError: another value, too many, or none.
        """
        value = self._take(key, None)
        whole = isinstance(value, list) and 1 <= len(value) <= longest
        if not whole or not all(isinstance(one, dict) for one in value):
            allowed = f"a list of 1 to {longest} objects"
            raise InputError(f"ask.{key} = {_shown(value)}: must be {allowed}.")
        return [Ask(one) for one in value]

    def close(self) -> None:
        """Refuse keys that were not taken.

        Raises:
            ValueError: there are some; the text names the first.
        """
        for key in self._keys:
            near = nearest_word(key, self._known)
            known = ", ".join(dict.fromkeys(self._known)) or "none"
            advice = f"Did you mean {near}?" if near else f"Known here: {known}."
            raise InputError(f"ask.{_shown(key)}: unknown key. {advice}")

    def _take(self, key: str, default: Any) -> Any:
        self._known.append(key)
        return self._keys.pop(key, default)


def _shown(value: Any) -> str:
    text = "nothing" if value is None else ascii(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


# More cannot be seen at once, nor followed while an anchor is dragged.
MOST_CELLS = 64


class PageDesign:
    """What the page shows; nothing is checked before it is asked for.

    Args:
        tables: of a design file, as JSON has them; None where the request has no design.
        leg: of a robot, whose chain is meant where a chain is asked for.
    """

    def __init__(self, tables: dict[str, Any] | None, leg: int = 0):
        self.tables, self.leg = tables, leg

    @cached_property
    def read(self) -> DesignFile:
        """What the tables describe, and the program of a chain.

        Raises:
            ValueError: there is no design, or one that cannot be; the text as for a file.
        """
        if self.tables is None:
            raise InputError("design: is missing; send the tables of a design file.")
        return loads_tables(self.tables)

    @property
    def chain(self) -> Chain:
        """The chain, or that of one leg of the robot.

        Raises:
            ValueError: as `read`, or there is no such leg, or it is longer than the studio can
                show.
        """
        chain = self.read.subject
        if isinstance(chain, Robot):
            if self.leg >= len(chain.legs):
                raise DesignError("design", [f"leg[{self.leg}]: there are {len(chain.legs)}."])
            chain = chain.legs[self.leg].chain
        if len(chain) > MOST_CELLS:
            raise InputError(
                f"chain.cell: {len(chain)} cells: the studio follows at most {MOST_CELLS} while "
                f"they are dragged; `stepwell run` takes more."
            )
        return chain

    @property
    def robot(self) -> Robot:
        """The robot.

        Raises:
            ValueError: as `read`, or it is a chain.
        """
        found = self.read.subject
        if not isinstance(found, Robot):
            raise DesignError("design", ["is a chain, and this needs a robot."])
        return found

    @property
    def program(self) -> WrittenProgram | None:
        """The program of the chain, where the design has one."""
        return self.read.program
