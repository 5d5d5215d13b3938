"""Tolerances and levers that are given cell by cell."""

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from chains import any_chain
from facts import refuses
from stepwell.design.checks import critical_change_of_cycle, measurement
from stepwell.design.synthesis.designed import Impossible
from stepwell.design.synthesis.inverse import design
from stepwell.design.synthesis.region import AnchorBox, BandType
from stepwell.design.tolerances.draws import Draws, Tolerances

ALL = Tolerances(anchor=0.002, stiffness=0.08, rest_length=0.05, lever=0.0008, friction=0.05)
NAMES = ("anchor", "stiffness", "rest_length", "lever", "friction")


def with_values(**values: object) -> Tolerances:
    """The tolerances `ALL` with other values of some."""
    return replace(ALL, **values)  # type: ignore[arg-type]


def leg() -> sw.Chain:
    bands = (sw.Band((-0.010, 0.0), (x, 0.0), 28.5, 0.010) for x in (0.010, 0.014))
    return sw.Chain([sw.Cell(band) for band in bands])


def dome() -> sw.Chain:
    kinds = sw.mechanism.LIBRARY
    return sw.Chain([kinds[name].make() for name in ("dome", "trilinear")])


@pytest.mark.parametrize("seed", range(6))
def test_equal_tolerances_of_all_cells_give_the_samples_of_one_number(seed):
    chain = any_chain(np.random.default_rng(seed), 2 + seed % 3)
    equal = {name: (getattr(ALL, name),) * len(chain) for name in NAMES}
    one, each = Draws(chain, ALL, seed), Draws(chain, with_values(**equal), seed)
    assert one.parts == each.parts
    for number in range(20):
        try:
            expected = one.sample(number)
        except ValueError:
            continue
        assert each.sample(number) == expected
    assert chain.yields(one.tolerances, samples=50).successes == (
        chain.yields(each.tolerances, samples=50).successes
    )


def test_a_cell_without_tolerance_is_nominal_in_every_sample():
    rng = np.random.default_rng(4)
    for cells in (2, 3, 4):
        chain = any_chain(rng, cells)
        exact = int(rng.integers(cells))
        values: dict[str, Any] = {
            name: tuple(0.0 if i == exact else getattr(ALL, name) for i in range(cells))
            for name in NAMES
        }
        draws = Draws(chain, Tolerances(**values), 1)
        assert not any(part.cell == exact for part in draws.parts.values())
        seen = 0
        for number in range(40):
            try:
                sample = draws.sample(number)
            except ValueError:
                continue
            seen += 1
            assert sample.cells[exact] == chain.cells[exact]
            others = [i for i in range(cells) if i != exact]
            assert all(sample.cells[i] != chain.cells[i] for i in others)
        assert seen > 0


@pytest.mark.parametrize("seed", range(4))
def test_numbers_of_samples_equal_those_built_one_by_one(seed):
    rng = np.random.default_rng(seed)
    chain = any_chain(rng, 3)
    values: dict[str, Any] = {
        name: tuple(getattr(ALL, name) * rng.uniform(0, 1, 3)) for name in NAMES
    }
    draws = Draws(chain, Tolerances(**values), seed)
    rows = next(draws.chunks(30)).copy()
    made = draws.designs(rows)
    assert made is not None
    for row, bands in zip(rows, made.bands, strict=True):
        try:
            built = draws.built(row)
        except ValueError:
            continue
        own = [band for cell in built.levers for band in cell.bands]
        assert np.array_equal(bands[:, :2], [band.d for band in own])
        assert np.array_equal(bands[:, 2], [band.stiffness for band in own])


def brute_fraction(chain: sw.Chain, spread: np.ndarray, n: int) -> float:
    """Fraction of n legs that move the inner cell first both ways, by the paper's formulas.

    `spread` (2, 3): of each cell the radius of its anchors, the deviations of k and of the lever.
    The engine follows the first of them.
    """
    rng = np.random.default_rng(11)
    cells = chain.levers
    d = np.array([cell.bands[0].d for cell in cells])[None] + np.zeros((n, 1, 1))
    for _ in range(2):  # p and q
        away = spread[:, 0] * np.sqrt(rng.random((n, 2)))
        angle = rng.uniform(0, 2 * math.pi, (n, 2))
        d += np.stack([away * np.cos(angle), away * np.sin(angle)], axis=2)
    k = cells[0].bands[0].stiffness * (1 + spread[:, 1] * rng.standard_normal((n, 2)))
    lever = cells[0].lever + spread[:, 2] * rng.uniform(-1, 1, (n, 2))
    rest = cells[0].bands[0].rest_length

    def force(theta: float) -> np.ndarray:
        length = np.hypot(lever * math.cos(theta) + d[..., 0], lever * math.sin(theta) + d[..., 1])
        return k * (1 - rest / length) * (d[..., 1] - d[..., 0] * math.tan(theta))

    first, last = force(-math.pi / 4), force(math.pi / 4)
    right = (first[:, 0] < first[:, 1]) & (last[:, 0] > last[:, 1])
    for i in range(40):
        made = [
            sw.Cell(sw.Band((0.0, 0.0), (d[i, c, 0], d[i, c, 1]), k[i, c], rest), lever[i, c])
            for c in range(2)
        ]
        assert (str(sw.Chain(made).cycle().sequence) == "00>10>11>01>00") == right[i]
    return float(np.mean(right))


