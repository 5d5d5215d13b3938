"""Chains of elements, followed by the engine and by code that shares nothing with it."""

import math

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from sizes import examples
from stepwell.statics import EventKind, drive_range

STIFFNESSES = (math.inf, 300.0, 0.0)


def trilinear(peak, valley, name="", *, at=1e-3, to=3e-3, stops=False):
    """From the origin up to a peak, down to a valley, and up again as steeply as at first."""
    end = to + 2e-3
    points = [0.0, at, to, end], [0.0, peak, valley, valley + 2e-3 * peak / at]
    return sw.Element.from_points(*points, name, stops=stops)


class Brute:
    """M chains of N trilinear elements at once, crept along by explicit steps of the flow."""

    def __init__(self, peak, valley, at, to, stiffness):
        self.peak, self.valley, self.at, self.to = peak, valley, at, to
        self.rise, self.fall = peak / at, (valley - peak) / (to - at)
        self.stiffness = stiffness
        steepest = np.max(np.abs([self.rise, self.fall]))
        more = stiffness * peak.shape[1] if 0 < stiffness < math.inf else 0.0
        self.step = 0.5 / (steepest + more)

    def force(self, s):
        first, middle = self.rise * s, self.peak + self.fall * (s - self.at)
        last = self.valley + self.rise * (s - self.to)
        return np.where(s < self.at, first, np.where(s < self.to, middle, last))

    def rest(self, s, drive):
        """Where the flow comes to rest at this drive, (M,)."""
        for k in range(200_000):
            if math.isinf(self.stiffness):
                # A step of the drive is taken by all alike, then the stroke is kept.
                s = s + ((drive - s.sum(axis=1)) / s.shape[1])[:, None]
            force = self.force(s)
            if math.isinf(self.stiffness):
                rate = force.mean(axis=1, keepdims=True) - force
            elif self.stiffness == 0.0:
                rate = drive[:, None] - force
            else:
                rate = (self.stiffness * (drive - s.sum(axis=1)))[:, None] - force
            s = s + self.step * rate
            if k % 20 == 0 and np.max(np.abs(rate)) < 1e-10:
                break
        return s


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_random_chains_of_elements_go_where_small_steps_of_the_flow_lead(stiffness):
    rng = np.random.default_rng(7)
    many, cells, steps = 16, 2, 40
    peak = rng.uniform(0.5, 1.5, (many, cells))
    valley = -rng.uniform(-0.2, 1.0, (many, cells))
    at = rng.uniform(0.5e-3, 1.5e-3, (many, cells))
    to = at + rng.uniform(1.5e-3, 4e-3, (many, cells))
    # The quick run takes the first of the same chains.
    many = examples(4, full=many)
    peak, valley, at, to = (drawn[:many] for drawn in (peak, valley, at, to))
    brute = Brute(peak, valley, at, to, stiffness)
    chains = [
        sw.Chain(
            [trilinear(p, v, at=a, to=t) for p, v, a, t in zip(*row, strict=True)],
            actuator_stiffness=stiffness,
        )
        for row in zip(peak, valley, at, to, strict=True)
    ]
    ends = np.array([drive_range(chain) for chain in chains])
    shares = np.concatenate([np.linspace(0, 1, steps), np.linspace(1, 0, steps)[1:]])
    drives = ends[:, :1] + shares * (ends[:, 1:] - ends[:, :1])
    here = [
        c.path([d[0]], start="0" * cells).end_configuration
        for c, d in zip(chains, drives, strict=True)
    ]
    s = np.array([one.travel for one in here])
    apart = snaps = 0
    for k in range(1, len(shares)):
        s = brute.rest(s, drives[:, k])
        for m, chain in enumerate(chains):
            path = chain.path(drives[m, k - 1 : k + 1].tolist(), start=here[m])
            here[m] = path.end_configuration
            snaps += sum(event.kind is EventKind.SNAP for event in path.events)
            apart += np.max(np.abs(s[m] - path.end)) > 1e-6
    assert snaps > many
    assert apart == 0


@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_a_curve_that_folds_back_is_the_spring_and_the_element_inside_it(stiffness):
    """In series with a spring a snap folds back; written out, the spring is a cell of its own."""
    inner, spring = trilinear(1.0, -1.0, "inner"), sw.Element.from_points([0, 1e-3], [0, 0.4])
    s = np.array([-3e-3, 0.0, 1e-3, 3e-3, 5e-3, 9e-3])
    force = np.interp(s, *inner_points(inner))
    folded = sw.Element.from_curve(*dense(s + force / 400.0, force), "folded")
    other = trilinear(0.9, -0.8, "other")
    whole = sw.Chain([other, inner, spring], actuator_stiffness=stiffness)
    part = sw.Chain([other, folded], actuator_stiffness=stiffness)
    expected = whole.cycle()
    path = part.path(expected.path.turning_points)
    assert [e.kind for e in path.events] == [e.kind for e in expected.events]
    assert [e.drive for e in path.events] == pytest.approx([e.drive for e in expected.events])
    assert path.dissipated == pytest.approx(expected.dissipated, rel=1e-6)


