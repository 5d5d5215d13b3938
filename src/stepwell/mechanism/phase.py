"""Phases and sheets of the curve of a cell, and limits of its mobility."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, Floats, InputError, check
from stepwell.mechanism.cubics import COLUMNS, end_of, monotone

if TYPE_CHECKING:
    from stepwell.mechanism.cell import Cell
    from stepwell.mechanism.element import Element

# Least and largest mobility of a cell. At larger ratios the flow behind a stiff spring approaches
# rest too slowly to be followed.
MOBILITIES = 1e-2, 1e2


def a_mobility(value: float) -> float:
    """`value` as a float; raises ValueError unless it lies within MOBILITIES."""
    number, (least, most) = check.finite("mobility", value, "1"), MOBILITIES
    if not least <= number <= most:
        raise InputError(
            f"mobility = {number:g}: must be between {check.short(least)} and {check.short(most)}; "
            f"only its ratio to that of the other cells counts."
        )
    return number


def mobilities_of(cells: "Iterable[Cell | Element]") -> Floats:
    """(N,) mobilities of cells, the largest of them 1 [1]."""
    own = np.array([cell.mobility for cell in cells])
    return own / np.max(own)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Phase(ByValue):
    """A connected stretch of a cell's travel that is stable under a prescribed force.

    That is a stretch on which the force does not fall, stops included: the lever cells of Kamp et
    al. 2024 have two, their stops. A digit of a state is the number of a phase.

    Attributes:
        sheet: number of its sheet of the cell's curve; 0 unless the curve folds back.
        low, high: its ends [m]; infinite at an open end of the curve.
        force_low, force_high: critical forces [N]: the cell leaves the phase downwards below
            `force_low` and upwards above `force_high`; infinite where it never does.
    """

    sheet: int
    low: float
    high: float
    force_low: float
    force_high: float


# Sheet of a phase and its ends [m].
Stretch = tuple[int, float, float]


def phase_at(stretches: tuple[Stretch, ...], sheet: int, travel: float) -> str:
    """The digit of the phase of a cell at a travel [m], or - in transit between two phases."""
    for digit, (own, low, high) in enumerate(stretches):
        if own == sheet and low <= travel <= high:
            return str(digit)
    return "-"


# Columns of a table of sheets: its ends; the ends of the curve, without open extensions; its rows;
# the sheets to which it leads from below and above, or -1; and the first sheet of its cell.
SHEET_COLUMNS = 9
LOW, HIGH, CURVE_LOW, CURVE_HIGH, ROWS, ROWS_END, BELOW, ABOVE, FIRST = range(SHEET_COLUMNS)


def before(rows: Floats, force: float) -> Floats:
    """(..., 6) straight rows that lead from a force [N] to where each of (..., 6) rows begins."""
    x0, first, slope, _, _, energy = np.moveaxis(rows, -1, 0)
    way = (first - force) / slope
    out = np.zeros(rows.shape)
    out[..., 0], out[..., 1], out[..., 2] = x0 - way, force, slope
    out[..., COLUMNS - 1] = energy - way * (first + force) / 2.0
    return out


@dataclass(frozen=True, slots=True, eq=False)
class Sheet(ByValue):
    """One stretch of a curve that is stable at a given travel.

    Most elements have one. A curve that folds back in travel has several, and where a sheet ends
    the element jumps, at that travel, to another one.

    Attributes:
        rows: (n, 6) monotone cubic pieces, see `mechanism/cubics`; the last number of each is
            the energy where it begins [J].
        end: travel where the last one ends [m].
        below, above: the sheet on which the element lands from the low end and from the high end;
            None where the whole curve ends.
    """

    rows: Floats
    end: float
    below: int | None = None
    above: int | None = None
    after: Floats = field(init=False, repr=False, compare=False)
    """(1, 6) the row on which it continues straight past its high end."""

    def __post_init__(self):
        force, slope, energy = end_of(self.rows, self.end)
        after = np.array([[self.end, force, slope, 0.0, 0.0, energy]])
        after.setflags(write=False)
        object.__setattr__(self, "after", after)

    @classmethod
    def of(
        cls, rows: Floats, end: float, below: int | None = None, above: int | None = None
    ) -> "Sheet":
        """A sheet of any rows, cut where force and stiffness turn."""
        cut = monotone(rows, end)
        cut.setflags(write=False)
        return cls(cut, float(end), below, above)

    @property
    def begin(self) -> float:
        """Travel where it begins [m]."""
        return float(self.rows[0, 0])

    def scaled(self, force: float, travel: float) -> "Sheet":
        """The same sheet with all forces and all travels times a number."""
        if force == travel == 1.0 and not self.rows.flags.writeable:
            return self
        by = force / travel ** np.arange(4)
        rows = self.rows * np.array([travel, *by, force * travel])
        rows.setflags(write=False)
        return Sheet(rows, self.end * travel, self.below, self.above)

    def extended(self, goes_on: tuple[bool, bool], force: float) -> Floats:
        """Its rows, with straight ones past its low end, from a force [N] on, and its high end."""
        low, high = goes_on
        first = [before(self.rows[:1], force)] if low else []
        return np.concatenate([*first, self.rows, *[self.after] * high])