@pytest.mark.parametrize(
    "spread",
    [
        [[0.003, 0.0, 0.0], [0.0, 0.15, 0.0]],
        [[0.0, 0.2, 0.0005], [0.001, 0.0, 0.0]],
        [[0.004, 0.05, 0.0], [0.001, 0.2, 0.001]],
    ],
)
def test_yields_agree_with_samples_that_share_no_code(spread):
    chain, n = leg(), 40_000
    given = np.array(spread)
    anchor, stiffness, lever = map(tuple, given.T)
    counted = chain.yields(Tolerances(anchor, stiffness, lever=lever), samples=n)
    expected = brute_fraction(chain, given, n)
    assert 0.5 < expected < 0.99
    sigma = math.sqrt(2 * expected * (1 - expected) / n)
    assert abs(counted.fraction - expected) < 4.5 * sigma


def test_only_parts_with_a_tolerance_have_a_sensitivity():
    counted = leg().yields(
        Tolerances(anchor=(0.002, 0.0), stiffness=(0.0, 0.1)), samples=500, sensitivity=True
    )
    assert counted.sensitivities is not None
    assert counted.sensitivities.parameters == ("inner.d", "outer.stiffness")
    assert counted.sensitivities.first_order.sum() == pytest.approx(1.0, abs=0.1)


def test_elements_have_tolerances_of_their_own():
    chain = dome()
    draws = Draws(chain, Tolerances(stiffness=(0.1, 0.0), travel=(0.0, 0.1)), 2)
    for number in range(10):
        first, second = draws.sample(number).elements
        assert first.travel_scale == chain.elements[0].travel_scale
        assert second.force_scale == chain.elements[1].force_scale
        assert first.force_scale != chain.elements[0].force_scale


def test_a_check_measures_the_cell_with_the_tolerance():
    chain = leg()
    tolerances = Tolerances(anchor=(0.0, 0.004), stiffness=(0.0, 0.15))
    change = critical_change_of_cycle(chain, tolerances)
    assert change is not None and change.cell == 1
    measured = measurement(chain.yields(tolerances, samples=20_000))
    assert measured is not None and measured.cell == 1
    assert measured.now == {"d": 0.004, "stiffness": 0.15}[measured.what]


def test_a_proof_covers_the_box_of_each_cell():
    pytest.importorskip("flint")
    chain = leg()
    alone = chain.yields(Tolerances(anchor=(0.0003, 0.0), stiffness=(0.0, 0.02)), samples=10)
    proved = alone.prove()
    assert proved.proved and proved.parameters == 3  # radius and angle, and a factor
    wide = chain.yields(Tolerances(anchor=(0.0, 0.008)), samples=10).prove()
    assert wide.counterexample is not None
    assert wide.counterexample.cells[0] == chain.cells[0]


def test_wrong_tolerances_of_cells_are_refused():
    chain = leg()
    for given in ((), (0.001,), (0.001,) * 3, [[0.001, 0.001], [0.0, 0.0]], ("a", 0.0)):
        with refuses(sw.InputError, "anchor", "one"):
            chain.yields(Tolerances(anchor=given))  # type: ignore[arg-type]
    for bad in (-1e-3, math.nan, math.inf):
        with refuses(sw.InputError, "friction of cell 2", ">= 0"):
            Tolerances(friction=(0.0, bad))
    with refuses(sw.InputError, "stiffness of cell 2", "5 %"):
        Tolerances(stiffness=(0.05, 0.3))
    with refuses(sw.InputError, "mobility", "one number"):
        Tolerances(mobility=(1.0, 2.0))  # type: ignore[arg-type]
    with refuses(sw.InputError, "2 of anchor", "3 of lever"):
        Tolerances(anchor=(0.0,) * 2, lever=(0.0,) * 3)
    with refuses(sw.mechanism.SlipError, "anchor", "Did you mean"):
        chain.yields(Tolerances(anchor=(0.0, 1.0)))
    with refuses(sw.InputError, "lever", "the lever of"):
        chain.yields(Tolerances(lever=(0.0, 0.02)))


def test_text_shows_the_tolerances_of_each_cell():
    given = Tolerances(anchor=(0.001, 0.0), stiffness=0.05)
    assert str(given) == "anchors ±1 / 0 mm, stiffness ±5 %"
    assert "anchors ±1 / 0 mm" in repr(given)
    assert given != Tolerances(anchor=0.001, stiffness=0.05)


