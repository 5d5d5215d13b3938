"""Path of a chain through its equilibria: samples, events, certificates."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import base, mechanism
from stepwell.kernels import watched
from stepwell.statics.events import (
    Changes,
    Event,
    EventKind,
    Segment,
    Tie,
    events_of,
    phase_changes,
    segments_of,
)
from stepwell.statics.following import certificate, log as logged, state
from stepwell.statics.inertial import InertialLanding, inertial_landing
from stepwell.statics.inertial_path import InertialPath, inertial_path
from stepwell.statics.landing_robustness import Landing, checked_ratio, landings, samples_for
from stepwell.statics.landings.start import Snap, snaps_of
from stepwell.statics.outcome import advice_on_tie, refuse_broken
from stepwell.statics.places import Configuration, drive_weights, problem_of
from stepwell.statics.safe_rate import Inside, SafeRate, safe_rate

if TYPE_CHECKING:
    import xarray

    from stepwell.proof import PathProof

# Larger numbers of samples are computed in another thread, so that Ctrl-C works.
_MANY = 20_000

# Least travel past an end of a curve that is reported, as a fraction of its travel.
_PAST = 0.02

# Cells of the longest chain whose landings are checked by default.
_MOST_CHECKED = 8


@dataclass(frozen=True, eq=False)
class Path(base.ByValue, base.Drawn):
    """Path of a chain through its equilibria, with all events and a certificate at every sample.

    The arrays contain `points` samples per branch; events are exact for any sampling. n samples,
    N cells.

    Attributes:
        chain: the chain.
        turning_points: positions of the actuator [m], or forces [N] under force control.
        start, start_sheet: (N,) travels [m] and sheets of the cells' curves at the beginning.
        points: samples on each smooth branch.

    Assumes: quasi-static motion, rigid levers and blocks, and after a snap overdamped flow at fixed
    drive, each cell with its mobility, equal unless given (theory page, "Landing").
    """

    chain: mechanism.Chain
    turning_points: tuple[float, ...]
    start: tuple[float, ...]
    points: int
    start_sheet: tuple[int, ...]
    _start_force: float = field(repr=False)
    _log: logged.Log = field(repr=False)

    @cached_property
    def _samples(self) -> certificate.Samples:
        problem = self._problem
        samples = certificate.memory_for_samples(self._log, self.points, len(self.chain))
        start = np.array(self.start), np.array(self.start_sheet), self._start_force

        def fill(effort: base.Ints) -> int:
            limited = problem._replace(effort=effort)
            return certificate.sample(limited, self._log, *start, self.points, samples)

        used = watched(fill, long=len(samples.drive) > _MANY)
        samples = certificate.Samples._make(values[:used] for values in samples)
        worst = int(np.argmax(samples.residual))
        by = float(samples.residual[worst])
        if not by <= certificate.FORCE_SLACK * problem.scale:
            drive = float(samples.drive[worst])
            refuse_broken(certificate.EQUILIBRIUM, self.chain, drive, by, problem.scale)
        for values in samples:
            values.setflags(write=False)
        return samples

    @cached_property
    def _problem(self) -> state.DrivenChain:
        return problem_of(self.chain, self.__dict__.pop("_cells", None))

    def with_problem(self, problem: state.DrivenChain | None) -> "Path":
        """This path, with its problem already set up."""
        if problem is not None:
            self.__dict__["_problem"] = problem
        return self

    def with_cells(self, cells: tuple[mechanism.Laws, mechanism.Sheets] | None) -> "Path":
        """This path, with the packed cells for its problem."""
        if cells is not None:
            self.__dict__["_cells"] = cells
        return self

    @property
    def drive(self) -> base.Floats:
        """(n,) actuator position [m], or its force [N] under force control."""
        return self._samples.drive

    @property
    def travel(self) -> base.Floats:
        """(n, N) travel of every cell [m]."""
        return self._samples.travel

    @property
    def sheet(self) -> base.Ints:
        """(n, N) sheet of every cell on its curve; all 0 unless a curve folds back."""
        return self._samples.sheet

    @cached_property
    def stroke(self) -> base.Floats:
        """(n,) displacement of the outermost block u = Σ s_i [m]."""
        return np.sum(self.travel, axis=1)

    @property
    def force(self) -> base.Floats:
        """(n,) actuator force λ [N], positive where it resists loading."""
        return self._samples.force

    @cached_property
    def energy(self) -> base.Floats:
        """(n,) energy of all cells [J], without the actuator's spring."""
        levers = mechanism.levers.Levers(self.chain.cells, self.travel)
        total, of_levers = np.zeros(len(self.drive)), iter(levers.energy().T)
        for cell, travel, sheet in zip(self.chain.cells, self.travel.T, self.sheet.T, strict=True):
            if isinstance(cell, mechanism.Cell):
                total += next(of_levers)
                continue
            for number in np.unique(sheet):
                here = sheet == number
                total[here] += cell.energy_at(travel[here], int(number))
        return total

    @property
    def branch(self) -> base.Ints:
        """(n,) number of the smooth branch; a snap leads from one to the next."""
        return self._samples.branch

    @property
    def snap_after(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """(n,) True where the next sample is the landing of a snap."""
        return self._samples.snap_after.astype(bool)

    @property
    def direction(self) -> base.Ints:
        """(n,) +1 while the drive rises, -1 while it falls."""
        return self._samples.direction

    @property
    def residual(self) -> base.Floats:
        """(n,) certificate: the worst violation of equilibrium by any cell [N]."""
        return self._samples.residual

    @property
    def stability(self) -> base.Floats:
        """(n,) certificate: least stiffness at fixed drive [N/m]; > 0 is stable, inf is held.

        At a kink it is that of the softer side, so it can be 0 or less where a snap begins.
        """
        return self._samples.stability

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """All switches and snaps in order."""
        changes = self.phase_changes[1]
        walked = self._log, self.start, lambda: self._problem, changes, self.chain
        return tuple(events_of(*walked))

    @cached_property
    def phase_changes(self) -> tuple[list[int], Changes]:
        """(N,) phases at the start, and (segment, cell, phase) of changes; -1 in transit."""
        return phase_changes(self._log, self.start, self.start_sheet, self.chain.stretches)

    @cached_property
    def degenerate(self) -> tuple[Tie, ...]:
        """Degenerate events (ties), with advice; empty if there are none."""
        ties: list[Tie] = []
        for row in self._log.segments[self._log.segments[:, logged.TIE_A] >= 0]:
            cells = tuple(dict.fromkeys((int(row[logged.TIE_A]), int(row[logged.TIE_B]))))
            drive, force = float(row[logged.DRIVE_1]), float(row[logged.FORCE_1])
            drifts = int(row[logged.KIND]) == logged.DRIFT
            ties.append(Tie(drive, cells, advice_on_tie(self.chain, cells, drive, force, drifts)))
        return tuple(ties)

    def landings(
        self, ratio: float = 10.0, *, bound: float = 0.05, seed: int = 0
    ) -> tuple[Landing, ...]:
        """Robustness of the landing of each snap, in order, for all mobilities within a ratio.

        Without a proof, the snap is computed with mobilities at the ends of the range, then with
        random ones; `Landing.bound` is the fraction that may still lead elsewhere, with 95 %
        confidence. Snaps that follow one another at once, through saddles, count as one.

        Args:
            ratio: largest ratio of two factors of the given mobilities, 1 to 1000.
            bound: largest fraction of mobilities that may lead elsewhere if no sample does, 0.001
                to 0.5; 0.05 takes 59 samples for each snap without a proof.
            seed: random seed; the same seed gives the same samples.

        Raises:
            ValueError: a ratio, a bound or a seed that is not allowed.
        """
        snaps = [event for event in self.events if event.kind is EventKind.SNAP]
        tried = checked_ratio("ratio", ratio), samples_for(bound), base.check.whole("seed", seed, 0)
        return tuple(landings(self.chain, self._problem, self._snaps(), snaps, tried))

    def _snaps(self) -> Iterator[Snap]:
        start = np.array(self.start), np.array(self.start_sheet)
        return snaps_of(self._problem, self._log, *start)

    @cached_property
    def checked_landings(self) -> tuple[Landing, ...] | None:
        """`landings` up to a ratio of 10; None for chains of more than 8 cells with snaps."""
        snaps = any(event.kind is EventKind.SNAP for event in self.events)
        return self.landings() if len(self.chain) <= _MOST_CHECKED else None if snaps else ()

    def inertial_landing(
        self,
        snap: int | Event,
        masses: Iterable[float],
        damping: Iterable[float],
        *,
        restitution: float = 0.0,
        history: bool = False,
    ) -> InertialLanding:
        """Landing of a snap with masses of the blocks, as a check of the overdamped landing.

        The drive stays where the snap begins. A block outside cell j moves by s_1 + … + s_j, so the
        kinetic energy is ½ Σ M_j u̇_j². A rigid actuator holds the outermost block, whose mass then
        has no effect. Volumes take inertances [kg/m⁴], angles moments of inertia [kg m²].

        Args:
            snap: its number among the path's snaps, from 0, or the event itself.
            masses: (N,) of the block outside each cell, inner first [kg], > 0.
            damping: (N,) viscous, on each travel [N s/m], >= 0. With 1/mobility and very small
                masses the landing is that of the path.
            restitution: coefficient of restitution at a stop, 0 to below 1.
            history: whether the result contains travels and speeds over time.

        Raises:
            ValueError: no such snap, not one mass and damper per cell, a number out of range, or
                no dissipation at all.
            StaticsError: the snap does not come to rest.

        Source: ours; blows by Newton's law of restitution (Moreau 1988 for several at once), forces
        between cells by Gauss's principle of least constraint, steps by extrapolation (Deuflhard
        1985).
        """
        events = [event for event in self.events if event.kind is EventKind.SNAP]
        number = events.index(snap) if isinstance(snap, Event) and snap in events else snap
        if isinstance(number, Event) or not 0 <= base.check.whole("snap", number, 0) < len(events):
            raise base.InputError(
                f"snap = {snap!r}: must be a snap of this path, which has {len(events)}: pass its "
                f"number, from 0, or the event itself."
            )
        first, inertia = 0, (tuple(masses), tuple(damping), restitution)
        for each in self._snaps():
            if number < first + each.rows:
                args = self.chain, self._problem, each, events[first], inertia
                return inertial_landing(*args, history=history)
            first += each.rows
        raise AssertionError("every snap is in the log")

    def at_rate(
        self,
        rate: float,
        masses: Iterable[float],
        damping: Iterable[float],
        *,
        restitution: float = 0.0,
    ) -> InertialPath:
        """Motion along the same turning points at a rate, with masses of the blocks.

        Every stroke takes half a period, as by a crank: it begins and ends at rest, and its speed
        is that of a sine. All else as for `inertial_landing`.

        Args:
            rate: cycles per second [Hz], > 0.
            masses, damping, restitution: as for `inertial_landing`.

        Raises:
            ValueError: not one mass and damper per cell, or a number out of range.
            StaticsError: more impacts than can be followed.
        """
        inertia = tuple(masses), tuple(damping), restitution
        return inertial_path(self, self._problem, rate, inertia)

    def safe_rate(
        self, masses: Iterable[float] | None = None, damping: Iterable[float] | None = None
    ) -> SafeRate:
        """Rate up to which masses do not change the order of the path (theory page, "Rate").

        Args:
            masses: (N,) of the block outside each cell, inner first [kg]; 10 g each by default.
            damping: (N,) viscous, on each travel [N s/m]; none by default.
        """
        return safe_rate(self, self._inside, masses, damping)

    @property
    def _inside(self) -> Inside:
        return Inside(self._problem, self._log, self._snaps)

    @cached_property
    def usual_safe_rate(self) -> SafeRate:
        """`safe_rate` for the usual masses, where energy proves the landings of all snaps."""
        return safe_rate(self, self._inside, integrate=False)

    def prove(
        self, *, mobility_ratio: float = 1.0, progress: Callable[[int, int], None] | None = None
    ) -> "PathProof":
        """Prove this path in ball arithmetic: every event enclosed, every stretch between covered.

        The result has a bound of the error of each number of each event, and all gaps: parts that
        are not proved, with place and cause. Needs python-flint, the extra `proof`.

        Args:
            mobility_ratio: prove landings for all factors of the mobilities within this ratio, 1 to
                1000; by default for the given mobilities.
            progress: called with (done, total) events.

        Raises:
            ValueError: a ratio that is not allowed.
            ExtraError: python-flint is not installed.

        Source: ours; ball arithmetic by Arb (Johansson 2017) (theory page, "Proofs").
        """
        from stepwell import proof

        return proof.prove(self, mobility_ratio=mobility_ratio, progress=progress)

    @property
    def released(self) -> float:
        """Energy turned into heat by snaps [J]."""
        return float(np.sum(self._log.segments[:, logged.RELEASED]))

    @property
    def friction_work(self) -> float:
        """Energy taken by friction [J]."""
        return float(np.sum(self._log.segments[:, logged.RUBBED]))

    @property
    def dissipated(self) -> float:
        """Energy lost on the way [J]: snaps and friction."""
        return self.released + self.friction_work

    @cached_property
    def work(self) -> float:
        """Work of the actuator [J]: dissipated energy plus the change of stored energy."""
        _, beta = drive_weights(self.chain)
        ends = (np.array(self.start), self.start_sheet), (self.end, self.end_sheet)
        stored = [
            math.fsum(
                float(cell.energy_at(s, on))
                for cell, s, on in zip(self.chain.cells, travels, sheets, strict=True)
            )
            for travels, sheets in ends
        ]
        force = (self._start_force, self.end_force)
        softness = 0.0 if self.chain.actuator_stiffness == 0 else beta
        spring = 0.5 * softness * (force[1] ** 2 - force[0] ** 2)
        return self.dissipated + stored[1] - stored[0] + spring

    def segments(self) -> Iterator[Segment]:
        """Segments of the path in order: holds, smooth moves, snaps."""
        return segments_of(self._log, self.start, lambda: self._problem)

    @property
    def move_spans(self) -> base.Floats:
        """(m,) range of the drive on every smooth segment [m], or [N] under force control."""
        rows = self._log.segments
        moves = np.isin(rows[:, logged.KIND], (logged.MOVE, logged.DRIFT))
        return np.abs(rows[moves, logged.DRIVE_1] - rows[moves, logged.DRIVE_0])

    @cached_property
    def extrapolated(self) -> tuple[tuple[int, float], ...]:
        """Cells used past an end of their curve that has no stop, and their farthest travel [m].

        Over 2 % of the curve is reported, and no end at which the curve is straight anyway.
        """
        ends = [cell.known for cell in self.chain.elements]
        if not np.any(np.isfinite(ends)):
            return ()
        least, most = np.array(self.start), np.array(self.start)
        for one in self.segments():
            cells, moves = [*one.cells], np.array([one.before, one.after])
            least[cells] = np.minimum(least[cells], moves.min(axis=0))
            most[cells] = np.maximum(most[cells], moves.max(axis=0))
        past: list[tuple[int, float]] = []
        for i, cell in enumerate(self.chain.cells):
            if isinstance(cell, mechanism.Element):
                (low, high), room = cell.known, _PAST * (cell.high - cell.low)
                past += [(i, float(least[i]))] * bool(least[i] < low - room)
                past += [(i, float(most[i]))] * bool(most[i] > high + room)
        return tuple(past)

    @property
    def start_force(self) -> float:
        """Actuator force at the start [N]."""
        return self._start_force

    @property
    def end_force(self) -> float:
        """Actuator force at the end [N]."""
        rows = self._log.segments
        return float(rows[-1, logged.FORCE_1]) if len(rows) else self._start_force

    @property
    def peak_force(self) -> float:
        """Largest actuator force in size on the way [N], with its sign; of equal ones positive."""
        # λ is monotone between events, so it peaks at an end of a segment.
        ends = self._log.segments[:, [logged.FORCE_0, logged.FORCE_1]]
        forces = np.append(ends, self._start_force)
        return float(logged.signed_peak(np.max(forces), np.min(forces)))

    @cached_property
    def end(self) -> base.Floats:
        """(N,) travels at the end [m]."""
        return np.array(self.end_configuration.travel)

    @property
    def end_sheet(self) -> tuple[int, ...]:
        """(N,) sheets of the cells' curves at the end."""
        return self.end_configuration.sheet

    @cached_property
    def end_configuration(self) -> Configuration:
        """Configuration of the cells at the end: another path can start there."""
        travels, sheets, movers = np.array(self.start), np.array(self.start_sheet), self._log.movers
        cells = movers[:, logged.CELL].astype(int)
        # Later rows overwrite earlier ones: NumPy assigns in order.
        travels[cells], sheets[cells] = movers[:, logged.TRAVEL_1], movers[:, logged.SHEET_1]
        return Configuration(tuple(travels.tolist()), tuple(sheets.tolist()))

    def resampled(self, points: int) -> "Path":
        """The same path with `points` samples on each smooth branch, 2 or more."""
        if points < 2:
            raise base.InputError(f"points = {points}: must be >= 2, both ends of a branch.")
        known = self.__dict__.get
        same = replace(self, points=points)
        return same.with_problem(known("_problem")).with_cells(known("_cells"))

    def to_xarray(self) -> "xarray.Dataset":
        """All samples as an xarray.Dataset over (sample, cell), units in the attributes."""
        base.need("tables")
        import xarray

        schema = [replace(q, name=q.attribute) for q in self._schema]
        cells, title = {"cell": list(self.chain.names)}, {"title": self.chain.title or "path"}
        return xarray.Dataset(base.variables(schema, self, "sample"), cells, title)

    def to_csv(self, file: str | File) -> None:
        """Write all samples as CSV, units in the column names (of travel: mm, N, mJ, N/m)."""
        names = [name.replace(" ", "_") for name in self.chain.names]
        columns: list[tuple[base.Quantity, Any]] = []
        for q in self._schema:
            values = q.of(self)
            if q.dims:
                each = (replace(q, name=f"{q.name}_{name}") for name in names)
                columns += zip(each, values.T, strict=True)
            else:
                columns.append((q, values))
        base.write_csv(file, columns)

    @property
    def _schema(self) -> base.Schema:
        measure = self.chain.measure
        volume = measure is base.Measure.VOLUME
        outermost = "sum over the cells" if volume else "displacement of the outermost block"
        folds = any(len(element.laws) > 1 for element in self.chain.elements)
        each = "sheet of each cell on its curve"
        sheet = base.Quantity("sheet", doc=each, dims=("cell",))
        drive = base.display_unit(self.chain.drive_unit)[0]
        schema = (
            base.Quantity("drive", drive, doc="actuator coordinate"),
            base.Quantity("stroke", "mm", doc=outermost),
            base.Quantity("travel", "mm", doc="travel of each cell", dims=("cell",)),
            *([sheet] if folds else []),
            base.Quantity("force", "N", doc="actuator force"),
            base.Quantity("energy", "mJ", doc="energy of all cells"),
            base.Quantity("branch", doc="number of the smooth branch"),
            base.Quantity("direction", doc="+1 while the drive rises"),
            base.Quantity("residual", "N", doc="worst violation of equilibrium"),
            base.Quantity("stability", "N/m", doc="least stiffness at fixed drive"),
        )
        return base.in_measure(schema, measure)

    def __repr__(self):
        snaps = int(np.sum(self._log.segments[:, logged.KIND] == logged.SNAP))
        drive = base.Quantity("drive", base.display_unit(self.chain.drive_unit)[0])
        turns = " → ".join(f"{t * drive.factor:.4g}" for t in self.turning_points[:6])
        more = " → …" if len(self.turning_points) > 6 else ""
        return (
            f"Path({len(self.chain)} cells, {turns}{more} {drive.sign}: {snaps} snaps, "
            f"dissipates {base.to_unit(self.dissipated, 'mJ'):.4g} mJ)"
        )
