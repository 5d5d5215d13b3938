"""Beginnings of snaps of several cells with friction, against a float integration of the flow."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import chains
import stepwell as sw
from oracle import OracleCell
from sizes import cases
from statics.test_against_oracle import as_oracle
from stepwell.proof import balls
from stepwell.proof.balls import UndecidedError, ball
from stepwell.proof.leaving import Beginning, SplitRadius, leave
from stepwell.proof.walk import FREE, SLIDES, EnclosedWalk, Stand
from stepwell.statics import problem_of

# How far the drive goes on beyond the start [m].
PUSH = 2e-15
# Starts whose beginning is proved; in the last ones a cell is left behind.
QUICK = 36, 52, 75, 21, 38, 88


class Start:
    """Cells that move at one λ, by the first one without friction, and those that slide."""

    def __init__(self, seed: int):
        rng = np.random.default_rng([seed, 7])
        cells = [replace(chains.any_cell(rng), friction=0.0) for _ in range(3 + seed % 2)]
        laws = [as_oracle(cell) for cell in cells]
        self.travel = np.array([rng.uniform(0.1, 0.9) * law.span for law in laws])
        force = [float(law.force(s)) for law, s in zip(laws, self.travel, strict=True)]
        self.level = force[0]
        rubs = [abs(self.level - f) for f in force]
        self.sense = [int(np.sign(self.level - f)) for f in force]
        self.laws: list[OracleCell] = laws
        self.rubs = np.array(rubs)
        chain = sw.Chain([replace(c, friction=f) for c, f in zip(cells, rubs, strict=True)])
        self.walk = EnclosedWalk(chain, problem_of(chain))
        self.mobility = np.array(self.walk.mobility)
        for i, s in enumerate(self.travel.tolist()):
            branch = self.walk.branch_at(self.walk.cells[i], ball(s), 0)
            self.walk.stands.append(
                Stand(SLIDES if self.sense[i] else FREE, ball(s), branch, self.sense[i])
            )
        self.walk.force = ball(self.level)

    def falling(self) -> list[tuple[int, int]]:
        """Cells that may lead, with their senses."""
        signs = [self.walk.branch(i).sign for i in range(len(self.travel))]
        return [(i, self.sense[i] or 1) for i, sign in enumerate(signs) if sign < 0]

    def velocities(self, travel: np.ndarray) -> np.ndarray:
        """Of the flow with friction at a prescribed stroke."""
        force = np.array([float(c.force(s)) for c, s in zip(self.laws, travel, strict=True)])

        up, down = force + self.rubs, force - self.rubs
        kinks = np.sort(np.concatenate([up, down]))[:, None]
        # Σ v is linear in λ between two of these, and 0 between the first and the last.
        rates = np.maximum(kinks - up, 0.0) - np.maximum(down - kinks, 0.0)
        total = rates @ self.mobility
        k = min(int(np.searchsorted(total, 0.0)), len(total) - 1)
        share = total[k] / (total[k] - total[k - 1])
        return self.mobility * (rates[k] + share * (rates[k - 1] - rates[k]))

    def run(self, ways: np.ndarray, along: np.ndarray, until: float) -> np.ndarray:
        """Ways of the flow from the start, at each step up to a distance along a direction."""

        def far(_: float, s: np.ndarray) -> float:
            return float(s / np.sqrt(self.mobility) @ along) - until

        far.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        rates = lambda _, s: self.velocities(self.travel + s)  # noqa: E731
        run = solve_ivp(rates, (0.0, 1e4), ways, "DOP853", events=far, rtol=1e-9, atol=1e-18)
        assert run.status == 1
        return run.y.T

    def unstable(self) -> int:
        """In how many directions a flow in which all cells slide grows."""
        root, cells = np.sqrt(self.mobility), self.walk.cells
        slopes = [balls.number(c.law(ball(s))[1]) for c, s in zip(cells, self.travel, strict=True)]
        off = np.eye(len(root)) - np.outer(root, root) / np.sum(root**2)
        return int(np.sum(np.linalg.eigvalsh(-off @ np.diag(root**2 * slopes) @ off) > 1e-9))


def beginnings(seeds: list[int]) -> Iterator[tuple[Start, tuple[int, int], Beginning]]:
    """Random starts whose beginning is proved, with their leaders."""
    for seed in seeds:
        for leader in Start(seed).falling():
            start = Start(seed)
            # Of several unstable directions a push need not find the fastest.
            if start.unstable() != 1:
                continue
            try:
                yield start, leader, leave(start.walk, leader[1], leader[0])
            except UndecidedError:
                continue


def test_the_flow_with_friction_begins_where_it_is_enclosed():
    behind = sliding = 0
    for start, leader, found in beginnings(cases(range(400), QUICK)):
        moving, root = list(found.places), np.sqrt(start.mobility)
        place = np.zeros(len(root))
        place[moving] = [balls.number(found.places[i] - start.travel[i]) for i in moving]
        length = float(np.linalg.norm(place / root))
        along = place / root / length
        push = np.zeros(len(root))
        push[leader[0]] = leader[1] * PUSH
        there = start.run(push, along, length)[-1]
        off = float(np.linalg.norm((there - place) / root))
        assert off <= float(found.radius) + 10.0 * PUSH + 1e-8 * length
        # Cells that are left behind rest; the others keep their senses up to the end of the box.
        rest = [i for i in range(len(root)) if i not in moving]
        assert np.all(np.abs(there[rest]) <= PUSH)
        behind += bool(rest)
        if found.box is None:
            continue
        for ways in start.run(there, along, 100.0 * length):
            travel = start.travel + ways
            if all(found.box[i].contains(ball(float(travel[i]))) for i in moving):
                v = start.velocities(travel)
                assert all(start.sense[i] * v[i] >= 0.0 for i in moving)
                sliding += 1
    assert behind >= 3 and sliding >= 50


def test_two_parts_of_a_radius_hold_all_differences_of_linear_flows():
    tried = 0
    for seed in range(200):
        rng = np.random.default_rng([seed, 8])
        root, slopes = np.sqrt(rng.uniform(0.5, 2.0, 3)), rng.uniform(20.0, 60.0, 3)
        slopes[0] = -rng.uniform(15.0, 25.0)
        n = root / np.linalg.norm(root)
        off = np.eye(3) - np.outer(n, n)
        matrix = -off @ np.diag(root**2 * slopes) @ off
        w = np.linalg.eigh(matrix)[1][:, -1] + 0.05 * off @ rng.normal(size=3)
        w = off @ w / np.linalg.norm(off @ w)
        delta = off @ rng.normal(size=3) * 1e-6
        along = abs(float(delta @ w))
        across = float(np.linalg.norm(delta - w * (w @ delta)))
        parts = SplitRadius([0, 1, 2], root, w, (ball(along * 1.001), ball(across * 1.001)))
        h = float(rng.uniform(1e-4, 2e-2))
        try:
            later = parts.later([ball(k) for k in slopes.tolist()], h, (ball(1e-5), ball(0.0)))
        except UndecidedError:
            continue
        after = expm(matrix * h) @ delta
        assert abs(float(after @ w)) <= float(later.along)
        assert np.linalg.norm(after - w * (w @ after)) <= float(later.across)
        tried += 1
    assert tried > 50
