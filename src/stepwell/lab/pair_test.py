"""Two cells on the test machine compared with their model: order of motion and snaps."""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import Bools, ByValue, Drawn, Floats, to_unit
from stepwell.lab.recordings.curve import Curve, mean_curve, rms
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.rig import END, PAPER_RIG, Rig, judged, mover, on_path, path_of, quiet_zones
from stepwell.lab.series import LEAST_ERROR_RATIO, Series, carried
from stepwell.lab.snaps import MeasuredSnap, find_snaps, holes_of, matched, samples_of_jump
from stepwell.mechanism import Chain
from stepwell.statics import Event, EventKind, Path

Order = tuple[int, int]
_Snaps = Sequence[tuple[MeasuredSnap, ...]]  # for each run

_ORDERS: tuple[Order, Order] = ((0, 1), (1, 0))
_NEAR = 0.5e-3  # [m] before a snap that no longer counts for the order
# Without a predicted snap, a jump with the sign of a snap counts from this fraction of k r on.
SNAP_SHARE = 0.1
# Fractions of a travel at which stops have no influence on the force.
_MIDDLE = np.linspace(0.3, 0.7, 41)
# Largest deviation of a snap from the model, in standard deviations, that counts as agreement.
AGREE = 2.0
# Repeats with a larger standard deviation get a warning, for any sampling [m].
_SCATTER = 0.5e-3
# Stroke before a snap over which the slope of the force is computed [m], uncertainty of the force
# [N] and least slope [N/m], from the recordings published with the paper.
_BEFORE, FORCE_DOUBT, _FLATTEST = 1e-3, 0.03, 20.0
# Stroke that a run must continue after a snap to show it [m].
_LATE = 0.5e-3
# Jumps of repeats this near each other are one jump [m].
_TOGETHER = 1e-3