def inner_points(element):
    """Points of its piecewise linear curve, and of its straight ends."""
    s = np.array([-0.02, 0.0, 1e-3, 3e-3, 0.02])
    return s, element.force_at(s)


def dense(x, y):
    """The same polyline through more points, so that smooth cubics keep to it."""
    at = np.linspace(0.0, len(x) - 1.0, 40 * (len(x) - 1) + 1)
    number = np.arange(len(x))
    return np.interp(at, number, x), np.interp(at, number, y)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("levers", [False, True])
def test_a_chain_inside_an_element_does_what_it_does_written_out(stiffness, levers):
    outer = trilinear(1.0, -1.0, "outer")
    inner: list[sw.Cell | sw.Element] = [
        trilinear(1.2, -0.6),
        trilinear(0.8, -0.9, at=2e-3, to=6e-3),
    ]
    if levers:
        inner[0] = sw.Cell(sw.Band(p=(-0.010, 0.0), q=(0.010, 0.0)))
    element = sw.Element.from_chain(sw.Chain(inner), "two")
    expected = sw.Chain([outer, *inner], actuator_stiffness=stiffness).cycle()
    chain = sw.Chain([outer, element], actuator_stiffness=stiffness)
    path = chain.path(expected.path.turning_points)
    assert sum(e.kind is EventKind.SNAP for e in path.events) == len(expected.snaps)
    snaps = [e.drive for e in path.events if e.kind is EventKind.SNAP]
    reach = np.ptp(expected.path.turning_points)
    assert snaps == pytest.approx([e.drive for e in expected.snaps], abs=2e-4 * reach)
    assert path.dissipated == pytest.approx(expected.dissipated, rel=1e-4)


def test_a_snap_without_stops_is_reported_in_phases():
    cycle = sw.Chain([trilinear(1.0, -1.0), trilinear(1.2, -0.6)], actuator_stiffness=300.0).cycle()
    assert str(cycle.sequence) == "00>10>11>10>00"
    assert [e.arrivals for e in cycle.events] == [((0, 1),), ((1, 1),), ((1, 0),), ((0, 0),)]


def test_an_element_of_three_phases_has_three_digits():
    dome = sw.Element.from_law(lambda s: np.sin(s * 2e3) + 50 * s, 0.0, 6e-3, "dome")
    assert str(sw.Chain([dome], actuator_stiffness=0).cycle().sequence) == "0>1>2>1>0"


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("state", ["00", "01", "10", "11"])
def test_a_path_starts_in_any_state_that_can_stand_at_the_drive(stiffness, state):
    chain = sw.Chain([trilinear(1.0, -1.0), trilinear(1.2, -0.6)], actuator_stiffness=stiffness)
    node = chain.graph("stroke" if math.isinf(stiffness) else stiffness).node(state)
    middle = 0.5 * (node.low + node.high)
    path = chain.path([middle], start=state)
    assert sum(path.end) == pytest.approx(middle) or not math.isinf(stiffness)
    past = 0.3 * (node.high - node.low) + 1e-3
    # The last phases go on for ever; all others end above.
    beyond = node.low - past if state == "11" else node.high + past
    with refuses(ValueError, "stable from", " to "):
        chain.path([beyond], start=state)


def test_equal_elements_tie_and_the_advice_is_one_they_can_follow():
    element = sw.elements.trilinear()
    cycle = sw.Chain([element, element]).cycle()
    assert str(cycle.sequence) == "00>10>11>01>00"
    says(cycle.degenerate[0].advice, "Scale the forces", "one percent")


@pytest.mark.slow
@pytest.mark.parametrize("name", list(sw.elements.LIBRARY))
def test_equal_elements_of_the_library_snap_as_often_as_there_are_phases_to_leave(name):
    element = sw.elements.LIBRARY[name].make()
    cycle = sw.Chain([element, element]).cycle()
    assert len(cycle.snaps) <= 4
    assert len(cycle.sequence) == 5
    path = cycle.path
    assert path.work == pytest.approx(cycle.dissipated, abs=1e-9 * np.max(np.abs(path.energy)))


@pytest.mark.parametrize("name", ["von-mises-truss", "kresling", "compliant-actuator"])
def test_a_path_goes_on_from_the_very_drive_of_a_snap(name):
    chain = sw.load(f"preset:{name}")
    path = chain.cycle().path
    low, high = path.turning_points[:2]
    for event in path.events:
        if event.kind is EventKind.SNAP and event.direction > 0:
            there = chain.path([low, event.drive]).end_configuration
            for to in (low, high):
                on = chain.path([event.drive, to], start=there)
                expected = chain.path([low, event.drive, to])
                assert on.end == pytest.approx(expected.end, abs=1e-9 * chain.full_stroke)


def test_a_start_that_could_not_stand_there_is_refused_in_the_units_of_the_measure():
    balloons = sw.load("preset:balloon")
    with pytest.raises(ValueError, match=r"thin .*2000 mL .* 4\.\d+\.\.4\.\d+ kPa"):
        balloons.path([3e-3], start=[2e-3, 1e-3])
    with refuses(ValueError, "3000 mL", "start", "volume", "2000 mL"):
        balloons.path([3e-3], start=[1e-3, 1e-3])
