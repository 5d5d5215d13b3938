"""The designs of a study, each reproducible from its number alone."""

import csv
import hashlib
import math
import os
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Quantity, check, display_unit, write_csv
from stepwell.design import Draws, Tolerances, parameter
from stepwell.files import key_unit, vary
from stepwell.mechanism import Cell, Chain
from stepwell.robot import Robot

# A nominal design; varied values with the resulting design, or the error.
Subject = Chain | Robot
Made = tuple[Sequence[float], Subject | ValueError]


class How(StrEnum):
    """Distribution of designs in a space."""

    GRID = "grid"
    SOBOL = "sobol"
    LATIN = "latin"
    RANDOM = "random"


# Separator of robot keys with a common value: a comma outside quoted names.
_TOGETHER = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')

# Every process stores all designs of a Latin hypercube.
MOST_LATIN = 10_000_000


@dataclass(frozen=True, eq=False)
class Axis(ByValue):
    """A varied parameter with its range.

    Attributes:
        name: name of the parameter, as in `design.parameter`.
        low, high: range [SI].
        count: number of values on a grid, both ends included; ignored by other distributions.
        log: whether values are spaced in equal ratios.
    """

    name: str
    low: float
    high: float
    count: int = 2
    log: bool = False

    def __post_init__(self):
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise InputError(
                f"{self.name}: from {self.low} to {self.high}: must rise, both finite."
            )
        check.whole(f"{self.name}: count", self.count, 2)
        if self.log and self.low <= 0:
            raise InputError(f"{self.name}: starts at {self.low}: equal ratios need values > 0.")

    def at(self, share: Floats) -> Floats:
        """Values (n,) at fractions (n,) of the range."""
        if self.log:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share


def unit_in(subject: Subject, name: str) -> str:
    """Unit of a stored parameter: SI for a chain, that of the key for a robot.

    Unknown names, or several keys with different units, raise a `ValueError`.
    """
    if isinstance(subject, Chain):
        wanted = parameter(subject, name)
        wanted.values([0.0, 1.0], 2)  # raises an error for a vector parameter
        return wanted.unit or "1"
    units = {key_unit(subject, key) or "1" for key in _keys(name)}
    if len(units) > 1:
        raise InputError(f"{name}: is in {' and in '.join(sorted(units))}: must be in one unit.")
    return units.pop()


def _keys(name: str) -> dict[str, float]:
    """The robot keys with a common value, each with its sign."""
    keys = _TOGETHER.split(name)
    return {key.removeprefix("-"): -1.0 if key.startswith("-") else 1.0 for key in keys}


def changed(subject: Subject, names: Sequence[str], values: Sequence[float]) -> Subject:
    """The design with other parameters, in the units of `unit_in`; a `ValueError` if invalid."""
    pairs = zip(names, values, strict=True)
    if isinstance(subject, Robot):
        return vary(subject, {k: sign * v for name, v in pairs for k, sign in _keys(name).items()})
    for name, value in pairs:
        subject = parameter(subject, name).changed(subject, value)
    return subject


@dataclass(frozen=True, eq=False)
class Space(ByValue):
    """Designs in a box of parameters, by number.

    Attributes:
        axes: one or more, with unique names.
        how: their distribution.
        count: number of designs; a grid sets it.
        seed: random seed.

    Raises:
        ValueError: no axis, a repeated name, no designs, or too many for a Latin hypercube.

    Source: Latin hypercube, McKay, Beckman and Conover 1979; Sobol' sequence, scrambled as by Owen
    1995; independent draws by a counter (Philox, Salmon et al. 2011), so each can be drawn alone.
    """

    axes: tuple[Axis, ...]
    how: How = How.GRID
    count: int = 0
    seed: int = 0

    def __post_init__(self):
        object.__setattr__(self, "how", How(self.how))
        names = [axis.name for axis in self.axes]
        if not names or len(set(names)) < len(names):
            raise InputError(f"axes = {names}: must be one or more, each name once.")
        if self.how is How.GRID:
            object.__setattr__(self, "count", math.prod(axis.count for axis in self.axes))
        check.whole("count", self.count, 1)
        if self.how is How.LATIN and self.count > MOST_LATIN:
            raise InputError(
                f"count = {self.count}: a Latin hypercube has at most {MOST_LATIN} designs; use "
                f"{How.SOBOL} for more."
            )
        check.whole("seed", self.seed, 0)

    @property
    def grows(self) -> bool:
        """Whether designs can be added without a change of the others."""
        return self.how in (How.SOBOL, How.RANDOM)

    def names(self, _subject: Subject) -> tuple[str, ...]:
        """Names of the varied parameters."""
        return tuple(axis.name for axis in self.axes)

    def made(self, subject: Subject, first: int, last: int) -> Iterator[Made]:
        """Varied values and design for each number from `first` to before `last`."""
        return _each(subject, self.names(subject), self.points(first, last))

    def points(self, first: int, last: int) -> Floats:
        """Values (last - first, axes) of the designs from number `first` to before `last`."""
        if self.how is How.GRID:
            shape = [axis.count for axis in self.axes]
            at = np.unravel_index(np.arange(first, last), shape)
            shares = np.stack([i / (n - 1) for i, n in zip(at, shape, strict=True)], axis=1)
        else:
            shares = _SHARES[self.how](self, first, last)
        columns = [axis.at(one) for axis, one in zip(self.axes, shares.T, strict=True)]
        return np.stack(columns, axis=1)