class Grid:
    """Pairs of cells on a coarse grid, each with its own lever, by the paper's formulas."""

    places = tuple((x, y) for x in (0.010, 0.015, 0.020) for y in (-0.005, 0.0, 0.005))
    box = AnchorBox(0.010, 0.020, -0.005, 0.005)

    def __init__(self, levers: tuple[float, float]):
        self.force = np.array([[self.ends(lever, q) for q in self.places] for lever in levers])

    @staticmethod
    def ends(lever: float, q: tuple[float, float]) -> list[float]:
        """F0 and F1 with p at (-10, 0) mm."""
        dx, dy, forces = q[0] + 0.010, q[1], list[float]()
        for theta in (-math.pi / 4, math.pi / 4):
            length = math.hypot(lever * math.cos(theta) + dx, lever * math.sin(theta) + dy)
            forces.append(28.5 * (1 - 0.010 / length) * (dy - dx * math.tan(theta)))
        return forces

    def best(self, inner_first: tuple[bool, bool], sigma: tuple[float, float]) -> float:
        """The largest logarithm of the chance that no order of the forces is reversed."""
        from scipy.special import log_ndtr

        found = -math.inf
        for a, b in itertools.product(*self.force.tolist()):
            gaps = [b[0] - a[0], a[1] - b[1]]
            signs = [1 if first else -1 for first in inner_first]
            ratio = [
                sign * gap / math.hypot(sigma[0] * a[end], sigma[1] * b[end])
                for end, (sign, gap) in enumerate(zip(signs, gaps, strict=True))
            ]
            if min(sign * gap for sign, gap in zip(signs, gaps, strict=True)) > 1e-9:
                found = max(found, float(sum(log_ndtr(ratio))))
        return found


@pytest.mark.parametrize(
    ("target", "first"), [("00>10>11>01>00", (True, True)), ("00>01>11>01>00", (False, True))]
)
@pytest.mark.parametrize("levers", [(0.012, 0.020), (0.020, 0.012), (0.0141, 0.0141)])
def test_the_best_pair_with_levers_and_tolerances_of_each_cell_is_found(target, first, levers):
    grid, sigma = Grid(levers), (0.20, 0.02)
    expected = grid.best(first, sigma)
    tolerances = Tolerances(stiffness=sigma)
    how: dict[str, Any] = {
        "within": grid.box,
        "holes": 0.005,
        "tolerances": tolerances,
        "lever": [levers],
    }
    if expected == -math.inf:
        with pytest.raises(Impossible):
            design(target, samples=10, **how)
        return
    made = design(target, samples=10, **how)
    assert [cell.lever for cell in made.chain.levers] == list(levers)
    assert made.sequence == target
    assert made.yield_.tolerances == tolerances
    own = Grid(levers)
    own.force = np.array([[Grid.ends(c.lever, c.bands[0].q)] for c in made.chain.levers])
    assert made.proved
    assert own.best(first, sigma) == pytest.approx(expected, rel=1e-6)


def test_levers_of_cells_are_alternatives_as_others_are():
    choices = [(0.012, 0.016), (0.016, 0.012)]
    alone = [design("00>10>11>01>00", lever=[one], holes=0.005, samples=10) for one in choices]
    both = design("00>10>11>01>00", lever=choices, holes=0.005, samples=10)
    assert tuple(c.lever for c in both.chain.levers) in choices
    assert both.chain in [one.chain for one in alone]
    mixed = design("00>10>11>01>00", lever=choices, holes=0.005, samples=10, equal_levers=False)
    assert {cell.lever for cell in mixed.chain.levers} <= {0.012, 0.016}


def test_equal_levers_of_all_cells_give_the_design_of_one_lever():
    one = design("000>100>110>111>011>001>000", lever=0.016, holes=0.005, samples=20)
    each = design("000>100>110>111>011>001>000", lever=[(0.016,) * 3], holes=0.005, samples=20)
    assert one.chain == each.chain


def test_every_cell_has_the_deviation_of_its_own_band():
    bands = (BandType(28.5, 0.010, 0.02), BandType(47.0, 0.010, 0.15))
    made = design("00>10>11>01>00", bands=bands, holes=0.005, samples=10)
    spreads = [band.spread for band, _ in made.bands]
    each = made.yield_.tolerances.each(2)
    assert [one.stiffness for one in each] == spreads


def test_wrong_levers_of_cells_are_refused():
    for lever in ([(0.012,) * 3], [(0.012, 0.016), (0.012,) * 3], [()], [(0.012, -0.016)]):
        with refuses(sw.InputError, "lever"):
            design("00>10>11>01>00", lever=lever)
    with refuses(sw.InputError, "lever", "finite"):
        design("00>10>11>01>00", lever=[(0.012, math.nan)])
    with refuses(sw.InputError, "3 tolerances for 2 cells"):
        design("00>10>11>01>00", tolerances=Tolerances(anchor=(0.0,) * 3))