@dataclass(frozen=True, eq=False)
class PairTest(ByValue, Drawn):
    """Comparison of a series of two cells with its model.

    Attributes:
        stroke: (n,) from state 0 on [m].
        force: (n,) measured force less the baseline, for the cells in the order `shown` [N].
        model: (n,) force of the model [N].
        inside: (n,) mask of the judged strokes.
        spread: mean standard deviation between repeats [N].
        errors: RMSE against the cells moving in the order (0, 1) and (1, 0), in k r. The stiffness
            is fitted, and strokes past the first predicted or measured snap are left out.
        rmse, worst, rmse_corrected: measured less model, in k r; corrected for the rig's bar.
        predicted, tie: cells in the order of the model; whether that order is a tie.
        first: the cell that is assumed to move first in the baseline.
        snaps: for each run the strokes of its snaps [m]: force jumps with the predicted sign and
            size, or with the sign of a snap if none is predicted.
        slips: for each run the strokes of its other jumps [m], mostly stick-slip.
        missing: for each run the number of samples missing in gaps, where no snap is detected.
        doubt: standard deviation of a measured less the predicted snap [m]. It contains the scatter
            of the repeats, the sampling, and the uncertainty of the force (0.03 N and the scatter
            of the repeats) over the slope of the force before the snap.
        snaps_predicted: machine strokes of the snaps of the model, without friction [m].
        snaps_with_friction: the same with the friction of the baseline [m].
        pull: difference of the measured forces of the two cells at the ends of their travels [N].
        hold: friction of both cells there, from the baseline [N]; a snap needs a larger pull.
    """

    series: Series
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    model: Floats = field(repr=False)
    inside: Bools = field(repr=False)
    spread: float
    errors: tuple[float, float]
    rmse: float
    worst: float
    rmse_corrected: float
    predicted: Order
    tie: bool
    first: int
    snaps: tuple[tuple[float, ...], ...]
    slips: tuple[tuple[float, ...], ...]
    missing: tuple[int, ...]
    doubt: float
    snaps_predicted: tuple[float, ...]
    snaps_with_friction: tuple[float, ...]
    pull: float
    hold: float

    @property
    def shown(self) -> Order:
        """The order with the smaller force error; the inner cell is 0."""
        return _ORDERS[int(np.argmin(self.errors))]

    @property
    def ratio(self) -> float:
        """Error of the other order over that of the order shown."""
        return max(self.errors) / min(self.errors)

    @property
    def fitted(self) -> Bools:
        """Mask (n,) of the judged strokes up to the first snap, used in fits."""
        return self.inside & judged(self.stroke, [past_snaps(self.series)])

    @property
    def handover(self) -> tuple[float, float]:
        """Nominal range of stroke in which one cell stops and the next begins [m]."""
        return _zones(self.series, self.shown)[-1]

    def moving(self) -> list[tuple[int, Bools]]:
        """For each cell in the order shown: mask (n,) of the strokes at which it moves."""
        return [(i, mine) for i, mine, _ in _one_by_one(self.series, self.shown, self.stroke)]

    def baseline_levels(self) -> list[tuple[float, float]]:
        """Force [N] of every baseline run with the inner cell at mid-travel, and with the outer."""
        series, levels = self.series, []
        for run in series.baseline:
            curve = mean_curve([run], series.chain.full_stroke)
            inner, outer = (
                np.mean(_baseline_force(series, self.first, i, _MIDDLE * cell.full_travel, curve))
                for i, cell in enumerate(series.chain.levers)
            )
            levels.append((float(inner), float(outer)))
        return levels

    @property
    def right_order(self) -> bool | None:
        """Whether the order is the predicted one; None if model or data are undecided."""
        if self.tie or self.ratio < LEAST_ERROR_RATIO:
            return None
        return self.shown == self.predicted

    @property
    def snap_strokes(self) -> tuple[float, float, int]:
        """Mean and standard deviation of the first snaps [m], and number of runs that snapped."""
        first = [snaps[0] for snaps in self.snaps if snaps]
        if not first:
            return math.nan, math.nan, 0
        spread = float(np.std(first, ddof=1)) if len(first) > 1 else math.nan
        return float(np.mean(first)), spread, len(first)

    @property
    def sigmas(self) -> float:
        """Deviation of the first snap from the predicted range, over `doubt`; NaN for none.

        Friction of the baseline may be in the machine, where it delays no snap, or in the joints.
        The range is between both predictions, and the deviation within it is 0.
        """
        mean, _, count = self.snap_strokes
        if not count or not self.snaps_predicted:
            return math.nan
        ends = [self.snaps_predicted[0], *self.snaps_with_friction[:1]]
        nearest = min(max(mean, min(ends)), max(ends))
        return (mean - nearest) / self.doubt

    @property
    def seen_within(self) -> float:
        """Uncertainty of the stroke of a snap due to the sampling [m]."""
        return _jump_width(self.series) / 2.0

    @property
    def right_snaps(self) -> bool | None:
        """Whether most runs snap as often as the model, at its strokes within two sigmas.

        None if a gap or a stroke that a run did not reach may hide a missing snap.
        """
        expected = len(self.snaps_predicted)
        if any(not self.stroke[0] <= u <= self.stroke[-1] for u in self.snaps_predicted):
            return None
        runs = list(zip(self.series.recordings, self.snaps, self.missing, strict=True))
        fewer = [(run, holes) for run, snaps, holes in runs if len(snaps) < expected]
        if any(holes or self._ends_early(run) for run, holes in fewer):
            return None
        if 2 * len(self.odd) >= len(runs):
            return False
        return not expected or abs(self.sigmas) <= AGREE

    def _ends_early(self, run: Recording) -> bool:
        """Whether a run ends before all snaps, also those delayed by friction, are past."""
        full, stroke = self.series.chain.full_stroke, self.series.placed(run)
        late = np.array(self.snaps_predicted + self.snaps_with_friction)
        if self.series.unloading:
            stroke, late = full - stroke, full - late
        last = float(np.max(late)) if self.series.baseline else full - END
        return float(np.max(stroke)) < max(last, min(last + _LATE, full - END))

    @property
    def odd(self) -> tuple[str, ...]:
        """Names of runs with another number of snaps than the model."""
        expected = len(self.snaps_predicted)
        runs = zip(self.series.recordings, self.snaps, strict=True)
        return tuple(run.name for run, snaps in runs if len(snaps) != expected)

    @property
    def agrees(self) -> bool:
        """Whether order and snaps are the predicted ones."""
        return bool(self.right_order) and bool(self.right_snaps)

    @property
    def warning(self) -> str:
        """Warning about runs that differ from the others; "" for none."""
        warnings: list[str] = []
        if 0 < 2 * len(self.odd) < len(self.snaps):
            warnings.append(f"unlike the others: {', '.join(self.odd)}")
        _, spread, count = self.snap_strokes
        sampled = max(_step(run) for run in self.series.recordings)
        if count > 1 and spread > max(_SCATTER, 10 * sampled):
            firsts = {
                run.name: to_unit(snaps[0], "mm")
                for run, snaps in zip(self.series.recordings, self.snaps, strict=True)
                if snaps
            }
            far = max(firsts.values()) - min(firsts.values())
            named = ", ".join(f"{name} {stroke:.2f}" for name, stroke in firsts.items())
            warnings.append(f"repeats differ by {far:.2f} mm, more than their sampling: {named} mm")
        return "; ".join(warnings)

    @property
    def verdict(self) -> str:
        """Verdict on order and snaps, with its reasons."""
        names = " then ".join(self.names(self.shown))
        if self.tie:
            return f"tie: the model has no unique order; the data are {self.ratio:.2f} to 1"
        if self.ratio < LEAST_ERROR_RATIO:
            return f"undecided: the data fit both orders ({self.ratio:.2f} to 1)"
        order = "order agrees" if self.right_order else "order differs from the model's"
        words = {True: "snaps agree", False: "snaps differ", None: "snaps undecided"}
        snaps = words[self.right_snaps]
        warning = f"; {self.warning}" if self.warning else ""
        return (
            f"{order}: {names} (error ratio {self.ratio:.1f}); {snaps}: {self.snaps_told}{warning}"
        )

    @property
    def snaps_told(self) -> str:
        """Measured and predicted snaps in words."""
        mean, spread, count = self.snap_strokes
        both = (
            f"{_strokes(self.snaps_predicted)}, with friction {_strokes(self.snaps_with_friction)}"
        )
        if not count and self.snaps_predicted:
            only = "" if self.hold >= self.pull else " only"
            return (
                f"no snap, predicted at {both}; at the end the cells pull {self.pull:.2f} N "
                f"against each other, of which friction could hold{only} {self.hold:.2f} N"
            )
        if not count:
            return "no snap, as predicted"
        scatter = f" ± {to_unit(spread, 'mm'):.2f}" if count > 1 else ""
        measured = (
            f"snap at {to_unit(mean, 'mm'):.2f}{scatter} mm in {count} of {len(self.snaps)} runs"
        )
        if not self.snaps_predicted:
            return f"{measured}, predicted nowhere"
        if self.sigmas == 0.0:
            return f"{measured}, predicted at {both}; between the two"
        return (
            f"{measured}, predicted at {both}; {abs(self.sigmas):.1f} σ outside the two "
            f"(σ = {to_unit(self.doubt, 'mm'):.2f} mm)"
        )

    def names(self, order: Order) -> list[str]:
        """Names of its cells in an order."""
        return [self.series.chain.names[cell] for cell in order]

    @property
    def held(self) -> bool:
        """Whether the model snaps and no run does."""
        return bool(self.snaps_predicted) and not self.snap_strokes[2]

    def __repr__(self):
        return f"PairTest({self.series.name}: {self.verdict})"


