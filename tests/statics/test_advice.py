"""What a tie and a lost follower advise: possible for that kind of cell, and it helps."""

import re
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from stepwell.statics import StaticsError
from stepwell.statics.following.state import GAVE_UP, NOT_SETTLED, STALLED
from stepwell.statics.outcome import refuse_failure

LEVER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
STEP = sw.Element.from_points((0.0, 0.004, 0.012, 0.016), (0.0, 1.0, -0.4, 0.8))
# Two that reach their peaks at no force at all.
LOW = sw.Element.from_points((0.0, 0.004, 0.012, 0.016), (-1.0, 0.0, -1.4, 0.4))
FLAT = sw.Element.from_points((0.0, 0.004, 0.012, 0.016), (0.0, 0.5, 0.5, 1.0))


def advised(chain: sw.Chain, index: int, advice: str) -> sw.Chain:
    """The chain with that cell changed as the advice says."""
    cells = list(chain.cells)
    one = cells[index]
    if match := re.search(r"friction of ([\d.e-]+) N", advice):
        cells[index] = replace(one, friction=float(match[1]))
    elif "Scale the forces" in advice:
        assert isinstance(one, sw.Element)
        cells[index] = replace(one, force_scale=1.011 * one.force_scale)
    else:
        assert isinstance(one, sw.Cell)
        step = re.search(r"by more than ([\d.]+) mm", advice)
        assert step is not None
        x, y = one.bands[0].q
        cells[index] = one.with_anchors(q=(x + 1.05e-3 * float(step[1]), y))
    return replace(chain, cells=cells)


@pytest.mark.parametrize(
    ("cells", "says"),
    [
        ([LEVER, LEVER], "Move an anchor of outer"),
        ([LEVER.with_anchors(q=(0.018, 0.004))] * 2, "Move an anchor of outer"),
        ([STEP, STEP], "Scale the forces of outer"),
        ([LEVER, replace(STEP, force_scale=1.0)], None),
        ([LOW, LOW], "Give outer a friction"),
        ([FLAT, FLAT], "Give its flat part a slope, or give outer a friction"),
    ],
    ids=["levers", "levers off the axis", "elements", "no tie", "at no force", "flat"],
)
def test_the_advice_on_a_tie_is_possible_for_its_cell_and_ends_it(cells, says):
    chain = sw.Chain(cells)
    ties = chain.cycle().degenerate
    assert bool(ties) == (says is not None)
    if says is not None:
        assert says in ties[0].advice
    for tie in ties:
        assert all(chain.names[i] in tie.advice for i in tie.cells)
        left = advised(chain, tie.cells[-1], tie.advice).cycle().degenerate
        assert not [one for one in left if one.drive == pytest.approx(tie.drive, abs=1e-5)]


@pytest.mark.parametrize("status", [STALLED, NOT_SETTLED, GAVE_UP])
@pytest.mark.parametrize(
    ("cells", "involved", "says"),
    [
        ([LEVER, STEP], [0], "Move an anchor of inner by 0.1 mm or more, or give it a friction"),
        ([LEVER, STEP], [1], "Scale the forces of outer by a percent or more, or give it a"),
        ([STEP] * 3, [0, 2], "Scale the forces of cell 2, cell 3 by 1, 2, … percent, each by"),
        ([LEVER] * 3, [0, 2], "Move the anchors of cell 2, cell 3 by 0.1, 0.2, … mm, each by"),
        (
            [LEVER, STEP, STEP, LEVER],
            [0, 1],
            "Scale the forces of cell 2, cell 3 by 1, 2, … percent and move the anchors of cell 4",
        ),
    ],
)
def test_a_lost_follower_names_the_cells_and_says_what_is_possible_for_them(
    status, cells, involved, says
):
    chain = sw.Chain(cells)
    with pytest.raises(StaticsError, match=re.escape(says)) as error:
        refuse_failure(status, chain, np.zeros(len(chain)), 0.5, involved)
    assert all(chain.names[i] in str(error.value) for i in involved)
    assert ("anchor" in str(error.value)) == any(isinstance(cells[i], sw.Cell) for i in involved)


@pytest.mark.parametrize("seed", [1245, 1375])
def test_alike_smooth_cells_set_apart_as_advised_are_followed(seed):
    # Two of the chains of alike cells at which the follower once gave up.
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 9))
    travel = np.cumsum(rng.uniform(0.3, 3.0, n)) * 1e-3
    force = np.cumsum(rng.uniform(-1.0, 1.0, n))
    force[-1], force[1] = force[-2] + rng.uniform(0.1, 1.0), force[0] + rng.uniform(0.1, 1.0)
    element = sw.Element.from_table(tuple(travel - travel[0]), tuple(force))
    cells = [replace(element, force_scale=1.0 + 0.01 * i) for i in range(4)]
    assert not sw.Chain(cells).cycle().degenerate


@pytest.mark.parametrize("seed", [1113, 1245, 1322, 1375])
def test_nearly_alike_cells_leave_a_saddle_against_each_other(seed):
    # Chains at which two falling cells of equal slope behind a spring were pushed the same way,
    # which is no way out.
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 9))
    travel = np.cumsum(rng.uniform(0.3, 3.0, n)) * 1e-3
    force = np.cumsum(rng.uniform(-1.0, 1.0, n))
    force[-1], force[1] = force[-2] + rng.uniform(0.1, 1.0), force[0] + rng.uniform(0.1, 1.0)
    element = sw.Element.from_table(tuple(travel - travel[0]), tuple(force))
    count, apart = int(rng.integers(3, 7)), [0.0, 0.0, 1e-9, 1e-12, 1e-11]
    cells = [
        replace(element, force_scale=1.0 + rng.choice(apart) * rng.uniform(-1.0, 1.0))
        for _ in range(count)
    ]
    stiffness = float(rng.choice([np.inf, np.inf, 100.0, 1000.0]))
    cycle = sw.Chain(cells, actuator_stiffness=stiffness).cycle()
    assert cycle.sequence.states[0] == cycle.sequence.states[-1]
    assert cycle.degenerate
