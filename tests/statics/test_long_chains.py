"""Long chains, followed by queues of events, with landings solved as one equation."""

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

import stepwell as sw
from chains import any_cell
from sizes import SIZE, examples
from stepwell.statics import StaticsError, drive_range, outcome
from stepwell.statics.following import certificate, log as logged

EVENT_LOOP = sys.modules["stepwell.statics.following.follow"]
RUN = sys.modules["stepwell.statics.run"]


class Table:
    """An open table in mm and N: it rises to a peak, falls to a valley, rises for good."""

    def __init__(self, rng: np.random.Generator, turns: int = 1):
        travel, force = [0.0], [0.0]
        for _ in range(turns):
            travel += [travel[-1] + rng.uniform(1.5, 3.5)]
            force += [force[-1] + rng.uniform(1.0, 3.0)]
            travel += [travel[-1] + rng.uniform(0.4, 1.2)]
            force += [force[-1] - rng.uniform(0.5, 2.5)]
        travel += [travel[-1] + 2.5, travel[-1] + 4.5]
        force += [force[-1] + 2.5, force[-1] + 5.0]
        self.travel, self.force = np.array(travel), np.array(force)

    def element(self, rows: int = 0, **how: Any) -> sw.Element:
        travel, force = self.travel, self.force
        if rows:
            travel = np.linspace(0.0, self.travel[-1], rows)
            force = PchipInterpolator(self.travel, self.force)(travel)
        return sw.Element.from_points(1e-3 * travel, force, **how)


def snaps_of_tables(tables: list[Table]) -> list[tuple[int, float, float]]:
    """Cell, stroke [mm] and force after every snap of the loading half; no code of the engine.

    Cells reach their peaks in ascending order; the force after each is found by bisection of the
    sum of all travels, each looked at anew.
    """
    travel = np.array([table.travel for table in tables]).T
    force = np.array([table.force for table in tables]).T
    over = np.zeros(len(tables), bool)

    def stroke(now: float) -> float:
        """Where all are at a force, before their peaks or behind their valleys [mm]."""
        # Of the two stretches behind a valley the second begins at its force.
        first = np.where(over, np.where(now > force[3], 3, 2), 0)
        places = (np.array([first, first + 1]), np.arange(len(tables)))
        (s_0, s_1), (f_0, f_1) = travel[places], force[places]
        return float(np.sum(s_0 + (now - f_0) * (s_1 - s_0) / (f_1 - f_0)))

    snaps: list[tuple[int, float, float]] = []
    for j in np.argsort(force[1]):
        peak = float(force[1, j])
        begin = stroke(peak)
        over[j] = True
        low, high = float(force[2, j]), peak
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if stroke(middle) < begin else (low, middle)
        snaps.append((int(j), begin, 0.5 * (low + high)))
    return snaps


def followed(
    chain: sw.Chain, turns: list[float], queues: bool, monkeypatch: pytest.MonkeyPatch
) -> sw.Path:
    """A path with queues wherever they can be used, or by the event loop alone.

    The event loop looks at all cells at every event and integrates every race.
    """
    with monkeypatch.context() as patch:
        patch.setattr(EVENT_LOOP, "is_regular", lambda problem: queues)
        patch.setattr(RUN.follow, "_machine", RUN.follow.function)
        with np.errstate(all="ignore"):
            return chain.path(turns)


# The event loop is interpreted here.
LONG = examples(4, full=6)
KINDS = ("tables", "smooth tables", "stopped tables", "levers", "levers and tables", "two turns")


def long_chain(seed: int, kind: str) -> sw.Chain:
    rng = np.random.default_rng(seed)
    if kind == "levers":
        return sw.Chain([any_cell(rng, friction=False) for _ in range(LONG)])
    rows = {"smooth tables": 15, "levers and tables": 12}.get(kind, 0)
    stops, turns = kind == "stopped tables", 2 if kind == "two turns" else 1
    cells: list[sw.Cell | sw.Element] = [
        Table(rng, turns).element(rows, stops=stops) for _ in range(LONG)
    ]
    if kind == "levers and tables":
        cells[::2] = [any_cell(rng, friction=False) for _ in cells[::2]]
    return sw.Chain(cells)


