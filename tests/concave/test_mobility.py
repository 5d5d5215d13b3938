"""What is proved of concave cells and relays holds for any mobilities, or is not used for them."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import concave_cell, concave_chain
from sizes import examples
from stepwell.mechanism import packed
from stepwell.statics.sorted_cycle import sorted_cycle

EXACT = sw.Tolerances()


def with_mobilities(chain: sw.Chain, mobilities) -> sw.Chain:
    pairs = zip(chain.cells, np.asarray(mobilities).tolist(), strict=True)
    return replace(chain, cells=tuple(replace(cell, mobility=own) for cell, own in pairs))


def any_mobilities(chain: sw.Chain, rng: np.random.Generator) -> sw.Chain:
    return with_mobilities(chain, 10.0 ** rng.uniform(-1.5, 1.5, len(chain)))


def rests(cycle: sw.Cycle) -> list[np.ndarray]:
    """Travels of all cells after every snap [mm]."""
    return [np.round(np.array(snap.after) * 1e3, 4) for snap in cycle.snaps]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "lever"),
    [(math.inf, 0.0), (math.inf, 0.4), (300.0, 0.0), (20.0, 0.0), (0.0, 0.4)],
)
def test_end_forces_that_decide_a_cycle_decide_it_for_any_mobilities(stiffness, lever):
    rng = np.random.default_rng(7)
    judged = landed = 0
    for _ in range(examples(30 if math.isinf(stiffness) else 12, full=1200)):
        cells = [concave_cell(rng) for _ in range(int(rng.integers(2, 7)))]
        cells = [
            replace(
                cell,
                lever=cell.lever * rng.uniform(1 - lever, 1 + lever),
                friction=rng.choice([0.0, rng.uniform(0.001, 0.05)]),
            )
            for cell in cells
        ]
        chain = sw.Chain(cells, actuator_stiffness=stiffness)
        yields = chain.yields(EXACT, samples=1, target=str(chain.cycle().sequence))
        if yields.by_engine:
            continue  # not proved
        judged += 1
        there = chain.cycle()
        for _ in range(3):
            moved = any_mobilities(chain, rng).cycle()
            assert moved.sequence == there.sequence
            landed += [x.tolist() for x in rests(moved)] != [x.tolist() for x in rests(there)]
    assert judged
    if math.isinf(stiffness):
        # Else nothing was asked: mobilities did change who is left between its stops.
        assert landed


def test_sorting_is_not_used_where_mobilities_differ_since_they_change_its_landings():
    x = np.random.default_rng(16).permutation(np.linspace(0.010, 0.030, 16))
    chain = sw.Chain([sw.Cell(sw.Band((0, 0), (float(v), 0))) for v in x])
    assert sorted_cycle(packed(chain.cells)[0]) is not None
    one = np.ones(16)
    one[np.argmin([cell.force_0 for cell in chain.levers])] = 0.1
    sorted_, followed = chain.cycle(), with_mobilities(chain, one).cycle()
    assert len(followed.snaps) > len(sorted_.snaps)
    assert followed.sequence == sorted_.sequence


@pytest.mark.slow
def test_relays_under_a_prescribed_force_feel_no_mobilities():
    rng = np.random.default_rng(3)
    for _ in range(examples(8, full=400)):
        springs = [
            sw.elements.trilinear((0.004, peak), (0.012, peak - drop))
            for peak, drop in rng.uniform(0.3, 1.5, (2, 2)).tolist()
        ]
        cells = [*concave_chain(rng, 2).cells, *springs]
        chain = sw.Chain(cells, actuator_stiffness=0.0)
        there, moved = chain.cycle(), any_mobilities(chain, rng).cycle()
        assert [e.drive for e in moved.events] == [e.drive for e in there.events]
        for ours, theirs in zip(rests(moved), rests(there), strict=True):
            assert np.array_equal(ours, theirs)


@pytest.mark.slow
def test_a_pair_under_a_prescribed_stroke_feels_no_mobilities():
    rng = np.random.default_rng(4)
    for _ in range(examples(16, full=800)):
        chain = concave_chain(rng, 2)
        there, moved = chain.cycle(), any_mobilities(chain, rng).cycle()
        assert len(there.events) == len(moved.events)
        for ours, theirs in zip(moved.events, there.events, strict=True):
            assert ours.drive == pytest.approx(theirs.drive, abs=1e-12)
            assert np.allclose(ours.after, theirs.after, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_stroke_leads_from_ideal_to_ideal_for_any_mobilities():
    # Theory page, "Stroke programs", (a): turned at vertices, a chain moves as its relays do.
    rng = np.random.default_rng(5)
    for _ in range(examples(10, full=600)):
        chain = any_mobilities(concave_chain(rng, 4), rng)
        cells = chain.levers
        up, down = [c.force_0 for c in cells], [c.force_1 for c in cells]
        full, at_1 = cells[0].full_travel, set[int]()
        turns, states = [0.0], ["0000"]
        for _ in range(6):
            rises = len(at_1) == 0 or (len(at_1) < 4 and rng.random() < 0.5)
            for _ in range(int(rng.integers(1, 4 - len(at_1) + 1 if rises else len(at_1) + 1))):
                if rises:
                    at_1.add(min(set(range(4)) - at_1, key=up.__getitem__))
                else:
                    at_1.remove(max(at_1, key=down.__getitem__))
            turns.append(len(at_1) * full)
            states.append("".join("01"[k in at_1] for k in range(4)))
        for k in range(1, len(turns)):
            end = chain.path(turns[: k + 1]).end
            assert "".join("01"[s > full / 2] for s in end.tolist()) == states[k]
