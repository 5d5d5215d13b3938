"""The smallest change of an anchor or a number with which a chain reaches a target."""

import math
import os
from collections.abc import Sequence as Sized
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from stepwell import base, concave
from stepwell.design.margins import nearest, numbers, search
from stepwell.design.orders import checked_cycle
from stepwell.design.parameters import Parameter, parameter
from stepwell.design.plane import Method
from stepwell.design.tolerances.draws import refuse_reach
from stepwell.mechanism import Cell, Chain, Element, geometry
from stepwell.sequences import Sequence, cycle

if TYPE_CHECKING:
    import xarray


_ANGLES = 1025  # over the travel; the relative error of the largest force is 1e-6
_POSITIONS = 41


@dataclass(frozen=True, eq=False)
class Resistance(base.ByValue):
    """Force of the bands against a straight displacement of an anchor.

    A band of tension T pulls p towards q and q towards p. The force is its component along the
    displacement, positive if it resists and negative if it helps. Weight, friction and inertia of
    the pushing part are neglected.

    Attributes:
        fraction: (m,) fraction of the displacement, 0 to 1.
        force_0, force_1: (m,) at state 0 and at state 1 of the cell [N].
        peak: (m,) the largest over the cell's travel [N].
        work_0, work_1: work of the whole displacement at state 0 and at state 1 [J].
    """

    fraction: base.Floats
    force_0: base.Floats
    force_1: base.Floats
    peak: base.Floats
    work_0: float
    work_1: float

    @classmethod
    def of(cls, cell: Cell, anchor: str, displacement: base.Vec2) -> "Resistance":
        """Moving the anchors "p" or "q" of all bands of a cell by `displacement` (x, y) [m]."""
        fraction = np.linspace(0.0, 1.0, _POSITIONS)
        theta = np.linspace(-cell.limit, cell.limit, _ANGLES)
        sin, cos = np.sin(theta), np.cos(theta)
        force, work = np.zeros((_POSITIONS, _ANGLES)), np.zeros(2)
        # Moving p is moving d = q - p the other way.
        change = (1 if anchor == "q" else -1) * np.array(displacement)
        away = np.linalg.norm(change) or 1.0
        for band in cell.bands:
            dx, dy = np.array(band.d)[:, None, None] + change[:, None, None] * fraction[:, None]
            length = geometry.band_length(sin, cos, dx, dy, cell.lever)
            x, y = geometry.band_direction(sin, cos, length, dx, dy, cell.lever)
            force += band.tension(length) * (x * change[0] + y * change[1]) / away
            before, after = band.energy(length[[0, -1]][:, [0, -1]])
            work += after - before
        peak = np.max(force, axis=1)
        return cls(fraction, force[:, 0], force[:, -1], peak, float(work[0]), float(work[1]))

    @classmethod
    def nowhere(cls) -> "Resistance":
        """The resistance without a displacement."""
        none = np.empty(0)
        return cls(none, none, none, none, float("nan"), float("nan"))

    @property
    def largest(self) -> float:
        """Largest force [N] at any place of the path and any travel; NaN without a path."""
        return float(np.max(self.peak)) if len(self.peak) else float("nan")

    def __str__(self):
        if not len(self.peak):
            return "no displacement"
        work_0, work_1 = base.to_unit(self.work_0, "mJ"), base.to_unit(self.work_1, "mJ")
        work = f"work {work_0:.4g} mJ at state 0, {work_1:.4g} mJ at state 1"
        if self.largest > 0:
            return f"push with up to {self.largest:.4g} N; {work}"
        return f"the band itself pulls it there; {work}"

    def __repr__(self):
        return f"Resistance({self})"


_DOC = "force against the displacement"
# The path of the anchor, at every fraction of it.
WAY: base.Schema = (
    base.Quantity("fraction", read="resistance.fraction"),
    base.Quantity("x", "mm", "x", lambda change: change.along(0), doc="displacement along x"),
    base.Quantity("y", "mm", "y", lambda change: change.along(1), doc="displacement along y"),
    base.Quantity("force_0", "N", "at state 0", "resistance.force_0", doc=f"{_DOC} at state 0"),
    base.Quantity("force_1", "N", "at state 1", "resistance.force_1", doc=f"{_DOC} at state 1"),
    base.Quantity("peak", "N", "largest", "resistance.peak", doc=f"largest {_DOC} over the travel"),
)