# The quick run takes each kind once.
FOLLOWED = [
    (kind, spring)
    for number, kind in enumerate(KINDS)
    for spring in (False, True)
    if SIZE == "full" or spring == number % 2
]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "spring"), FOLLOWED)
def test_queues_and_event_loop_give_one_path(kind, spring, monkeypatch):
    chain = long_chain(7 + spring, kind)
    if spring:
        chain = replace(chain, actuator_stiffness=300.0)
    low, high = drive_range(chain)
    turns = [low, low + 0.7 * (high - low), low + 0.4 * (high - low), high, low]
    path = followed(chain, turns, True, monkeypatch)
    assert np.any(path._log.segments[: path._log.used[0], logged.FOLLOW])
    other = followed(chain, turns, False, monkeypatch)
    assert not np.any(other._log.segments[: other._log.used[0], logged.FOLLOW])
    assert [(e.kind, e.direction, e.arrivals) for e in path.events] == [
        (e.kind, e.direction, e.arrivals) for e in other.events
    ]
    full, most = chain.full_stroke, max(abs(e.force_before) for e in other.events)
    for one, two in zip(path.events, other.events, strict=True):
        assert one.stroke == pytest.approx(two.stroke, abs=1e-9 * full)
        assert one.force_after == pytest.approx(two.force_after, abs=1e-9 * most)
        assert one.released == pytest.approx(two.released, abs=1e-9 * most * full)
    assert path.end == pytest.approx(other.end, abs=1e-9 * full)
    assert path.work == pytest.approx(other.work, abs=1e-8 * most * full)
    assert np.max(path.residual) < 1e-9 * most


@pytest.mark.slow
@pytest.mark.parametrize("cells", [3, examples(60, full=300)])
def test_tables_snap_where_a_follower_without_the_engine_says(cells):
    rng = np.random.default_rng(cells)
    tables = [Table(rng) for _ in range(cells)]
    path = sw.Chain([table.element() for table in tables]).cycle().path
    loading = [
        e for e in path.segments() if e.kind is sw.statics.SegmentKind.SNAP and e.direction > 0
    ]
    for snap, (cell, stroke, after) in zip(loading, snaps_of_tables(tables), strict=True):
        moved = dict(zip(snap.cells, zip(snap.before, snap.after, strict=True), strict=True))
        assert moved[cell][1] > moved[cell][0]
        assert snap.drive[0] == pytest.approx(1e-3 * stroke, abs=1e-12 * cells)
        assert snap.force[1] == pytest.approx(after, abs=1e-9)


