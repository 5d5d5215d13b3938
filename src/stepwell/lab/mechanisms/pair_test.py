"""Two cells on the test machine beside their model: which moves first, and where they snap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import ByValue, record
from stepwell.lab.mechanisms.predict import mover, on_path, path_of
from stepwell.lab.mechanisms.rig import PAPER_RIG, Rig, judged, quiet_zones
from stepwell.lab.mechanisms.schema import PAIR_TEST
from stepwell.lab.mechanisms.series import Series
from stepwell.lab.mechanisms.snaps import find_snaps
from stepwell.lab.recordings import Curve, from_zero
from stepwell.mechanism import Chain
from stepwell.statics import EventKind

Array = NDArray[np.float64]
Order = tuple[int, int]

_ORDERS: tuple[Order, Order] = ((0, 1), (1, 0))
# A ratio of errors below this does not tell one order from the other.
TELLING = 1.25
_NEAR = 0.5e-3  # [m] before a snap that no longer counts for the order


@dataclass(frozen=True, eq=False)
class PairTest(ByValue):
    """What a series of two cells shows.

    Attributes:
        series: the recordings and their model.
        stroke: (n,) from state 0 on [m].
        force: (n,) measured, baseline subtracted for the cells in the order `shown` [N].
        model: (n,) force of the model [N].
        inside: (n,) what is judged.
        spread: mean standard deviation between repeats [N].
        errors: RMSE against the cells moving in the order (0, 1) and (1, 0), in k r; the stiffness
            is left free, and strokes past the first snap, predicted or measured, do not count.
        rmse, worst, rmse_corrected: measured less model, in k r; corrected for the rig's bar.
        predicted: cells in the order in which the model moves them.
        tie: whether the model cannot tell that order.
        snaps: for each run the strokes where it snaps [m].
        snaps_predicted: strokes where the model snaps, without friction [m].
        snaps_with_friction: the same with the friction of the baseline [m].
        pull: difference of the measured forces of the two cells at the ends of their travels [N].
        hold: what friction of both can hold there by the baseline [N]; a snap needs a larger pull.
    """

    series: Series
    stroke: Array = field(repr=False)
    force: Array = field(repr=False)
    model: Array = field(repr=False)
    inside: NDArray[np.bool_] = field(repr=False)
    spread: float
    errors: tuple[float, float]
    rmse: float
    worst: float
    rmse_corrected: float
    predicted: Order
    tie: bool
    snaps: tuple[tuple[float, ...], ...]
    snaps_predicted: tuple[float, ...]
    snaps_with_friction: tuple[float, ...]
    pull: float
    hold: float

    @property
    def shown(self) -> Order:
        """The order that the measured force is nearer to, inner cell 0."""
        return _ORDERS[int(np.argmin(self.errors))]

    @property
    def ratio(self) -> float:
        """Error against the order that is not shown, over that against the one that is."""
        return max(self.errors) / min(self.errors)

    @property
    def right_order(self) -> bool | None:
        """Whether the order is the predicted one; None where model or data cannot tell."""
        if self.tie or self.ratio < TELLING:
            return None
        return self.shown == self.predicted

    @property
    def snap_strokes(self) -> tuple[float, float, int]:
        """Mean and standard deviation of the first snap of each run [m], and how many snapped."""
        first = [snaps[0] for snaps in self.snaps if snaps]
        if not first:
            return math.nan, math.nan, 0
        spread = float(np.std(first, ddof=1)) if len(first) > 1 else math.nan
        return float(np.mean(first)), spread, len(first)

    @property
    def right_snaps(self) -> bool:
        """Whether runs snap where the model snaps at all, and nowhere else."""
        wanted = len(self.snaps_predicted)
        return all(len(snaps) == wanted for snaps in self.snaps)

    @property
    def verdict(self) -> str:
        """A word, and what is behind it."""
        names = " then ".join(self.names(self.shown))
        if self.tie:
            return f"tie: the model cannot tell the order; the data are {self.ratio:.2f} to 1"
        if self.ratio < TELLING:
            return f"undecided: the data fit both orders ({self.ratio:.2f} to 1)"
        order = "order agrees" if self.right_order else "order differs from the model's"
        snaps = "snaps agree" if self.right_snaps else "snaps differ"
        return f"{order}: {names} (error ratio {self.ratio:.1f}); {snaps}: {self.snaps_told}"

    @property
    def snaps_told(self) -> str:
        """Measured snaps against the predicted ones, in words."""
        mean, spread, count = self.snap_strokes
        theory = _strokes(self.snaps_predicted)
        held = _strokes(self.snaps_with_friction)
        both = f"{theory}, with friction {held}"
        if not count and self.snaps_predicted:
            word = "could hold" if self.hold >= self.pull else "could hold only"
            return (
                f"no snap, predicted at {both}; at the end the cells pull {self.pull:.2f} N "
                f"against each other, of which friction {word} {self.hold:.2f} N"
            )
        if not count:
            return "no snap, as predicted"
        scatter = f" ± {spread * 1e3:.2f}" if count > 1 else ""
        measured = f"snap at {mean * 1e3:.2f}{scatter} mm in {count} of {len(self.snaps)} runs"
        return f"{measured}, predicted {'at ' + both if self.snaps_predicted else 'nowhere'}"

    def record(self) -> dict[str, Any]:
        """The result as JSON can hold it; docs/commands.md describes the names."""
        return record(PAIR_TEST, self)

    def names(self, order: Order) -> list[str]:
        """What its cells are called, in an order."""
        return [self.series.chain.names[cell] for cell in order]

    @property
    def held(self) -> bool:
        """Whether it never snaps where the model does."""
        return bool(self.snaps_predicted) and not self.snap_strokes[2]

    def __repr__(self):
        return f"PairTest({self.series.name}: {self.verdict})"


@dataclass(frozen=True, eq=False)
class Baseline:
    """Friction of each cell against its travel, read off a run of both without bands.

    Attributes:
        first: the cell that moved first in that run; None where nothing tells.
        friction: for the cell that moved first and for the other, force [N] at (n,) travels [m].
    """

    curve: Curve | None
    first: int
    unloading: bool
    travels: tuple[float, float]

    def of(self, cell: int, travel: Array) -> Array:
        """Baseline force [N] while this cell moves, at its travels [m]."""
        if self.curve is None:
            return np.zeros(len(travel))
        full = sum(self.travels)
        # While the first cell moves the other one rests at the stop that it has not left.
        if self.unloading:
            stroke = travel + (full - self.travels[cell] if cell == self.first else 0.0)
        else:
            stroke = travel + (0.0 if cell == self.first else full - self.travels[cell])
        return self.curve.at(stroke)

    def mean(self, cell: int) -> float:
        """Mean size of the friction of this cell [N], away from the ends of its travel."""
        travel = np.linspace(0.1, 0.9, 81) * self.travels[cell]
        return float(np.mean(np.abs(self.of(cell, travel))))


def pair_tests(series: Sequence[Series], rig: Rig = PAPER_RIG) -> list[PairTest]:
    """Compare series of two cells with their models.

    A baseline of two cells without bands shows one cell moving and then the other, and which is
    which is not recorded. It is decided once for all series that share the baseline: the cell is
    taken to move first with which the measured forces come nearer to the model.

    Args:
        series: each of two cells.
        rig: for the correction that is reported beside the plain result.

    Returns:
        A comparison for each.
    """
    first = _moved_first(series)
    return [_pair_test(one, first[_key(one)], rig) for one in series]


def _pair_test(series: Series, first: int, rig: Rig) -> PairTest:
    chain, unloading = series.chain, series.unloading
    baseline = _baseline(series, first)
    curve = series.curve
    past = _past_snaps(series)
    fits = {order: _against(series, curve, baseline, order, past) for order in _ORDERS}
    shown = min(_ORDERS, key=lambda order: fits[order])
    force = curve.force - _friction(chain, baseline, shown, unloading, curve.stroke)

    path = path_of(chain, unloading)
    model = on_path(path, curve.stroke)
    inside = judged(curve.stroke, _zones(chain, shown, unloading))
    gap = (force - model)[inside] / series.scale
    who, travels = mover(path, curve.stroke)
    factor = np.ones(len(curve))
    for cell in (0, 1):
        mine = who == cell
        angle = chain.cells[cell].angle(np.clip(travels[mine, cell], 0, None))
        factor[mine] = rig.factor(chain.cells[cell], angle)
    corrected = (force - model * factor)[inside] / series.scale
    return PairTest(
        series,
        curve.stroke,
        force,
        model,
        inside,
        float(np.mean(curve.spread[inside])),
        (fits[_ORDERS[0]], fits[_ORDERS[1]]),
        _rms(gap),
        float(np.max(np.abs(gap))),
        _rms(corrected),
        _predicted(chain, unloading),
        bool(path.degenerate),
        tuple(_snaps(series, run, shown) for run in range(len(series.recordings))),
        _theory(chain, unloading),
        _theory(_with_friction(chain, baseline), unloading),
        *_pull_and_hold(chain, baseline, shown, unloading, curve.stroke[inside], force[inside]),
    )


def _key(series: Series) -> tuple[str, ...]:
    return tuple(run.source for run in series.baseline)


def _moved_first(series: Sequence[Series]) -> dict[tuple[str, ...], int]:
    total: dict[tuple[str, ...], list[float]] = {}
    for one in series:
        curve, past = one.curve, _past_snaps(one)
        sums = total.setdefault(_key(one), [0.0, 0.0])
        for first in (0, 1):
            baseline = _baseline(one, first)
            sums[first] += min(_against(one, curve, baseline, o, past) for o in _ORDERS) ** 2
    return {key: int(np.argmin(sums)) for key, sums in total.items()}


def _baseline(series: Series, first: int) -> Baseline:
    travels = [cell.full_travel for cell in series.chain.cells]
    return Baseline(series.baseline_curve, first, series.unloading, (travels[0], travels[1]))


def _against(
    series: Series,
    curve: Curve,
    baseline: Baseline,
    order: Order,
    past_snaps: tuple[float, float],
) -> float:
    """RMSE in k r against the cells moving one after the other in this order."""
    chain, unloading = series.chain, series.unloading
    use = judged(curve.stroke, [*_zones(chain, order, unloading), past_snaps])
    stroke = curve.stroke[use]
    model = np.zeros(len(stroke))
    for cell, mine, travel in _one_by_one(chain, order, unloading, stroke):
        moving = chain.cells[cell]
        model[mine] = moving.force(moving.angle(travel))
    measured = curve.force[use] - _friction(chain, baseline, order, unloading, stroke)
    factor = max(float(model @ measured) / max(float(model @ model), 1e-30), 0.0)
    return _rms((measured - factor * model) / series.scale)


def _past_snaps(series: Series) -> tuple[float, float]:
    """Strokes from the first snap on, of the model or of any run, in the direction of motion."""
    found = [*_theory(series.chain, series.unloading)]
    for run in range(len(series.recordings)):
        # In neither order may a handover be taken for a snap.
        seen = [set(_snaps(series, run, order)) for order in _ORDERS]
        found += sorted(seen[0] & seen[1])
    if series.unloading:
        return (-1.0, max(found) + _NEAR) if found else (-1.0, -1.0)
    return (min(found) - _NEAR, 1.0) if found else (1.0, 1.0)


def _one_by_one(
    chain: Chain, order: Order, unloading: bool, stroke: Array
) -> list[tuple[int, NDArray[np.bool_], Array]]:
    """For each cell: which strokes it moves at, and its travels there."""
    first, second = order
    way = chain.cells[first].full_travel
    stroke = np.clip(stroke, 0.0, chain.full_stroke)
    if unloading:
        mine = stroke >= chain.full_stroke - way
        travel = stroke[mine] - (chain.full_stroke - way)
        return [(first, mine, travel), (second, ~mine, stroke[~mine])]
    mine = stroke <= way
    return [(first, mine, stroke[mine]), (second, ~mine, stroke[~mine] - way)]


def _friction(
    chain: Chain, baseline: Baseline, order: Order, unloading: bool, stroke: Array
) -> Array:
    """The baseline, each cell's share of it put where that cell moves."""
    found = np.zeros(len(stroke))
    for cell, mine, travel in _one_by_one(chain, order, unloading, stroke):
        found[mine] = baseline.of(cell, travel)
    return found


