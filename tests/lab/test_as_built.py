"""A first build: what is found out of it from what it did, and whether the advice is good."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stepwell as sw
from accounts.schemas import violations
from facts import refuses, says
from lab.machine import pair
from sizes import examples
from stepwell.accounts import account, page, terminal
from stepwell.base import StepwellError
from stepwell.design import Draws, Parameter, Tolerances, parameter
from stepwell.lab import AsBuilt, LabError, Observed, Pull, as_built, builds, pulls_of
from stepwell.lab.builds import Holes, outer_anchors, population
from stepwell.lab.first_build import best_moves

LEG = sw.preset("paper-forward")
WANTED = "00>10>11>01>00"
OFF = Tolerances(anchor=0.001, stiffness=0.05)
OFTEN_OFF = Tolerances(anchor=0.001, stiffness=0.1)


def of(number: Parameter, chain: sw.Chain) -> float:
    """Its value in a chain, in SI."""
    value = number.value(chain)
    assert isinstance(value, float)
    return value


def seen(
    build: sw.Chain, rng: np.random.Generator, pulls: tuple[Pull, ...] = (), scale: float = 0.02
) -> Observed:
    """What somebody with a ruler writes down."""
    cycle = build.cycle()

    def snaps(way: int) -> tuple[float, ...]:
        strokes = (e.drive for e in cycle.snaps if e.direction == way)
        return tuple(float(u + rng.normal(0, 1e-3)) for u in strokes)

    return Observed(str(cycle.sequence), snaps(1), snaps(-1), pulls, scale=scale)


@cache
def good() -> tuple[Observed, AsBuilt]:
    """What was seen of a build without errors, and what is found out of it."""
    observed = seen(LEG, np.random.default_rng(4))
    return observed, as_built(LEG, observed, samples=100)


@cache
def reversed_() -> list[tuple[sw.Chain, Observed, AsBuilt]]:
    """Builds that go the other way round, what was seen of them, and what is found out of it."""
    rng = np.random.default_rng(3)
    drawn = Draws(parameter(LEG, "outer.q").displaced(LEG, (-0.013, 0.0)), OFF, 7)
    builds = [drawn.sample(k) for k in range(examples(1, 40))]
    observed = [seen(build, rng) for build in builds]
    found = [as_built(LEG, one, samples=100) for one in observed]
    return list(zip(builds, observed, found, strict=True))


@pytest.mark.slow
def test_numbers_of_a_build_lie_within_their_doubt():
    """The truth is drawn as the builds are, so errors in doubts are about normal."""
    rng = np.random.default_rng(1)
    errors: list[float] = []
    for k in range(examples(1, 200)):
        truth = Draws(LEG, OFF, 101).sample(k)
        found = as_built(LEG, seen(truth, rng), OFF, samples=100)
        for one in found.known:
            value = of(one.parameter, truth)
            if one.parameter.part.startswith("q."):
                p = parameter(LEG, one.parameter.name.replace(".q.", ".p."))
                value += of(p, LEG) - of(p, truth)
            errors.append((value - one.value) / one.doubt)
    assert float(np.mean(np.square(errors))) < 1.5
    assert max(map(abs, errors)) < 4.5


@pytest.mark.slow
def test_forces_tell_a_stiffness_better_than_strokes_alone():
    truth = parameter(LEG, "outer.stiffness").scaled(LEG, 1.12)
    truth = parameter(truth, "inner.stiffness").scaled(truth, 1.12)
    cycle = truth.cycle()
    top = int(np.argmax(cycle.path.stroke))
    strokes = np.linspace(0.002, 0.036, 8)
    forces = np.interp(strokes, cycle.path.stroke[: top + 1], cycle.path.force[: top + 1])
    pulls = tuple(Pull(1, u, f) for u, f in zip(strokes.tolist(), forces.tolist(), strict=True))
    given = {"samples": 100, "wrong_hole": 0.0}
    blind = as_built(LEG, seen(truth, np.random.default_rng(2)), **given)
    told = seen(truth, np.random.default_rng(2), pulls=pulls, scale=0.01)
    weighed = as_built(LEG, told, **given)
    assert weighed.wrong == ()
    for before, after in zip(blind.known, weighed.known, strict=True):
        if before.parameter.part == "stiffness":
            assert after.identified
            assert after.doubt < 0.5 * before.doubt
            assert abs(after.value - of(after.parameter, truth)) < 3 * after.doubt


@pytest.mark.slow
def test_the_move_that_is_advised_mends_builds_that_were_reversed():
    """By the engine, on the true builds, which the advice never saw."""
    mended, promised = [], []
    for truth, _, found in reversed_():
        assert str(truth.cycle().sequence) != WANTED
        assert found.fraction == 0.0 and (found.wrong or found.wider > 1)
        move = found.moves[0]
        mended.append(str(move.of(truth).cycle().sequence) == WANTED)
        promised.append(move.fraction)
    doubt = math.sqrt(sum(p * (1 - p) for p in promised)) + 1.0
    assert abs(sum(mended) - sum(promised)) < 3 * doubt
    assert any(mended)


# Two cells that one hole turns round: d is (20, 0) mm inside and (25, 0) outside.
CLOSE = sw.Chain([sw.Cell(sw.Band((-0.010, 0.0), (x, 0.0))) for x in (0.010, 0.015)])
REVERSED = "00>01>11>10>00"


def by_hand(chain: sw.Chain, wrong: float, n: int = 200_000) -> tuple[float, float, float]:
    """How many of those that move in the other order have which cell in the hole beside its own.

    By the closed form of two concave cells, with nothing of the package: the cell with the smaller
    F0 loads first, the one with the larger F1 unloads first.
    """
    rng = np.random.default_rng(0)
    lever, limit, rest = 0.010 * 2**0.5, math.pi / 4, 0.010

    def disc() -> np.ndarray:
        far, way = 0.001 * np.sqrt(rng.random((n, 2))), rng.uniform(0, 2 * np.pi, (n, 2))
        return np.stack([far * np.cos(way), far * np.sin(way)], axis=-1)

    d = np.array([cell.bands[0].d for cell in chain.levers]) + disc() - disc()
    off = rng.random((n, 2)) < 2 * wrong
    way = rng.integers(4, size=(n, 2))
    d += 0.005 * off[..., None] * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])[way]
    k = 28.5 * (1 + 0.1 * rng.standard_normal((n, 2)))

    def force(theta: float) -> np.ndarray:
        length = np.hypot(d[..., 0] + lever * np.cos(theta), d[..., 1] + lever * np.sin(theta))
        return k * (1 - rest / length) * (d[..., 1] - d[..., 0] * np.tan(theta))

    first, last = force(-limit), force(limit)
    other = (first[:, 0] > first[:, 1]) & (last[:, 0] < last[:, 1])
    outwards, inwards = off & (way == 0), off & (way == 1)
    return (
        float(np.mean(outwards[other, 0])),
        float(np.mean(inwards[other, 1])),
        float(np.mean(other)),
    )


@pytest.mark.slow
def test_wrong_holes_are_as_likely_as_counting_says():
    near = parameter(CLOSE, "outer.q.x").changed(CLOSE, 0.0115)
    inner, outer, share = by_hand(near, 0.2)
    holes = Holes(outer_anchors(near), 0.005, 0.2)
    found = population(Draws(near, OFTEN_OFF, 1), holes, Observed(REVERSED), 150, lambda: None)
    assert found is not None and not found.few
    assert found.fraction == pytest.approx(share, abs=0.1)
    assert np.mean(found.shifts[:, 0, 0] > 0) == pytest.approx(inner, abs=0.16)
    assert np.mean(found.shifts[:, 1, 0] < 0) == pytest.approx(outer, abs=0.16)


@pytest.mark.slow
def test_an_anchor_in_the_wrong_hole_is_found_and_hooked_back():
    truth = parameter(CLOSE, "inner.q").displaced(CLOSE, (0.005, 0.0))
    truth = parameter(truth, "outer.stiffness").scaled(truth, 0.93)
    assert str(truth.cycle().sequence) == REVERSED
    found = as_built(CLOSE, seen(truth, np.random.default_rng(0)), OFTEN_OFF, samples=100)
    says(str(found.wrong[0]), "q of inner", "one", "outwards")
    assert found.fraction == 0.0
    assert str(found.moves[0].of(truth).cycle().sequence) == WANTED
    says(found.advice, "q of inner", "inwards", "(-5, 0) mm", "0 %")


@pytest.mark.slow
def test_two_anchors_are_moved_where_one_mends_half_of_the_builds():
    def with_d(inner: float, outer: float) -> sw.Chain:
        return sw.Chain([CLOSE.levers[0].with_anchors(q=(x - 0.010, 0.0)) for x in (inner, outer)])

    # One hole makes a tie of the first and mends the second; one at each cell mends both.
    built = [with_d(0.025, 0.020), with_d(0.025, 0.0245)] * 10
    best, *others = best_moves(CLOSE, built, WANTED, 0.005, 0.0, lambda: None)
    assert best.fraction == 1.0
    says(str(best), "q of inner", "inwards", "(-5, 0) mm", "q of outer", "outwards", "(5, 0) mm")
    assert all(len(move.steps) == 1 and move.fraction == 0.5 for move in others[1:])


@pytest.mark.slow
def test_a_build_that_does_what_it_should_is_left_alone():
    _, found = good()
    assert found.fraction > 0.99 and not found.moves
    assert found.advice.startswith("leave its anchors")
    assert found.wider == 1.0 and found.converged


@pytest.mark.slow
def test_estimates_that_may_change_with_more_samples_are_reported():
    _, found = good()
    for converged in (True, False):
        report = account(replace(found, converged=converged))
        assert report.record["converged"] is converged
        assert any("Not converged" in line.text for line in terminal(report)) is not converged


@pytest.mark.slow
def test_the_reported_chain_reproduces_the_observation():
    for _, observed, found in reversed_():
        assert math.isfinite(observed.misfit(found.chain.cycle()))


@pytest.mark.slow
def test_one_seed_gives_one_answer_and_another_seed_another():
    observed, first = good()
    again, other = (as_built(LEG, observed, samples=100, seed=k) for k in (0, 1))
    assert first == again
    assert first.known != other.known


@pytest.mark.slow
def test_elements_of_other_measures_have_scales_and_no_anchors():
    balloons = sw.preset("balloon")
    cycle = balloons.cycle()
    found = as_built(balloons, Observed(str(cycle.sequence)), samples=100)
    assert {one.parameter.part for one in found.known} <= {"force_scale", "travel_scale"}
    assert not found.moves and "no anchor" in found.advice


@pytest.mark.slow
def test_what_no_build_does_is_said_with_what_to_look_at(monkeypatch):
    monkeypatch.setattr(builds, "_ROUNDS", examples(2, full=builds._ROUNDS))
    with refuses(
        LabError, "none of 100", "8 times", "anchors ±1 mm", "stiffness ±10 %", "innermost"
    ):
        as_built(LEG, Observed(out=(0.001, 0.002, 0.003, 0.004)), samples=100)


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (lambda: Observed(), "no observation is given"),
        (lambda: Observed(WANTED, ruler=0.0), "ruler = 0.0"),
        (lambda: Observed(WANTED, scale=math.inf), "scale = inf"),
        (lambda: as_built(LEG, Observed("00>01>10")), "seen = '00>01>10'"),
        (lambda: as_built(LEG, Observed(WANTED), target="0>1"), "target = '0>1'"),
        (lambda: as_built(LEG, Observed(WANTED), samples=99), "samples = 99"),
        (lambda: as_built(LEG, Observed(WANTED), hole=0.0), "hole = 0.0"),
        (lambda: as_built(LEG, Observed(WANTED), wrong_hole=0.5), "wrong_hole = 0.5"),
    ],
)
def test_what_cannot_be_is_refused_with_what_may_be(wrong, why):
    with pytest.raises(StepwellError, match=why):
        wrong()


def test_forces_of_a_recording_are_those_of_the_model_it_was_made_from():
    recording = pair("x/pair_1.txt", LEG)
    pulls = pulls_of(recording, LEG.full_stroke)
    assert len(pulls) == 12 and {pull.direction for pull in pulls} == {1}
    assert Observed(pulls=pulls, scale=0.05).misfit(LEG.cycle()) < 12
    with pytest.raises(LabError, match="check the unit"):
        pulls_of(recording, 10 * LEG.full_stroke)


def test_an_observed_order_is_the_sequence_of_its_states():
    orders, states = (
        as_built(LEG, Observed(one), samples=100, target=WANTED) for one in ("1-2/1-2", WANTED)
    )
    assert orders.seen == states.seen
    assert orders.fraction == states.fraction


def test_one_build_that_agrees_shows_no_scatter_and_identifies_nothing(monkeypatch):
    drawn = Draws(LEG, OFTEN_OFF, 1)
    tried = [drawn.sample(k) for k in range(5)]
    one = builds.Population(
        [tried[0]] * 100, np.zeros(100), np.zeros((100, 2, 2)), tried, np.full(5, 0.2), 0.001, False
    )
    monkeypatch.setattr(builds, "population", lambda *_: one)
    found = as_built(LEG, Observed(WANTED), samples=100)
    assert found.single and not any(known.identified for known in found.known)
    record = account(found).record
    assert {known["doubt"] for known in record["known"]} == {None}
    assert violations(record) == []
    says(page(account(found)), "single random build", "not known")