def pair_tests(series: Sequence[Series], rig: Rig = PAPER_RIG) -> list[PairTest]:
    """Compare series of two cells with their models.

    Which cell moves first in a baseline without bands is not recorded. For all series with the same
    baseline it is the cell with the smaller force error. The bar of the rig is used for the
    corrected result only; its other numbers convert predictions to machine strokes.
    """
    errors = [_errors(one) for one in series]
    total: dict[tuple[str, ...], Floats] = defaultdict(lambda: np.zeros(2))
    for one, each in zip(series, errors, strict=True):
        total[_baseline_of(one)] += np.min(each, axis=1) ** 2
    moved_first = [int(np.argmin(total[_baseline_of(one)])) for one in series]
    return [
        _pair_test(one, first, each[first], rig)
        for one, first, each in zip(series, moved_first, errors, strict=True)
    ]


def _pair_test(series: Series, first: int, errors: Floats, rig: Rig) -> PairTest:
    chain, curve = series.chain, series.curve
    shown = _ORDERS[int(np.argmin(errors))]
    force = curve.force - _friction(series, first, shown, curve.stroke)

    cycle, path, full = chain.cycle(), series.path, chain.full_stroke
    order = cycle.unloading_order if series.unloading else cycle.loading_order
    shown_at = rig.at_machine(path.stroke, path.force, full, series.unloading)
    model = on_path(path, curve.stroke, shown_at)
    inside = judged(curve.stroke, _zones(series, shown))
    gap = (force - model)[inside] / series.scale
    moving, travels = mover(path, curve.stroke, shown_at)
    jumps = _jumps(series, shown)
    snaps = _snaps_of_runs(series, jumps)
    factor = np.ones(len(curve))
    for i, cell in enumerate(chain.levers):
        mine = moving == i
        factor[mine] = rig.factor(cell, cell.angle(np.clip(travels[mine, i], 0, None)))
    return PairTest(
        series,
        curve.stroke,
        force,
        model,
        inside,
        float(np.mean(curve.spread[inside])),
        (float(errors[0]), float(errors[1])),
        rms(gap),
        float(np.max(np.abs(gap))),
        rms((force - model * factor)[inside] / series.scale),
        _ORDERS[0] if order[:1] == (0,) else _ORDERS[1],
        bool(path.degenerate),
        first,
        tuple(tuple(one.stroke for one in run_snaps) for run_snaps in snaps),
        tuple(
            tuple(one.stroke for one in every if one not in run_snaps)
            for every, run_snaps in zip(jumps, snaps, strict=True)
        ),
        tuple(holes_of(run) for run in series.recordings),
        _doubt(series, snaps),
        snaps_of(path, rig),
        snaps_of(path_of(_with_friction(series, first), series.unloading), rig),
        *_pull_and_hold(series, first, shown, curve.stroke[inside], force[inside]),
    )


