"""A verdict on a design: its rule, what breaks it, and what to measure next."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import says
from sizes import cases, examples
from stepwell import reports
from stepwell.base import StepwellError
from stepwell.design import Check, Tolerances, Verdict, check, yields
from stepwell.design.checks import _left_of, verdict_of
from stepwell.design.tolerances.yields import parts_of, with_tightened_tolerance
from stepwell.files import presets
from stepwell.mechanism import Band, Cell, Chain

CELL = Cell(Band((-0.010, 0.0), (0.010, 0.0)))
# One of each kind: a cell alone, tied cells, a spring or a force at the end, friction, slack,
# rubber, many cells, elements and volumes.
KINDS = ["paper-cell-0-0", "paper-identical", "compliant-actuator", "force-control", "friction"]
KINDS += ["slack", "rubber", "three-wave", "kresling", "balloon"]
CHAINS = [name for name in presets() if not name.startswith("robot-")]


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [
        (0.95, 1.0, Verdict.ROBUST),
        (math.nextafter(0.95, 0.0), 1.0, Verdict.MARGINAL),
        (0.3, 0.5, Verdict.MARGINAL),
        (0.3, math.nextafter(0.5, 0.0), Verdict.FAILS),
        (0.0, 0.0, Verdict.FAILS),
        (1.0, 1.0, Verdict.ROBUST),
    ],
)
def test_the_rule_holds_at_its_bounds(low, high, verdict):
    assert verdict_of(meets_target=True, tied=False, interval=(low, high)) is verdict
    assert verdict_of(meets_target=False, tied=False, interval=(low, high)) is Verdict.FAILS
    tied = verdict_of(meets_target=True, tied=True, interval=(low, high))
    assert tied is not Verdict.ROBUST


@pytest.mark.slow
def test_two_bands_in_one_hole_are_odd_once():
    band = sw.Band((-0.010, 0.0), (0.030, 0.0), 60.0, 0.025)
    chain = sw.Chain(
        [sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0), 60.0, 0.025)), sw.Cell([band, band])]
    )
    warnings = sw.check(chain, samples=60).warnings
    assert len(warnings) == len(set(warnings)) == 1


def test_a_band_that_is_extended_past_its_measured_law_is_a_warning():
    reach = CELL.bands[0].lengths(CELL.lever, CELL.limit)[1] - 0.010
    for end, warned in ((0.999 * reach, True), (reach, False)):
        extension = (0.0, 0.5 * end, end)
        band = Band.from_table((-0.010, 0.0), (0.010, 0.0), 0.010, extension, (0.0, 0.3, 0.5))
        warnings = check(Chain([Cell(band)]), samples=2).warnings
        assert any("extrapolated" in one for one in warnings) is warned


@pytest.mark.slow
def test_what_stands_between_two_sequences_never_works():
    for place in (0.010, 0.020):
        pair = Chain([CELL.with_anchors(q=(place, 0.0))] * 2)
        assert check(pair, samples=200).verdict is not Verdict.ROBUST


def random_chains(count: int) -> list[Chain]:
    rng = np.random.default_rng(12)
    chains: list[Chain] = []
    while len(chains) < count:
        places = zip(rng.uniform(0, 0.02, 2), rng.uniform(-0.015, 0.015, 2), strict=True)
        chain = Chain([CELL.with_anchors(q=(float(x), float(y))) for x, y in places])
        if not chain.cycle().degenerate:
            chains.append(chain)
    return chains


@pytest.mark.slow
def test_the_killer_breaks_it_and_a_tenth_less_does_not():
    for chain in random_chains(examples(4, full=120)):
        result = check(chain, samples=300)
        critical_change = result.critical_change
        if critical_change is None:
            continue
        wanted = str(chain.cycle().sequence)
        assert wanted == result.target
        broken, spared = (moved(critical_change, by) for by in (1.01, 0.9))
        assert str(broken.cycle().sequence) != wanted
        assert str(spared.cycle().sequence) == wanted


def moved(critical_change, by: float) -> Chain:
    """The drawing with so much of a change, by a hand of its own."""
    chain, cell = critical_change.chain, critical_change.chain.cells[critical_change.cell]
    (band,) = cell.bands
    if critical_change.parameter == "anchor":
        dx, dy = (by * one for one in critical_change.move)
        band = replace(band, q=(band.q[0] + dx, band.q[1] + dy))
        cell = replace(cell, band=band)
    elif critical_change.parameter == "stiffness":
        cell = replace(
            cell, band=replace(band, stiffness=band.stiffness * (1 + by * critical_change.move))
        )
    else:
        raise AssertionError(critical_change.parameter)
    cells = list(chain.cells)
    cells[critical_change.cell] = cell
    return replace(chain, cells=tuple(cells))


@pytest.mark.slow
def test_wider_tolerances_never_make_a_verdict_better():
    order = [Verdict.FAILS, Verdict.MARGINAL, Verdict.ROBUST]
    for chain in random_chains(examples(2, full=80)):
        ranks = [
            order.index(check(chain, None, Tolerances(anchor, 0.05), samples=2000).verdict)
            for anchor in (0.0001, 0.001, 0.004)
        ]
        assert ranks == sorted(ranks, reverse=True)


@pytest.mark.slow
def test_the_measurement_named_is_the_best_of_all_by_counting_each():
    tried = 0
    for chain in random_chains(examples(5, full=200)):
        tolerances = Tolerances(0.0015, 0.10)
        result = check(chain, None, tolerances, samples=4000)
        counted = yields(chain, tolerances, samples=4000, target=result.target)
        each = {
            name: with_tightened_tolerance(
                counted, name, _left_of(tolerances.most, part.tolerance), 4000
            )
            for name, part in parts_of(counted).items()
        }
        best = max(each.values(), default=counted.successes)
        if result.measure is None:
            assert best < counted.successes + 0.005 * 4000 or counted.successes == 4000
            continue
        tried += 1
        assert round(result.measure.after * 4000) == best > counted.successes
    assert tried


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(CHAINS, KINDS))
def test_every_design_gets_a_verdict(name):
    result = check(sw.load(f"preset:{name}"), samples=20)
    assert isinstance(result, Check) and result.reason
    assert result.meets_target and math.isfinite(result.peak_force)
    assert result.verdict in (Verdict.MARGINAL, Verdict.ROBUST, Verdict.FAILS)


@pytest.mark.slow
def test_a_program_is_checked_by_where_it_ends():
    hand = sw.load("preset:finger-selector")
    program = hand.program("00100")
    result = check(hand, program, samples=60)
    assert result.target == "00000 to 00100" and result.meets_target
    assert result.critical_change is not None
    broken = result.critical_change.design
    assert broken is not None


def test_a_nominal_design_that_misses_its_target_fails():
    result = check(sw.load("preset:paper-forward"), "00>01>11>10>00", samples=100)
    assert result.verdict is Verdict.FAILS and result.critical_change is None
    says(result.reason, "nominal", "00>10>11>01>00")


def test_a_program_of_another_chain_and_no_cycle_are_refused():
    hand = sw.load("preset:finger-selector")
    with pytest.raises(StepwellError, match="of another"):
        check(sw.load("preset:paper-forward"), hand.program("00100"))
    with pytest.raises(StepwellError, match="target"):
        check(hand, "0>1")


@pytest.mark.slow
def test_the_page_of_a_check_shows_what_those_built_do_and_moves(tmp_path):
    reports.write(check(sw.preset("paper-forward"), samples=60), tmp_path)
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "data:image/svg+xml" in page and "<iframe" in page
