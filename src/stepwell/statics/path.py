"""How a chain moves while its actuator visits a list of turning points."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell._write import write_atomic
from stepwell.mechanism import Chain
from stepwell.statics import _follow as f
from stepwell.statics._law import Floats, Ints, Laws
from stepwell.statics._outcome import StaticsError, advice_on_tie, refuse_failure
from stepwell.statics._pack import pack
from stepwell.statics._pieces import Pieces, cut
from stepwell.statics._sample import count_samples, sample
from stepwell.statics._start import drive_weights, start_travels, starting_state
from stepwell.statics.events import Cause, Event, EventKind, Tie

if TYPE_CHECKING:
    import xarray

__all__ = ["Path", "StaticsError", "path"]


@dataclass(frozen=True, eq=False)
class Path:
    """A chain's way through its equilibria, with every event and a certificate at every point.

    Between events the arrays hold `points` samples a branch; events are exact whatever the
    sampling. n samples, N cells.

    Attributes:
        chain: what moved.
        turning_points: positions of the actuator [m], or forces [N] under force control.
        start: (N,) travels [m] at the beginning.
        points: samples on each smooth branch.

    Assumes: quasi-static motion, rigid levers and blocks, and after a snap overdamped flow at
    fixed drive with equal mobility on every travel (theory page, "Landing").
    """

    chain: Chain
    turning_points: tuple[float, ...]
    start: tuple[float, ...]
    points: int
    _start_force: float = field(repr=False)
    _laws: Laws = field(repr=False)
    _pieces: Pieces = field(repr=False)
    _log: f.Log = field(repr=False)

    @cached_property
    def _samples(self) -> dict[str, Any]:
        alpha, beta = drive_weights(self.chain)
        size = int(count_samples(self._log, self.points))
        out: dict[str, Any] = {
            "drive": np.empty(size),
            "travel": np.empty((size, len(self.chain))),
            "force": np.empty(size),
            "branch": np.zeros(size, np.int64),
            "snap_after": np.zeros(size, np.int64),
            "direction": np.zeros(size, np.int64),
            "residual": np.empty(size),
            "stability": np.empty(size),
        }
        used = sample(
            self._laws,
            self._pieces,
            self._log,
            np.array(self.start),
            self._start_force,
            alpha,
            beta,
            self.points,
            *out.values(),
        )
        for name, values in out.items():
            out[name] = values[:used]
            out[name].setflags(write=False)
        return out

    @property
    def drive(self) -> Floats:
        """(n,) actuator position [m], or its force [N] under force control."""
        return self._samples["drive"]

    @property
    def travel(self) -> Floats:
        """(n, N) travel of every cell [m]."""
        return self._samples["travel"]

    @cached_property
    def stroke(self) -> Floats:
        """(n,) displacement of the outermost block u = Σ s_i [m]."""
        return np.sum(self.travel, axis=1)

    @property
    def force(self) -> Floats:
        """(n,) actuator force λ [N], positive where it resists loading."""
        return self._samples["force"]

    @cached_property
    def energy(self) -> Floats:
        """(n,) energy of all cells [J], without the actuator's spring."""
        columns = (
            cell.energy(cell.angle(self.travel[:, i])) for i, cell in enumerate(self.chain.cells)
        )
        return np.sum(list(columns), axis=0)

    @property
    def branch(self) -> Ints:
        """(n,) number of the smooth branch; a snap leads from one to the next."""
        return self._samples["branch"]

    @property
    def snap_after(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """(n,) True where the next sample is the landing of a snap."""
        return self._samples["snap_after"].astype(bool)

    @property
    def direction(self) -> Ints:
        """(n,) +1 while the drive rises, -1 while it falls."""
        return self._samples["direction"]

    @property
    def residual(self) -> Floats:
        """(n,) certificate: the worst violation of equilibrium by any cell [N]."""
        return self._samples["residual"]

    @property
    def stability(self) -> Floats:
        """(n,) certificate: least stiffness at fixed drive [N/m]; > 0 is stable, inf is held."""
        return self._samples["stability"]

    @property
    def _segments(self) -> Floats:
        return self._log.segments[: self._log.used[0]]

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Every switch and snap in order."""
        return tuple(_events(self._log, self._segments, self._laws, np.array(self.start)))

    @cached_property
    def degenerate(self) -> tuple[Tie, ...]:
        """Where two outcomes were closer than the tolerance, with advice; empty if nowhere."""
        ties: list[Tie] = []
        for row in self._segments[self._segments[:, f.TIE_A] >= 0]:
            cells = tuple(dict.fromkeys((int(row[f.TIE_A]), int(row[f.TIE_B]))))
            drive = float(row[f.DRIVE_1])
            ties.append(Tie(drive, cells, advice_on_tie(self.chain, cells, drive)))
        return tuple(ties)

    @property
    def released(self) -> float:
        """Energy turned into heat by snaps [J]."""
        return float(np.sum(self._segments[:, f.RELEASED]))

    @property
    def friction_work(self) -> float:
        """Energy taken by friction [J]."""
        return float(np.sum(self._segments[:, f.RUBBED]))

    @property
    def dissipated(self) -> float:
        """Energy lost on the way [J]: snaps and friction."""
        return self.released + self.friction_work

    @cached_property
    def work(self) -> float:
        """Work done by the actuator [J]: what was lost plus what is stored in addition."""
        _, beta = drive_weights(self.chain)
        ends = [np.array(self.start), self.end]
        cells = self.chain.cells
        stored = [
            math.fsum(float(c.energy(c.angle(s))) for c, s in zip(cells, e, strict=True))
            for e in ends
        ]
        force = (self._start_force, self.end_force)
        softness = 0.0 if self.chain.actuator_stiffness == 0 else beta
        spring = 0.5 * softness * (force[1] ** 2 - force[0] ** 2)
        return self.dissipated + stored[1] - stored[0] + spring

    def moves(self) -> Iterator[list[tuple[int, float]]]:
        """For every segment of the path the cells that moved and their travels after it [m]."""
        movers = self._log.movers
        for k in range(len(self._segments)):
            rows = movers[self._log.first[k] : self._log.first[k + 1]]
            yield [(int(row[f.CELL]), float(row[f.TRAVEL_1])) for row in rows]

    @property
    def end_force(self) -> float:
        """Actuator force at the end [N]."""
        return float(self._segments[-1, f.FORCE_1]) if len(self._segments) else self._start_force

    @property
    def peak_force(self) -> float:
        """Largest actuator force in size on the way [N], with its sign."""
        # λ is monotone between events, so it peaks at an end of a segment.
        forces = np.append(self._segments[:, [f.FORCE_0, f.FORCE_1]].ravel(), self._start_force)
        return float(forces[np.argmax(np.abs(forces))])

    @cached_property
    def end(self) -> Floats:
        """(N,) travels at the end [m]."""
        travels = np.array(self.start)
        movers = self._log.movers[: self._log.used[1]]
        # Later rows overwrite earlier ones: NumPy assigns in order.
        travels[movers[:, f.CELL].astype(int)] = movers[:, f.TRAVEL_1]
        return travels

    def resampled(self, points: int) -> Path:
        """The same path with `points` samples on each smooth branch, 2 or more."""
        if points < 2:
            raise ValueError(f"points = {points}: must be >= 2, both ends of a branch.")
        return Path(
            self.chain,
            self.turning_points,
            self.start,
            points,
            self._start_force,
            self._laws,
            self._pieces,
            self._log,
        )

    def to_xarray(self) -> xarray.Dataset:
        """All samples as an xarray.Dataset over (sample, cell), units in the attributes."""
        import xarray

        per_sample = {
            "drive": ("N" if self.chain.actuator_stiffness == 0 else "m", "actuator coordinate"),
            "stroke": ("m", "displacement of the outermost block"),
            "force": ("N", "actuator force"),
            "energy": ("J", "energy of all cells"),
            "branch": ("1", "number of the smooth branch"),
            "direction": ("1", "+1 while the drive rises"),
            "residual": ("N", "worst violation of equilibrium"),
            "stability": ("N/m", "least stiffness at fixed drive"),
        }
        data: dict[str, Any] = {
            name: ("sample", getattr(self, name), {"units": unit, "long_name": text})
            for name, (unit, text) in per_sample.items()
        }
        data["travel"] = (
            ("sample", "cell"),
            self.travel,
            {"units": "m", "long_name": "travel of each cell"},
        )
        return xarray.Dataset(
            data, {"cell": list(self.chain.names)}, {"title": self.chain.title or "path"}
        )

    def to_csv(self, file: str | File) -> None:
        """Write all samples as CSV, units in the column names (mm, N, mJ, N/m)."""
        unit, factor = ("N", 1.0) if self.chain.actuator_stiffness == 0 else ("mm", 1e3)
        columns: dict[str, Floats] = {
            f"drive_{unit}": self.drive * factor,
            "stroke_mm": self.stroke * 1e3,
            **{
                f"travel_{name.replace(' ', '_')}_mm": self.travel[:, i] * 1e3
                for i, name in enumerate(self.chain.names)
            },
            "force_N": self.force,
            "energy_mJ": self.energy * 1e3,
            "branch": self.branch,
            "direction": self.direction,
            "residual_N": self.residual,
            "stability_N_per_m": self.stability,
        }
        lines = [",".join(columns)]
        lines += [",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True)]
        write_atomic(file, "\n".join(lines) + "\n")

    def __repr__(self):
        snaps = int(np.sum(self._segments[:, f.KIND] == f.SNAP))
        turns = " → ".join(f"{t * 1e3:.4g}" for t in self.turning_points[:6])
        more = " → …" if len(self.turning_points) > 6 else ""
        unit = "mN" if self.chain.actuator_stiffness == 0 else "mm"
        return (
            f"Path({len(self.chain)} cells, {turns}{more} {unit}: {snaps} snaps, "
            f"dissipates {self.dissipated * 1e3:.4g} mJ)"
        )


def path(
    chain: Chain,
    turning_points: Sequence[float],
    *,
    start: str | Sequence[float] | None = None,
    prefer: Sequence[int] | None = None,
) -> Path:
    """Follow the chain's local energy minimum exactly while the actuator turns at these points.

    Args:
        chain: the chain.
        turning_points: (m,) actuator positions [m], or forces [N] where its stiffness is 0.
        start: state such as "010" or (N,) travels [m]; all cells at 0 by default.
        prefer: cells by falling priority where two of them tie; innermost first by default.

    Returns:
        The path.

    Raises:
        ValueError: turning points out of range, or a start that is no stable equilibrium.
        StaticsError: the follower could not go on; its text says where and what to do.

    Source: the equilibria are those of Kamp et al. 2024, Eqs. 1, 2 and 5; following them through
    snaps is ours (theory page).
    """
    points = _checked_turns(chain, turning_points)
    laws = pack(chain.cells)
    pieces = cut(laws)
    scale = _force_scale(laws, pieces)
    travels = start_travels(chain, start)
    state = starting_state(chain, laws, pieces, travels, points[0], scale)
    return follow_from(chain, laws, pieces, points, travels, state, scale, prefer)


def full_cycle(chain: Chain, *, prefer: Sequence[int] | None = None) -> Path:
    """Load from all cells at 0 until all are at 1, and unload.

    Args:
        chain: the chain.
        prefer: cells by falling priority where two of them tie; innermost first by default.

    Returns:
        The path.

    Raises:
        StaticsError: the follower could not go on; its text says where and what to do.
    """
    laws = pack(chain.cells)
    pieces = cut(laws)
    alpha, beta = drive_weights(chain)
    low, high = force_range(laws, pieces) if beta > 0 else (0.0, 0.0)
    turning = np.array([beta * low, alpha * float(np.sum(laws.full)) + beta * high, beta * low])
    scale = _force_scale(laws, pieces)
    travels = np.zeros(len(chain))
    state = starting_state(chain, laws, pieces, travels, turning[0], scale)
    return follow_from(chain, laws, pieces, turning, travels, state, scale, prefer)


def follow_from(
    chain: Chain,
    laws: Laws,
    pieces: Pieces,
    turning: Floats,
    travels: Floats,
    state: f.State,
    scale: float,
    prefer: Sequence[int] | None,
) -> Path:
    """Run the follower, giving it a longer log until the path fits."""
    alpha, beta = drive_weights(chain)
    rank = _ranks(len(chain), prefer)
    start_force = float(state.force[0])
    room = 64 + 16 * len(chain) * len(turning)
    while True:
        log = f.Log(
            np.zeros((room, f.SEGMENT_COLUMNS)),
            np.zeros(room + 1, np.int64),
            np.zeros((4 * room, f.MOVER_COLUMNS)),
            np.zeros(2, np.int64),
        )
        trial = f.State(*(part.copy() for part in state))
        status = f.follow(laws, pieces, alpha, beta, turning, trial, rank, scale, log)
        if status != f.LOG_FULL:
            break
        room *= 4
    if status != f.DONE:
        refuse_failure(status, chain, trial.travel, float(trial.force[0]))
    samples = max(2, min(33, 4_000_000 // max(1, int(log.used[0]) * len(chain))))
    return Path(
        chain,
        tuple(float(t) for t in turning),
        tuple(float(s) for s in travels),
        samples,
        start_force,
        laws,
        pieces,
        log,
    )


def _force_scale(laws: Laws, pieces: Pieces) -> float:
    largest = max(np.max(np.abs(pieces.force_left)), np.max(np.abs(pieces.force_right)))
    return float(max(largest, np.max(laws.friction), 1e-12))


def force_range(laws: Laws, pieces: Pieces) -> tuple[float, float]:
    """A force below which no cell leaves 0, and one above which none leaves 1 [N]."""
    forces = np.concatenate([pieces.force_left, pieces.force_right])
    rub = float(np.max(laws.friction))
    margin = 0.01 * _force_scale(laws, pieces)
    return float(np.min(forces)) - rub - margin, float(np.max(forces)) + rub + margin


def _ranks(cells: int, prefer: Sequence[int] | None) -> Ints:
    order = list(range(cells)) if prefer is None else [int(i) for i in prefer]
    if sorted(order) != list(range(cells)):
        raise ValueError(
            f"prefer = {prefer!r}: must name each of the cells 0..{cells - 1} once, first the one "
            f"that goes first."
        )
    ranks = np.empty(cells, np.int64)
    ranks[order] = np.arange(cells)
    return ranks


def _checked_turns(chain: Chain, turning_points: Sequence[float]) -> Floats:
    points = np.asarray(turning_points, float)
    if points.ndim != 1 or len(points) < 1 or not np.all(np.isfinite(points)):
        raise ValueError(
            f"turning_points = {turning_points!r}: must be one or more finite numbers, where the "
            f"actuator starts and where it turns."
        )
    if math.isinf(chain.actuator_stiffness):
        most = chain.full_stroke
        outside = (points < -1e-9 * most) | (points > (1 + 1e-9) * most)
        if outside.any():
            worst = float(points[outside][0])
            raise ValueError(
                f"turning_points: {worst * 1e3:.6g} mm is out of reach: must be between 0 and "
                f"{most * 1e3:.6g} mm, the sum of all travels (strokes are in m)."
            )
        points = np.clip(points, 0.0, most)
    return points


def _events(log: f.Log, segments: Floats, laws: Laws, travels: Floats) -> list[Event]:
    events: list[Event] = []
    for k, row in enumerate(segments):
        movers = log.movers[log.first[k] : log.first[k + 1]]
        cells = movers[:, f.CELL].astype(int)
        before, after = movers[:, f.TRAVEL_0], movers[:, f.TRAVEL_1]
        full = laws.full[cells]
        moved = before != after
        arrives = moved & ((after == 0.0) | (after == full))
        arrivals = [(int(c), int(a > 0)) for c, a in zip(cells[arrives], after[arrives], strict=True)]
        tie = bool(row[f.TIE_A] >= 0)
        common = {"direction": int(row[f.DIRECTION]), "tie": tie}
        if row[f.KIND] == f.SNAP:
            events.append(
                Event(
                    EventKind.SNAP,
                    Cause.RELEASE if row[f.CAUSE] == f.RELEASE else Cause.FOLD,
                    float(row[f.DRIVE_0]),
                    float(np.sum(travels)),
                    cells=tuple(int(c) for c in cells),
                    before=tuple(float(s) for s in before),
                    after=tuple(float(s) for s in after),
                    force_before=float(row[f.FORCE_0]),
                    force_after=float(row[f.FORCE_1]),
                    released=float(row[f.RELEASED]),
                    arrivals=tuple(arrivals),
                    **common,
                )
            )
            travels[cells] = after
            continue
        travels[cells] = after
        for cell, state in arrivals:
            j = int(np.flatnonzero(cells == cell)[0])
            events.append(
                Event(
                    EventKind.SWITCH,
                    Cause.STOP,
                    float(row[f.DRIVE_1]),
                    float(np.sum(travels)),
                    cells=(cell,),
                    before=(float(before[j]),),
                    after=(float(after[j]),),
                    force_before=float(row[f.FORCE_1]),
                    force_after=float(row[f.FORCE_1]),
                    released=0.0,
                    arrivals=((cell, state),),
                    **common,
                )
            )
    return events