def _random(space: Space, first: int, last: int) -> Floats:
    wide, per_step = len(space.axes), 4  # a step of the counter gives four numbers
    start, skipped = divmod(first * wide, per_step)
    numbers = np.random.Generator(np.random.Philox(key=space.seed).advance(start))
    return numbers.random(skipped + (last - first) * wide)[skipped:].reshape(-1, wide)


def _sobol(space: Space, first: int, last: int) -> Floats:
    from scipy.stats import qmc

    points = qmc.Sobol(len(space.axes), rng=np.random.default_rng(space.seed))
    with warnings.catch_warnings():
        # A part of the sequence need not have a power of two of points.
        warnings.simplefilter("ignore", UserWarning)
        return (points.fast_forward(first) if first else points).random(last - first)


def _latin(space: Space, first: int, last: int) -> Floats:
    return _hypercube(len(space.axes), space.count, space.seed)[first:last]


@cache
def _hypercube(wide: int, count: int, seed: int) -> Floats:
    from scipy.stats import qmc

    return qmc.LatinHypercube(wide, rng=np.random.default_rng(seed)).random(count)


_SHARES = {How.RANDOM: _random, How.SOBOL: _sobol, How.LATIN: _latin}


@dataclass(frozen=True, eq=False)
class Workshop(ByValue):
    """Monte Carlo samples of a nominal design, the same as those of `yields`.

    Attributes:
        tolerances: manufacturing tolerances.
        count: number of samples, >= 1 or a `ValueError`.
        seed: random seed, >= 0 or a `ValueError`.
    """

    tolerances: Tolerances
    count: int
    seed: int = 0
    how: ClassVar[str] = "as built"
    grows: ClassVar[bool] = True  # samples can be added without a change of the others

    def __post_init__(self):
        check.whole("count", self.count, 1)
        check.whole("seed", self.seed, 0)

    def names(self, subject: Subject) -> tuple[str, ...]:
        """Names of the parameters with a tolerance, of every cell."""
        chain, names = _chain(subject), list[str]()
        each = self.tolerances.each(len(chain))
        for number, (cell, own) in enumerate(zip(chain.cells, each, strict=True), 1):
            parts = _OF_CELL if isinstance(cell, Cell) else _OF_ELEMENT
            names += [f"{number}.{part}" for part, of in parts if getattr(own, of)]
        return tuple(names)

    def made(self, subject: Subject, first: int, last: int) -> Iterator[Made]:
        """Parameters and chain of each sample from number `first` to before `last`."""
        chain = _chain(subject)
        drawn, wanted = Draws(chain, self.tolerances, self.seed), self.names(subject)
        for number in range(first, last):
            try:
                built = drawn.sample(number)
            except ValueError as error:
                yield [math.nan] * len(wanted), error
                continue
            yield [float(parameter(built, name).value(built)) for name in wanted], built  # type: ignore[arg-type]


# Parameters of a cell and of an element, each with its tolerance.
_OF_CELL = (
    *((part, "anchor") for part in ("p.x", "p.y", "q.x", "q.y")),
    ("stiffness", "stiffness"),
    ("rest_length", "rest_length"),
    ("lever", "lever"),
    ("friction", "friction"),
)
_OF_ELEMENT = (("force_scale", "stiffness"), ("travel_scale", "travel"), ("friction", "friction"))


@dataclass(frozen=True, eq=False)
class ListedDesigns(ByValue):
    """An explicit list of designs.

    Attributes:
        columns: names of the varied parameters.
        rows: (n, columns) values, in SI for a chain, in the keys' units for a robot.

    Raises:
        ValueError: no rows, another shape, a repeated name, or a value that is not finite.
    """

    columns: tuple[str, ...]
    rows: Floats = field(repr=False)
    how: ClassVar[str] = "listed"
    grows: ClassVar[bool] = False
    seed: ClassVar[int] = 0  # not random

    def __post_init__(self):
        object.__setattr__(self, "columns", tuple(self.columns))
        rows = np.array(self.rows, float)
        if not self.columns or len(set(self.columns)) < len(self.columns):
            raise InputError(f"columns = {list(self.columns)}: must be one or more, each once.")
        if rows.ndim != 2 or rows.shape[1] != len(self.columns) or not len(rows):
            raise InputError(
                f"rows have shape {rows.shape}: must be one or more of {len(self.columns)} each."
            )
        if not np.isfinite(rows).all():
            row, column = np.argwhere(~np.isfinite(rows))[0]
            raise InputError(
                f"row {row + 1}, {self.columns[column]} = {rows[row, column]}: must be finite."
            )
        rows.flags.writeable = False
        object.__setattr__(self, "rows", rows)

    @property
    def count(self) -> int:
        """Number of designs."""
        return len(self.rows)

    @property
    def digest(self) -> str:
        """SHA-256 of all numbers."""
        return hashlib.sha256(self.rows.astype("<f8").tobytes()).hexdigest()

    def names(self, _subject: Subject) -> tuple[str, ...]:
        """Names of the varied parameters."""
        return self.columns

    def made(self, subject: Subject, first: int, last: int) -> Iterator[Made]:
        """Varied values and design for each number from `first` to before `last`."""
        return _each(subject, self.columns, self.rows[first:last])

    def to_csv(self, file: str | os.PathLike[str], subject: Subject) -> None:
        """Write the list in the format of `read_table`; an `OSError` if the write fails."""
        columns: list[tuple[Quantity, Any]] = [(Quantity("design"), range(self.count))]
        for name, values in zip(self.columns, self.rows.T, strict=True):
            unit = display_unit(unit_in(subject, name))[0] if isinstance(subject, Chain) else ""
            columns.append((Quantity(name, "" if unit == "1" else unit), values))
        write_csv(file, columns)