def _baseline_of(series: Series) -> tuple[str, ...]:
    return tuple(run.source for run in series.baseline)


def _errors(series: Series) -> Floats:
    """RMSE in k r (2, 2) over the first cell of the baseline and the order of the cells."""
    curve, past = series.curve, past_snaps(series)
    errors = np.zeros((2, 2))
    for j, order in enumerate(_ORDERS):
        use = judged(curve.stroke, [*_zones(series, order), past])
        stroke = curve.stroke[use]
        model = np.zeros(len(stroke))
        for i, mine, travel in _one_by_one(series, order, stroke):
            cell = series.chain.levers[i]
            model[mine] = cell.force(cell.angle(travel))
        for first in (0, 1):
            measured = curve.force[use] - _friction(series, first, order, stroke)
            factor = max(float(model @ measured) / max(float(model @ model), 1e-30), 0.0)
            errors[first, j] = rms((measured - factor * model) / series.scale)
    return errors


def past_snaps(series: Series) -> tuple[float, float]:
    """Range of stroke from the first snap of the model or any run on, in motion direction."""
    strokes = [*snaps_of(series.path, Rig())]
    # A snap must be found in both orders, or it may be a handover.
    ways = [_snaps_of_runs(series, _jumps(series, order)) for order in _ORDERS]
    for one, other in zip(*ways, strict=True):
        strokes += {snap.stroke for snap in one} & {snap.stroke for snap in other}
    if series.unloading:
        return -math.inf, max(strokes, default=-math.inf) + _NEAR
    return min(strokes, default=math.inf) - _NEAR, math.inf


def _one_by_one(series: Series, order: Order, stroke: Floats) -> list[tuple[int, Bools, Floats]]:
    """For each cell in an order: mask of the strokes at which it moves, and its travels."""
    full, first = series.chain.full_stroke, series.chain.cells[order[0]].full_travel
    stroke, falls = np.clip(stroke, 0.0, full), series.unloading
    edge = full - first if falls else first
    mine = stroke >= edge if falls else stroke <= edge
    parts = zip(order, (mine, ~mine), (edge if falls else 0.0, 0.0 if falls else edge), strict=True)
    return [(cell, moving, stroke[moving] - start) for cell, moving, start in parts]


def _baseline_force(
    series: Series, first: int, cell: int, travel: Floats, curve: Curve | None = None
) -> Floats:
    """Baseline force [N] at travels (n,) [m] of a cell while the other cell is at a stop."""
    curve = series.baseline_curve if curve is None else curve
    if curve is None:
        return np.zeros(len(travel))
    above = (cell == first) == series.unloading
    offset = series.chain.full_stroke - series.chain.cells[cell].full_travel
    return curve.at(travel + offset if above else travel)


def _friction(series: Series, first: int, order: Order, stroke: Floats) -> Floats:
    """Baseline force of the moving cell at each stroke, less the weight in its model [N]."""
    friction = np.zeros(len(stroke))
    for cell, mine, travel in _one_by_one(series, order, stroke):
        friction[mine] = _baseline_force(series, first, cell, travel)
        if series.baseline_curve is not None:
            friction[mine] -= carried(series.chain.levers[cell], travel)
    return friction


def _zones(series: Series, order: Order) -> list[tuple[float, float]]:
    first = series.chain.cells[order[0]].full_travel
    return quiet_zones(series.chain.full_stroke, series.unloading, first)


def _jumps(series: Series, order: Order) -> _Snaps:
    zones, runs = _zones(series, order), series.recordings
    return [find_snaps(series.placed(run), run.force, zones, time_of(run)) for run in runs]


