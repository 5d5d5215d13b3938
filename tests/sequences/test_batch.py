"""Many designs in one call: the same as one by one, also where they tie or have no answer."""

from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import any_chain
from stepwell import elements
from stepwell.base import StepwellError
from stepwell.design.parameters import parameters
from stepwell.sequences import IMPOSSIBLE, UNSOLVED, cycles_of
from stepwell.sequences.cycles import snapping_steps
from stepwell.statics import batch, nominal

DRIVES = {"stroke": np.inf, "spring": 150.0, "force": 0.0}


def scattered(chain: sw.Chain, rng: np.random.Generator, count: int) -> list[sw.Chain]:
    """Chains of one shape with other numbers, among them twins that tie and ends that meet."""
    made = [chain]
    for k in range(1, count):
        cells = []
        for cell in chain.levers:
            bands = [
                replace(
                    band,
                    q=tuple(np.array(band.q) + rng.uniform(-0.004, 0.004, 2)),
                    stiffness=band.stiffness * rng.uniform(0.8, 1.2),
                    rest_length=band.rest_length * rng.uniform(0.5, 1.5),
                )
                for band in cell.bands
            ]
            own = {"lever": cell.lever * rng.uniform(0.95, 1.05), "mobility": rng.uniform(0.3, 3)}
            try:
                cells.append(replace(cell, band=bands, **own))
            except ValueError:
                cells.append(cell)
        if k == 1 and len(set(chain.cells)) == 1:
            cells = [cells[0]] * len(cells)
        try:
            made.append(replace(chain, cells=tuple(cells)))
        except ValueError:
            made.append(chain)
    return made


def one_by_one(chains: list[sw.Chain]):
    for chain in chains:
        try:
            yield chain.cycle()
        except sw.StepwellError:
            yield None


def assert_the_same(chains: list[sw.Chain]) -> int:
    """Every design does in the batch what its chain does by itself; how many ties there were."""
    together = cycles_of(lambda i: chains[i], len(chains), batch.stacked(chains))
    ties = 0
    for i, cycle in enumerate(one_by_one(chains)):
        if cycle is None:
            assert together.number[i] == UNSOLVED
            continue
        assert together.sequences[together.number[i]] == cycle.sequence
        assert together.tied[i] == len(cycle.degenerate)
        numbers = together.found[i]
        assert numbers[batch.SNAPS] == len(cycle.snaps)
        assert numbers[batch.PEAK] == cycle.peak_force
        assert numbers[batch.LOST] == pytest.approx(cycle.dissipated, rel=1e-12, abs=1e-15)
        assert (numbers[batch.STEPS_UP], numbers[batch.STEPS_DOWN]) == snapping_steps(cycle)
        for column, direction in ((batch.STROKE_UP, 1), (batch.STROKE_DOWN, -1)):
            first = [snap.stroke for snap in cycle.snaps if snap.direction == direction][:1]
            np.testing.assert_allclose(numbers[column], [*first, np.nan][0], rtol=1e-12)
        ties += len(cycle.degenerate) > 0
    return ties


@pytest.mark.slow
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("cells", [1, 2, 3, 4])
def test_a_batch_of_lever_chains_does_what_each_does_by_itself(cells, drive):
    rng = np.random.default_rng(10 * cells + len(drive))
    ties = 0
    for alike in (False, True, False):
        chain = any_chain(rng, cells)
        chain = replace(
            chain,
            cells=chain.cells[:1] * cells if alike else chain.cells,
            actuator_stiffness=DRIVES[drive],
        )
        ties += assert_the_same(scattered(chain, rng, 6))
    assert ties or cells == 1


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    "one",
    [
        elements.curved_beam(),
        sw.Element.from_points([0, 0.004, 0.008, 0.012], [0, 1.0, 0.2, 1.5]),
        sw.Element.from_points([0, 0.004, 0.008, 0.012], [0, 1.0, -0.4, 1.5], stops=True),
    ],
    ids=["curved beam", "open points", "stopped points"],
)
def test_a_batch_of_elements_does_what_each_does_by_itself(one, drive):
    rng = np.random.default_rng(3)
    chains = [
        sw.Chain(
            [
                replace(one, force_scale=rng.uniform(0.8, 1.2), travel_scale=rng.uniform(0.8, 1.2))
                for _ in range(2)
            ],
            actuator_stiffness=1e3 if drive == "spring" else DRIVES[drive],
        )
        for _ in range(5)
    ]
    chains.append(replace(chains[0], cells=(chains[0].cells[0],) * 2))
    assert_the_same(chains)


def test_what_no_mechanism_can_be_and_what_has_no_answer_are_distinguished(monkeypatch):
    cell = sw.Cell(sw.Band((0.0, 0.0), (0.02, 0.0)))

    def build(i: int) -> sw.Chain:
        if i == 0:
            raise ValueError("none")
        return sw.Chain([cell, cell.with_anchors(q=(0.012, 0.0))])

    designs = nominal(build(1), 3)
    assert designs is not None
    # Ends that meet, as the numbers say, and a number that is none.
    designs.bands[0, 0, :2] = -cell.lever, 0.0
    designs.bands[2, 0, 2] = np.nan
    cycles = cycles_of(build, 3, designs)
    assert cycles.number.tolist() == [IMPOSSIBLE, cycles.number[1], cycles.number[1]]
    assert cycles.sequences[cycles.number[1]] == build(1).cycle().sequence


def test_numbers_put_into_designs_are_those_of_the_changed_chain():
    rng = np.random.default_rng(5)
    chain = any_chain(rng, 2)
    for parameter in parameters(chain):
        if parameter.is_anchor:
            values = np.array(parameter.value(chain)) + rng.uniform(-1e-3, 1e-3, (3, 2))
            given = [tuple(value) for value in values.tolist()]
        elif parameter.cell is None:
            values = np.array([10.0, 0.0, np.inf])
            given = values.tolist()
        else:
            values = float(np.asarray(parameter.value(chain))) * rng.uniform(0.99, 1.01, 3)
            values += parameter.part == "friction"
            given = values.tolist()
        put = nominal(chain, 3)
        assert put is not None
        parameter.put(put, chain, values)
        made = batch.stacked([parameter.changed(chain, value) for value in given])
        for name in ("cells", "bands", "drives"):
            np.testing.assert_array_equal(getattr(put, name), getattr(made, name), parameter.name)


def test_an_empty_batch_is_empty():
    chain = any_chain(np.random.default_rng(0), 2)
    assert len(cycles_of(lambda i: chain, 0, nominal(chain, 0)).number) == 0


def test_who_follows_none_is_asked_before_a_design_is_built():
    def build(number: int) -> sw.Chain:
        raise AssertionError(f"Design {number} was built.")

    def refuse(done: float, total: float) -> None:
        raise StepwellError(f"{done} of {total}")

    with pytest.raises(StepwellError, match="0 of 40000"):
        cycles_of(build, 40_000, progress=refuse)
