"""Random inverse designs against a Monte Carlo that shares no code with the yields.

Mechanisms are drawn with NumPy and judged by forces written anew: where every cell pulls less and
less, and is taut, on a fine grid of its travel, by sorting; the others, and a few of the first as a
check, by the brute-force follower of tests/oracle.py.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from oracle import OracleCell, follow
from sizes import examples
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.inverse import design
from stepwell.design.synthesis.region import AnchorBox, BandType
from stepwell.design.tolerances.draws import Tolerances

LIMIT = math.pi / 4
LEVER = 0.010 * math.sqrt(2.0)
THETA = np.linspace(-LIMIT, LIMIT, 201)


def force(theta, dx, dy, k, rest):
    """Force along travel of a band, and its length."""
    length = np.hypot(LEVER * np.cos(theta) + dx, LEVER * np.sin(theta) + dy)
    return k * (1 - rest / length) * (dy - dx * np.tan(theta)), length


def made_at_random(made: Design, n: int, rng: np.random.Generator) -> np.ndarray:
    """(n, N, 4) d_x, d_y, k, ℓ0 of mechanisms within the tolerances of a design."""
    t, cells = made.yield_.tolerances.most, made.chain.levers
    bands = np.array([(*c.bands[0].d, c.bands[0].stiffness, c.bands[0].rest_length) for c in cells])
    samples = np.tile(bands, (n, 1, 1))
    for _ in range(2):  # p and q, each anywhere in its disc
        away = t.anchor * np.sqrt(rng.random((n, len(cells))))
        angle = rng.uniform(0, 2 * math.pi, (n, len(cells)))
        samples[..., 0] += away * np.cos(angle)
        samples[..., 1] += away * np.sin(angle)
    for column, spread in ((2, t.stiffness), (3, t.rest_length)):
        normal = rng.standard_normal((n, len(cells)))
        while np.any(np.abs(normal) > 4):
            normal = np.where(np.abs(normal) > 4, rng.standard_normal(normal.shape), normal)
        samples[..., column] *= 1 + spread * normal
    return samples


def sorted_sequence(bands: np.ndarray) -> str:
    """Cells load in rising F0 and unload in falling F1."""
    f0, _ = force(-LIMIT, *bands.T)
    f1, _ = force(LIMIT, *bands.T)
    state = ["0"] * len(bands)
    states = ["".join(state)]
    for order, to in ((np.argsort(f0), "1"), (np.argsort(-f1), "0")):
        for cell in order.tolist():
            state[cell] = to
            states.append("".join(state))
    return ">".join(states)


def followed_sequence(bands: np.ndarray) -> str:
    """By the brute-force follower."""
    cells = [OracleCell(LEVER, LIMIT, [(*band, 0.0, 0.0, False)]) for band in bands.tolist()]
    full = sum(cell.span for cell in cells)
    return follow(cells, [0.0, full, 0.0], steps=200).sequence


def is_concave(bands: np.ndarray) -> bool:
    """Taut, and of falling force, on a grid of the travel."""
    for dx, dy, k, rest in bands.tolist():
        curve, length = force(THETA, dx, dy, k, rest)
        if not (np.all(np.diff(curve) < 0) and np.all(length > rest)):
            return False
    return True


def random_wish(rng: np.random.Generator) -> dict:
    """A cycle of two to five cells, in a box, of a catalogue, with tolerances."""
    cells = int(rng.integers(2, 6))
    loading, unloading = (rng.permutation(cells).tolist() for _ in range(2))
    state, states = ["0"] * cells, ["0" * cells]
    for order, to in ((loading, "1"), (unloading, "0")):
        for cell in order:
            state[cell] = to
            states.append("".join(state))
    left, bottom = rng.uniform(-0.004, 0.006), rng.uniform(-0.014, -0.002)
    return {
        "sequence": ">".join(states),
        "within": AnchorBox(
            left, left + rng.uniform(0.006, 0.016), bottom, bottom + rng.uniform(0.006, 0.016)
        ),
        "holes": 0.002 if rng.random() < 0.3 else None,
        "bands": tuple(
            BandType(rng.uniform(15, 60), rng.uniform(0.002, 0.010))
            for _ in range(int(rng.integers(1, 3)))
        ),
        "tolerances": Tolerances(
            anchor=rng.uniform(0.0005, 0.0025),
            stiffness=rng.uniform(0.02, 0.15),
            rest_length=rng.choice([0.0, 0.05]),
        ),
        "objective": str(rng.choice(["yield", "worst"])),
    }


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(examples(1, full=80)))
def test_the_yield_of_a_random_design_is_that_of_mechanisms_made_and_judged_independently(seed):
    rng = np.random.default_rng([seed, 2024])
    arguments = random_wish(rng)
    try:
        made = design(**arguments, samples=20_000)
    except Impossible:
        pytest.skip("nothing in this box does it")
    n = 4_000
    mechanisms = made_at_random(made, n, rng)
    does, brute = [], 0
    for number, bands in enumerate(mechanisms):
        if is_concave(bands):
            does.append(sorted_sequence(bands))
            if number < 2:
                assert followed_sequence(bands) == does[-1]
        elif brute < 20:
            brute += 1
            does.append(followed_sequence(bands))
    # At most a few are folded where a design may stand, and those beyond twenty are left out.
    assert len(does) > 0.9 * n
    share, ours = does.count(arguments["sequence"]) / len(does), made.yield_.fraction
    left = 1 - len(does) / n
    noise = math.sqrt(max(ours * (1 - ours), 1e-4) * (1 / n + 1 / 20_000))
    assert abs(share - ours) < 4 * noise + left
    # The verified drawing, by both.
    bands = np.array(
        [(*c.bands[0].d, c.bands[0].stiffness, c.bands[0].rest_length) for c in made.chain.levers]
    )
    assert sorted_sequence(bands) == arguments["sequence"] == followed_sequence(bands)


def test_the_rule_of_sorting_written_here_is_that_of_the_follower():
    rng = np.random.default_rng(1)
    looked_at = 0
    while looked_at < examples(2):
        cells = int(rng.integers(2, 4))
        bands = np.column_stack(
            [
                rng.uniform(0.008, 0.030, cells),
                rng.uniform(-0.012, 0.012, cells),
                rng.uniform(15, 60, cells),
                rng.uniform(0.002, 0.010, cells),
            ]
        )
        apart = [
            min(b - a for a, b in pairwise(np.sort(force(end, *bands.T)[0]).tolist()))
            for end in (-LIMIT, LIMIT)
        ]
        if is_concave(bands) and min(apart) > 0.01:
            looked_at += 1
            assert followed_sequence(bands) == sorted_sequence(bands)