def time_of(run: Recording) -> Floats | None:
    """Time of a run if recorded and non-decreasing, else None."""
    time = run.time
    return time if np.all(np.isfinite(time)) and np.all(np.diff(time) >= 0) else None


def _step(run: Recording) -> float:
    """Median stroke between samples [m]."""
    return float(np.median(np.abs(np.diff(run.stroke))))


def _jump_width(series: Series) -> float:
    """Largest stroke over which a jump is detected in the runs [m]."""
    return max(_step(run) * samples_of_jump(time_of(run)) for run in series.recordings)


def _snap_events(path: Path) -> list[Event]:
    return [event for event in path.events if event.kind is EventKind.SNAP]


def fall_before(path: Path) -> float:
    """Slope of the force of a one-way path before its first snap, as a positive number [N/m]."""
    way = -1.0 if path.stroke[-1] < path.stroke[0] else 1.0
    ends = _snap_events(path)[0].stroke - way * np.array([_BEFORE, 1e-6])
    order = np.argsort(path.stroke, kind="stable")
    rise = np.diff(np.interp(ends, path.stroke[order], path.force[order]))[0] / _BEFORE
    return max(abs(float(rise)), _FLATTEST)


def _snaps_of_runs(series: Series, jumps: _Snaps) -> _Snaps:
    """Snaps among the jumps of each run.

    At a snap the cell that was ahead moves back, so the force jumps against the direction of the
    drive. In a slip within a cell it jumps the other way.
    """
    events = _snap_events(series.path)
    predicted = [MeasuredSnap(e.stroke, e.force_after - e.force_before) for e in events]
    if predicted:
        return [tuple(filter(None, matched(run, predicted))) for run in jumps]
    sign = -1.0 if series.unloading else 1.0
    least = SNAP_SHARE * series.scale
    large = [tuple(one for one in run if sign * one.jump > least) for run in jumps]

    def shared(one: MeasuredSnap) -> bool:
        near = sum(any(abs(one.stroke - u.stroke) < _TOGETHER for u in run) for run in large)
        return 2 * near > len(jumps)

    return [tuple(filter(shared, run)) for run in large]


def _doubt(series: Series, snaps: _Snaps) -> float:
    """Standard deviation of a measured less the predicted stroke of the first snap [m]."""
    # The error of the model is not included, or a bad model would agree with all data.
    firsts = [run[0].stroke for run in snaps if run]
    if not firsts or not _snap_events(series.path):
        return math.nan
    scatter = float(np.std(firsts, ddof=1)) if len(firsts) > 1 else 0.0
    off = math.hypot(FORCE_DOUBT, float(np.mean(series.curve.spread)))
    sampling = _jump_width(series) / math.sqrt(12.0)
    return math.hypot(scatter, sampling, off / fall_before(series.path))


def snaps_of(path: Path, rig: Rig) -> tuple[float, ...]:
    """Machine strokes of the snaps of a path [m]."""
    full, unloading = path.chain.full_stroke, bool(path.stroke[-1] < path.stroke[0])
    return tuple(
        float(rig.at_machine(event.stroke, event.force_before, full, unloading))
        for event in _snap_events(path)
    )


def _pull_and_hold(
    series: Series, first: int, order: Order, stroke: Floats, force: Floats
) -> tuple[float, float]:
    """Force difference of the cells at the ends of their travels, and friction there [N]."""
    last, end, sign = (0, 0.02, -1) if series.unloading else (-1, 0.98, 1)
    pull = hold = 0.0
    for cell, mine, _ in _one_by_one(series, order, stroke):
        at_end = np.array([end * series.chain.cells[cell].full_travel])
        hold += abs(float(_baseline_force(series, first, cell, at_end)[0]))
        if np.any(mine):  # the runs may end before the second cell moves
            pull += sign * float(force[mine][last])
        sign = -sign
    return max(pull, 0.0), hold


def _with_friction(series: Series, first: int) -> Chain:
    """The chain with the mean baseline friction, away from the stops, added to its cells."""
    cells = []
    for i, cell in enumerate(series.chain.cells):
        travel = np.linspace(0.1, 0.9, 81) * cell.full_travel
        friction = float(np.mean(np.abs(_baseline_force(series, first, i, travel))))
        cells.append(replace(cell, friction=cell.friction + friction))
    return replace(series.chain, cells=cells)


def _strokes(strokes: tuple[float, ...]) -> str:
    return ", ".join(f"{to_unit(u, 'mm'):.2f}" for u in strokes) + " mm" if strokes else "nowhere"