@dataclass(frozen=True, eq=False)
class Reprogramming(base.ByValue):
    """The smallest displacement of one anchor with which a chain reaches a target.

    Or the smallest change of one number of an element: then `displacement`, `distance` and `place`
    are numbers in its unit, without a resistance.

    Attributes:
        chain: the nominal design.
        target: the target sequence; None for any other than now.
        by: the anchor, such as "inner.p", or the number, such as "dome.force_scale".
        displacement: (dx, dy) of the anchor [m]; NaN if there is none within reach, zero if the
            chain already reaches the target.
        distance: its length [m]; infinite if there is none within reach.
        reach: largest displacement that was tried [m]; infinite for a number.
        chain_after: the design slightly past the change, which reaches the target; else None.
        before, after: the simulated sequences before and slightly past the change; `after` is
            empty if there is none.
        method: exact, or a search.
        resolution: resolution of the search; empty if nothing was searched.
    """

    chain: Chain = field(repr=False)
    target: str | None
    by: str
    displacement: base.Vec2 | float
    distance: float
    reach: float
    chain_after: Chain | None = field(repr=False)
    before: str
    after: str
    method: Method
    resolution: str

    @property
    def cell(self) -> int:
        """The cell of the anchor, 0 the innermost."""
        number = parameter(self.chain, self.by).cell
        assert number is not None
        return number

    @property
    def anchor(self) -> str:
        """The anchor, "p" on the inner block or "q" on the outer one; or the number."""
        return parameter(self.chain, self.by).part

    @property
    def place(self) -> base.Vec2 | float:
        """New position of the anchor (of the cell's first band) [m]; NaN if there is none."""
        now = parameter(self.chain, self.by).value(self.chain)
        if isinstance(now, tuple) or isinstance(self.displacement, tuple):
            return self.anchor_at
        return now + self.displacement

    @property
    def move(self) -> base.Vec2:
        """`displacement` of an anchor, (dx, dy) [m]; NaN for a number, which has no direction."""
        nowhere = math.nan, math.nan
        return self.displacement if isinstance(self.displacement, tuple) else nowhere

    @property
    def anchor_at(self) -> base.Vec2:
        """`place` of an anchor, (x, y) [m]; NaN for a number."""
        now = parameter(self.chain, self.by).value(self.chain)
        x, y = now if isinstance(now, tuple) else (math.nan, math.nan)
        return x + self.move[0], y + self.move[1]

    @property
    def unit(self) -> str:
        """SI unit of `displacement`, `distance` and `place`."""
        return parameter(self.chain, self.by).unit

    @cached_property
    def resistance(self) -> Resistance:
        """The force of the cell's bands against the displacement along its path."""
        cell, move = self.chain.cells[self.cell], self.displacement
        if math.isinf(self.distance) or isinstance(cell, Element) or not isinstance(move, tuple):
            return Resistance.nowhere()
        return Resistance.of(cell, self.anchor, move)

    def along(self, axis: int) -> base.Floats:
        """Displacement of the anchor along x (0) or y (1) at every fraction of the path [m]."""
        return self.resistance.fraction * self.move[axis]

    def to_xarray(self) -> "xarray.Dataset":
        """The path as an xarray.Dataset over its fraction, units in the attributes."""
        base.need("tables")
        import xarray

        return xarray.Dataset(
            base.variables(WAY[1:], self, "fraction"),
            {"fraction": self.resistance.fraction},
            {
                "title": self.chain.title or "reprogramming",
                "by": self.by,
                "before": self.before,
                "after": self.after,
                "distance_m": self.distance,
                "method": self.method,
                "work_0_J": self.resistance.work_0,
                "work_1_J": self.resistance.work_1,
            },
        )

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the path as CSV, units in the column names (mm, N)."""
        base.write_csv(file, ((q, q.of(self)) for q in WAY))

    def __str__(self):
        wanted = self.target or "another sequence"
        if math.isinf(self.distance) and math.isinf(self.reach):
            return f"no value of {self.by} that was tried gives {wanted} ({self.method})"
        if math.isinf(self.distance):
            return (
                f"no displacement of {self.by} up to {base.to_unit(self.reach, 'mm'):.4g} mm gives "
                f"{wanted} ({self.method})"
            )
        if self.distance == 0 and self.after == self.before:
            return f"the sequence is already {self.before}"
        becomes = f"{self.before} -> {self.after} ({self.method})"
        if isinstance(self.displacement, tuple):
            x, y = (base.signed(base.to_unit(part, "mm")) for part in self.displacement)
            lines = [
                f"move {self.by} by ({x}, {y}) mm, {base.to_unit(self.distance, 'mm'):.4g} mm: "
                f"{becomes}",
                str(self.resistance),
            ]
        else:
            place = self.place
            assert not isinstance(place, tuple)
            unit, factor = base.display_unit(self.unit)
            values = f"{place * factor:.4g} ({self.displacement * factor:+.4g})"
            lines = [f"set {self.by} to {values}{f' {unit}' * (unit != '1')}: {becomes}"]
        if self.resolution:
            lines.append(f"searched, not exact: {self.resolution}")
        return "\n".join(lines)

    def __repr__(self):
        return f"Reprogramming({'; '.join(str(self).splitlines()[:2])})"


def _changeable(chain: Chain, by: str) -> tuple[Parameter, bool]:
    """The anchor, or the number of an element, of this name, and whether it is a number."""
    moved = parameter(chain, by)
    number = moved.cell is not None and isinstance(chain.cells[moved.cell], Element)
    if not (moved.is_anchor or number):
        raise base.InputError(
            f"by = {by!r}: must be an anchor, for example {chain.names[0] + '.p'!r} or "
            f"{chain.names[-1] + '.q'!r}."
        )
    return moved, number


def reprogram(
    chain: Chain,
    target: str | Sequence | None,
    by: str,
    *,
    along: Sized[float] | None = None,
    one_way: bool = False,
    reach: float = base.REACH,
    progress: base.Progress = None,
) -> Reprogramming:
    """The smallest displacement of one anchor with which a chain reaches a target.

    All else as for `Chain.reprogram`.
    """
    moved, number = _changeable(chain, by)
    if number and (along is not None or one_way):
        raise base.InputError(
            f"by = {by!r} is a number, without a direction: leave `along` and `one_way` out."
        )
    ways = search.Displacements.of(along, one_way, reach)
    refuse_reach(chain, reach)
    wanted = None
    if target is not None:
        text = checked_cycle(str(target), chain.last_state, "target", chain.names)
        wanted = Sequence.parse(text)
    before = cycle(chain).sequence
    text = None if wanted is None else str(wanted)
    after, method = None, Method.EXACT
    if number:
        distance, change, past, reach = 0.0, 0.0, 0.0, math.inf
        if before != wanted:
            asked = chain, None, str(before), moved, text, progress
            distance, change, past, method = numbers.nearest_share(*asked)
        if math.isfinite(distance):
            after, there = (numbers.changed_by(chain, moved, part) for part in (past, change))
            change = float(moved.value(there)) - float(moved.value(chain))  # type: ignore[arg-type]
            distance = abs(change)
        standard = numbers.resolution(moved.part, chain.measure.force)
        resolution = standard if wanted is None else numbers.RESOLUTION_FINE
    else:
        distance, change, past, reach = 0.0, (0.0, 0.0), (0.0, 0.0), ways.reach
        if before != wanted:
            aim, forces = nearest.Aim(chain, before, moved, wanted), concave.SortedChain.of(chain)
            distance, change, past, method = nearest.nearest(aim, forces, ways, progress)
        after = moved.displaced(chain, past) if math.isfinite(distance) else None
        resolution = search.resolution(ways, wanted is not None)
    return Reprogramming(
        chain,
        text,
        moved.name,
        change,
        distance,
        reach,
        after,
        str(before),
        "" if after is None else str(cycle(after).sequence),
        method,
        resolution if method is Method.SEARCH else "",
    )