class Block(NamedTuple):
    """A block of `size` designs of one space, from number `first` on."""

    subject: Subject
    first: int
    space: Space
    size: int

    @property
    def points(self) -> Floats:
        """(size, axes) values of the varied parameters."""
        return self.space.points(self.first, self.first + self.size)


@dataclass(frozen=True, eq=False)
class IndependentBlocks(ByValue):
    """Independent random designs in blocks; a row of the study summarises one block.

    Attributes:
        axes: one or more, with unique names.
        size: number of designs in a block.
        count: number of blocks.
        seed: random seed.

    Raises:
        ValueError: errors of `Space`, or blocks without designs.
    """

    axes: tuple[Axis, ...]
    size: int
    count: int
    seed: int = 0
    how: ClassVar[str] = "random blocks"
    grows: ClassVar[bool] = True

    def __post_init__(self):
        check.whole("size", self.size, 1)
        check.whole("count", self.count, 1)
        self.space  # noqa: B018  raises an error for an invalid space

    @property
    def space(self) -> Space:
        """All designs as a space."""
        return Space(tuple(self.axes), How.RANDOM, self.size * self.count, self.seed)

    def names(self, _subject: Subject) -> tuple[str, ...]:
        """Empty: a block has no single value of a parameter."""
        return ()

    def made(self, subject: Subject, first: int, last: int) -> Iterator[tuple[list[float], Block]]:
        """The blocks from number `first` to before `last`."""
        space = self.space
        for number in range(first, last):
            yield [], Block(subject, number * self.size, space, self.size)


Designs = Space | Workshop | ListedDesigns | IndependentBlocks


def read_table(file: str | os.PathLike[str], subject: Subject) -> ListedDesigns:
    """The designs listed in a CSV file, one per line.

    Args:
        file: its first line contains names of parameters (see `unit_in`), with or without the
            display unit: outer.q.x_mm, 1.stiffness_N_per_m. A column "design" is ignored; other
            names raise an error.
        subject: the nominal design.

    Raises:
        ValueError: a column that is no parameter of the design, or an entry that is no number.
        OSError: the file cannot be read.
    """
    with Path(file).open(encoding="utf-8-sig", newline="") as lines:
        header, *body = [row for row in csv.reader(lines) if row] or [[]]
    kept = [k for k, head in enumerate(header) if head.strip() != "design"]
    known = [_column(subject, header[k].strip(), str(file)) for k in kept]
    rows = np.empty((len(body), len(kept)))
    for i, line in enumerate(body):
        if len(line) != len(header):
            raise InputError(
                f"{file}: line {i + 2} has {len(line)} cells: must have {len(header)}."
            )
        for j, (k, (name, factor)) in enumerate(zip(kept, known, strict=True)):
            try:
                rows[i, j] = float(line[k]) / factor
            except ValueError:
                raise InputError(
                    f"{file}: line {i + 2}, {name} = {line[k]!r}: must be a number."
                ) from None
    return ListedDesigns(tuple(name for name, _ in known), rows)


def _column(subject: Subject, head: str, file: str) -> tuple[str, float]:
    """What a heading names, and by how much its numbers are larger than what is kept."""
    problem: ValueError | None = None
    for name in (head, *(head[:k] for k in range(len(head)) if head[k] == "_")):
        try:
            unit = unit_in(subject, name)
        except ValueError as error:
            problem = problem or error
            continue
        unit_name, factor = display_unit(unit) if isinstance(subject, Chain) else (unit, 1.0)
        # With the display unit, or without.
        if head in (name, Quantity(name, "" if unit_name == "1" else unit_name).key):
            return name, factor
    raise InputError(f"{file}: column {head!r}: {problem}")


def _each(subject: Subject, names: Sequence[str], points: Floats) -> Iterator[Made]:
    for values in points.tolist():
        try:
            yield values, changed(subject, names, values)
        except ValueError as error:
            yield values, error


def _chain(subject: Any) -> Chain:
    if not isinstance(subject, Chain):
        raise InputError("tolerances need a chain, and this design is a robot.")
    return subject
