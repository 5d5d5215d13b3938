"""How a file is read: columns, units, signs and the part that is used."""

import os
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from stepwell.base import ByValue, InputError, nearest_word, write_atomic
from stepwell.lab.recordings.columns import FACTORS, spelled

FLIPS = ("none", "stroke", "force", "both")
HALVES = ("loading", "unloading", "both")
FILE = "recording.toml"
_ALLOWED = {"flip": FLIPS, "half": HALVES, "decimal": (".", ",")}
_LEAST = {"cycle": 1, "skip": 0, "sample": 1}
_MOST = 10**9


@dataclass(frozen=True, eq=False)
class Reading(ByValue):
    """How recordings are read; None leaves the choice to the reader, which refuses if unclear.

    Attributes:
        stroke, force: columns, by their number from 1 or their name. Volume and pressure, or angle
            and torque, have the same keys.
        unit: units of both, as in "mm,N".
        flip: signs to turn: "none", "stroke", "force" or "both".
        half: "loading", "unloading" or "both".
        cycle: number of one cycle, from 1.
        skip: lines at the beginning of the file that are not read.
        sample: number of one specimen of a file with several, from 1.
        decimal: "," or ".", if the numbers of the file leave it open.

    Raises:
        ValueError: a value is not allowed.
    """

    stroke: int | str | None = None
    force: int | str | None = None
    unit: str | None = None
    flip: str | None = None
    half: str | None = None
    cycle: int | None = None
    skip: int = 0
    sample: int | None = None
    decimal: str | None = None

    def __post_init__(self):
        for name in ("stroke", "force"):
            object.__setattr__(self, name, _column(name, getattr(self, name)))
        if self.stroke is not None and self.stroke == self.force:
            raise InputError(f"force = {self.force!r}: must be another column than the stroke.")
        for name, allowed in _ALLOWED.items():
            if (value := getattr(self, name)) not in (None, *allowed):
                raise InputError(f"{name} = {value!r}: must be one of {', '.join(allowed)}.")
        for name, least in _LEAST.items():
            value = getattr(self, name)
            if value is not None and not (type(value) is int and least <= value <= _MOST):
                raise InputError(f"{name} = {value!r}: must be a whole number of {least} or more.")
        if self.unit is not None:
            _ = self.units

    @classmethod
    def of(cls, keys: Mapping[str, Any]) -> "Reading":
        """The reading of the keys of a table; raises ValueError for another key."""
        for key in keys:
            if key not in WORDS:
                near = nearest_word(key, WORDS)
                meant = f"Did you mean {near}?" if near else f"Known: {', '.join(WORDS)}."
                raise InputError(f"{key[:40]}: unknown key. {meant}")
        return cls(**keys)

    @classmethod
    def of_toml(cls, text: str) -> "Reading":
        """The reading in the text of a recording.toml; raises ValueError if it is invalid."""
        try:
            return cls.of(tomllib.loads(text))
        except (ValueError, TypeError) as error:
            raise InputError(f"{FILE}: {error}") from None

    @property
    def units(self) -> tuple[str, str] | None:
        """Units of stroke and force, as they are spelled in the table of units."""
        if self.unit is None:
            return None
        parts = [spelled(part) for part in str(self.unit).split(",")]
        travels, forces = (
            [unit for kind in kinds for unit in FACTORS[kind]]
            for kinds in (("stroke", "volume", "angle"), ("force", "pressure", "torque"))
        )
        if len(parts) != 2 or parts[0] not in travels or parts[1] not in forces:
            raise InputError(
                f"unit = {self.unit!r}: must be two units, of stroke and of force, as in mm,N."
            )
        return parts[0], parts[1]

    def given(self) -> dict[str, Any]:
        """The values that differ from the defaults."""
        own = {one.name: getattr(self, one.name) for one in fields(self)}
        return {key: value for key, value in own.items() if value not in (None, 0)}

    def over(self, other: "Reading") -> "Reading":
        """This reading, completed by another one."""
        return replace(other, **self.given())

    @property
    def options(self) -> str:
        """The same as options of a command."""
        return " ".join(f"--{key} {_quoted(str(value))}" for key, value in self.given().items())

    @property
    def toml(self) -> str:
        """The text of a recording.toml with this reading."""
        import tomli_w

        about = (
            "# How the recordings in this folder are read; the keys are options of `stepwell lab`."
        )
        return f"{about}\n{tomli_w.dumps(self.given())}"


WORDS = tuple(one.name for one in fields(Reading))


def _column(name: str, value: Any) -> int | str | None:
    """A column of a key; text of digits is its number. Raises ValueError for another value."""
    if isinstance(value, str) and value.strip().isdecimal() and value.isascii():
        value = int(value)
    if isinstance(value, int) and not isinstance(value, bool):
        is_column = 1 <= value <= _MOST
    else:
        is_column = value is None or (isinstance(value, str) and bool(value.strip()))
    if not is_column:
        raise InputError(f"{name} = {value!r}: must be a column: its number or its name.")
    return value


def _quoted(text: str) -> str:
    return f"'{text}'" if " " in text else text


def of_folder(file: str | os.PathLike[str]) -> Reading:
    """The reading kept in recording.toml in the folder of a file; an empty one without it.

    Raises:
        ValueError: recording.toml is invalid.
    """
    place = Path(file).parent / FILE
    with suppress(FileNotFoundError, NotADirectoryError):
        if place.stat().st_size > 1 << 16:
            raise InputError(f"{FILE}: has more than 65536 bytes: it is no reading.")
        return Reading.of_toml(place.read_text("utf-8", "replace"))
    return Reading()


def save(reading: Reading, folder: str | os.PathLike[str]) -> Path:
    """Write recording.toml, which is used for all recordings in the folder."""
    place = Path(folder) / FILE
    write_atomic(place, reading.toml.encode())
    return place