def _zones(chain: Chain, order: Order, unloading: bool) -> list[tuple[float, float]]:
    return quiet_zones(chain.full_stroke, unloading, chain.cells[order[0]].full_travel)


def _predicted(chain: Chain, unloading: bool) -> Order:
    cycle = chain.cycle()
    order = cycle.unloading_order if unloading else cycle.loading_order
    return (0, 1) if order[:1] == (0,) else (1, 0)


def _snaps(series: Series, run: int, order: Order) -> tuple[float, ...]:
    recording = series.recordings[run]
    stroke = from_zero(recording, series.chain.full_stroke)
    zones = _zones(series.chain, order, series.unloading)
    return tuple(snap.stroke for snap in find_snaps(stroke, recording.force, zones))


def _theory(chain: Chain, unloading: bool) -> tuple[float, ...]:
    events = path_of(chain, unloading).events
    return tuple(event.stroke for event in events if event.kind is EventKind.SNAP)


def _pull_and_hold(
    chain: Chain,
    baseline: Baseline,
    order: Order,
    unloading: bool,
    stroke: Array,
    force: Array,
) -> tuple[float, float]:
    """What the second cell, at its end, pulls against the first one, and what friction holds."""
    parts = {cell: mine for cell, mine, _ in _one_by_one(chain, order, unloading, stroke)}
    ends: list[float] = []
    hold = 0.0
    for cell in order:
        at = np.flatnonzero(parts[cell])
        ends.append(float(force[at[0] if unloading else at[-1]]))
        end = 0.02 if unloading else 0.98
        travel = np.array([end * chain.cells[cell].full_travel])
        hold += abs(float(baseline.of(cell, travel)[0]))
    pull = ends[1] - ends[0] if unloading else ends[0] - ends[1]
    return max(pull, 0.0), hold


def _with_friction(chain: Chain, baseline: Baseline) -> Chain:
    cells = [
        replace(cell, friction=cell.friction + baseline.mean(i))
        for i, cell in enumerate(chain.cells)
    ]
    return replace(chain, cells=cells)


def _strokes(strokes: tuple[float, ...]) -> str:
    return ", ".join(f"{u * 1e3:.2f}" for u in strokes) + " mm" if strokes else "nowhere"


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