@pytest.mark.parametrize(("rows", "scale"), [(41, 1.04), (60, 1.01), (83, 1.01)])
def test_a_fall_between_terms_that_nearly_cancel_is_no_tie(rows, scale):
    # Bounds of such terms do not decide whether U turns; their sum does.
    def table(rows: int, span: float, scale: float) -> sw.Element:
        t = np.linspace(0.0, 1.1, rows)
        force = scale * (3.0 * t - 9.0 * t**2 + 7.0 * t**3)
        return sw.Element.from_table(t * span, force, unusual=True)

    chain = sw.Chain([table(120, 0.010, 1.0), table(rows, 0.008, scale)])
    path = chain.path([0.0, chain.full_stroke])
    assert path.degenerate == ()
    assert all(event.distance_force > 1e-6 for event in path.events)


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "rows"), [(3, 40), (30, 0)])
@pytest.mark.parametrize("apart", [0.0, 1e-13])
def test_cells_alike_to_the_last_digit_give_a_sequence_with_ties_named(cells, rows, apart):
    element = Table(np.random.default_rng(0)).element(rows)
    alike = [replace(element, force_scale=1.0 + apart * k) for k in range(cells)]
    cycle = sw.Chain(alike).cycle()
    assert len(cycle.snaps) == 2 * cells
    # All but the last of each half have a rival.
    assert len(cycle.degenerate) == 2 * (cells - 1)
    assert sorted(cycle.loading_order) == list(range(cells))
    assert "Scale the forces" in cycle.degenerate[0].advice


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "stiffness"), [(66, 200.0), (90, 50.0), (90, 1000.0), (16, 0.0)])
def test_lever_cells_some_of_which_are_alike_give_a_sequence_with_ties_named(cells, stiffness):
    # 60 kinds behind a spring, slack at first, or 4 kinds without one. Alike cells that a snap
    # moves go the same way to a saddle; the flow once never said that it had come to rest there.
    kinds = 60 if stiffness else 4
    chain = sw.Chain(
        [
            sw.Cell(
                sw.Band(
                    (-0.010, 0.0),
                    (1e-3 * (i % kinds * 7 % 20), 1e-3 * (i % kinds * 11 % 30 - 15)),
                    stiffness=28.5,
                    rest_length=0.018,
                ),
                unusual=True,
            )
            for i in range(cells)
        ],
        actuator_stiffness=stiffness or np.inf,
    )
    cycle = chain.cycle()
    assert cycle.sequence.states[0] == cycle.sequence.states[-1]
    assert cycle.degenerate


@pytest.mark.parametrize("seed", [0, 2, 5])
def test_lever_cells_alike_to_eight_digits_let_go_in_their_turn(seed):
    # Where another one did, within the tolerance, the one whose turn it was took its place back.
    rng = np.random.default_rng(seed)
    stiffness = 28.5 * (1.0 + 1e-8 * rng.uniform(-1.0, 1.0, 12))
    chain = sw.Chain(
        [
            sw.Cell(
                sw.Band((-0.010, 0.0), (0.011, -0.004), stiffness=float(k), rest_length=0.018),
                unusual=True,
            )
            for k in stiffness
        ]
    )
    cycle = chain.cycle()
    assert cycle.sequence.states[-1] == "0" * 12
    assert cycle.degenerate


@pytest.mark.slow
def test_a_path_of_many_tables_needs_memory_for_what_happens_and_not_for_cells_squared():
    rng = np.random.default_rng(1)
    for cells in (50, 200):
        path = sw.Chain([Table(rng).element() for _ in range(cells)]).cycle().path
        segments, movers = path._log.used.tolist()
        assert segments <= 6 * cells
        assert movers <= 8 * cells


def test_a_long_path_that_is_not_in_balance_is_refused():
    rng = np.random.default_rng(2)
    chain = sw.Chain([Table(rng).element() for _ in range(80)])
    path = chain.cycle().path
    problem, log = path._problem, path._log
    start, sheets = np.array(path.start), np.array(path.start_sheet)
    assert certificate.audit(problem, log, start, sheets)[1] == certificate.KEPT
    # The force of the last row is a little off: the travels no longer add up to the stroke.
    spoilt = log._replace(segments=log.segments.copy())
    spoilt.segments[-1, logged.FORCE_1] += 1e-4
    assert certificate.audit(problem, spoilt, start, sheets)[1] != certificate.KEPT
    with pytest.raises(StaticsError, match="certificate"):
        outcome.refuse_broken(
            certificate.audit(problem, spoilt, start, sheets)[1], chain, 0.0, 1.0, 1.0
        )


def test_a_long_path_goes_on_where_its_log_was_full(monkeypatch):
    rng = np.random.default_rng(3)
    chain = sw.Chain([Table(rng).element() for _ in range(24)])
    whole = chain.cycle()
    empty, rooms = logged.empty_log, [(40, 200)]
    monkeypatch.setattr(logged, "empty_log", lambda *room: empty(*(rooms.pop() if rooms else room)))
    again = chain.cycle()
    assert again.sequence == whole.sequence
    assert again.path.released == pytest.approx(whole.path.released, rel=1e-12)
