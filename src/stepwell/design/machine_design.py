"""Inverse design for state machines: chains whose strokes behave as a machine."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import InputError, Progress, notify
from stepwell.design.synthesis import region as areas
from stepwell.design.synthesis.designed import Impossible
from stepwell.design.synthesis.region import AnchorBox, BandType
from stepwell.design.tolerances.draws import DEFAULT_TOLERANCES, Draws, Tolerances
from stepwell.design.tolerances.tally import Counted
from stepwell.mechanism import Band, Cell, Chain
from stepwell.sequences import Machine, Realisation, realisations
from stepwell.statics import StaticsError

# Samples in the comparison of two candidates, and candidates that are improved.
_COMPARED, _IMPROVED = 25, 3
# First step of an improvement, as a fraction of the box, and its reduction after a failure.
_STEP, _SMALLER = 0.1, 0.9


@dataclass(frozen=True, eq=False)
class MachineDesign(Counted):
    """A chain that realises a machine, and the yield of this behaviour.

    A sample counts if the engine, from every place that the inputs reach, gives the output of the
    machine for every input, at the nominal turning points.

    Attributes:
        realisation: base, inputs, reset, and the table of all replies.
        tried: random chains that were tried.
    """

    realisation: Realisation = field(repr=False)
    tried: int

    def __str__(self):
        low, high = self.interval
        return (
            f"{self.realisation}\n\nyield {self.fraction * 100:.4g} % of {self.samples} samples "
            f"(95 % confidence: {low * 100:.4g} to {high * 100:.4g} %), {self.tolerances!r}\n"
            f"found by search among {self.tried} random chains: a local optimum"
        )

    def __repr__(self):
        return f"MachineDesign({self.realisation!r}, yield {self.fraction * 100:.4g} %)"


def machine_yield(
    realisation: Realisation,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    *,
    samples: int = 200,
    seed: int = 0,
    tried: int = 0,
) -> MachineDesign:
    """The fraction of samples within tolerances that behave as the machine."""
    made = Draws(realisation.chain, tolerances, seed)
    successes = sum(_holds(realisation, made, k) for k in range(samples))
    return MachineDesign(
        realisation,
        tried,
        chain=realisation.chain,
        tolerances=tolerances,
        samples=samples,
        seed=seed,
        successes=successes,
    )


def _holds(realisation: Realisation, made: Draws, number: int) -> bool:
    try:
        return realisation.holds_in(made.sample(number))
    except ValueError:
        return False


def design_machine(
    machine: Machine,
    *,
    cells: int = 3,
    within: AnchorBox = areas.PAPER_BOX,
    bands: Sequence[BandType] = (areas.PAPER_BAND,),
    lever: float | Sequence[float] = areas.PAPER_LEVER,
    actuator_stiffness: float = math.inf,
    by_hand: bool = False,
    turns: int = 2,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    chains: int = 200,
    steps: int = 40,
    samples: int = 200,
    seed: int = 0,
    progress: Progress = None,
) -> MachineDesign:
    """Search a chain of lever cells and inputs that behave as a machine.

    Random chains are tried. On each, all programs with up to `turns` turning points for an input
    are tried (`realisations`). The three chains with the widest intervals are improved by random
    displacements of anchors and turning points, and the best yield is chosen.

    Args:
        machine: the wanted behaviour.
        cells: number of cells.
        within: allowed outer anchors; p = (-10, 0) mm.
        bands, lever: available ones, chosen for each cell [m].
        actuator_stiffness: K, infinite for a prescribed stroke, 0 for a prescribed force [N/m].
        by_hand: also begin in states that can only be set by hand.
        turns: most turning points of an input, 1 or 2.
        tolerances: manufacturing tolerances.
        chains: number of random chains.
        steps: largest number of displacements in the improvement of each candidate.
        samples: samples of the yield.
        seed: random seed.
        progress: called with (done, total).

    Raises:
        Impossible: proved under a prescribed force where a word acts otherwise when it is repeated
            (theory page, "State machines"); otherwise none was found, which is no proof.
    """
    if not 1 <= cells <= 6 or turns not in (1, 2) or chains < 1 or samples < 1:
        raise InputError(
            f"cells = {cells}, turns = {turns}, chains = {chains}, samples = {samples}: must be 1 "
            f"to 6 cells, 1 or 2 turns, and at least 1 chain and 1 sample."
        )
    name = machine.title or "machine"
    pump = machine.pump
    if actuator_stiffness == 0 and pump is not None:
        raise Impossible(
            name,
            f"{pump}. Under a prescribed force, without friction, every word acts twice as it acts "
            f"once. Prescribe the stroke, or use a machine without such a word",
            proved=True,
        )
    rng = np.random.default_rng(seed)
    levers = [float(one) for one in np.atleast_1d(lever)]
    found: list[Realisation] = []
    for done in range(chains):
        notify(progress, done, chains)
        chain = _drawn(rng, cells, within, bands, levers)
        chain = replace(chain, actuator_stiffness=actuator_stiffness)
        found += _widest(chain, machine, by_hand, turns)
    notify(progress, chains, chains)
    if not found:
        why = f"not decided after {chains} random chains of {cells} cells; none realises it"
        if pump is not None and pump.period % 2 == 0:
            why += f". It needs two states that one program exchanges: {pump}"
        raise Impossible(name, f"{why}. Try more chains or cells, or by_hand=True", proved=False)
    found.sort(key=lambda one: -one.slack)
    best = [_improved(one, within, tolerances, rng, steps) for one in found[:_IMPROVED]]
    counted = [
        machine_yield(one, tolerances, samples=samples, seed=seed, tried=chains) for one in best
    ]
    return max(counted, key=lambda one: one.successes)


def _drawn(
    rng: np.random.Generator,
    cells: int,
    within: AnchorBox,
    bands: Sequence[BandType],
    levers: Sequence[float],
) -> Chain:
    made: list[Cell] = []
    for _ in range(cells):
        q = rng.uniform(within.left, within.right), rng.uniform(within.bottom, within.top)
        kind = bands[int(rng.integers(len(bands)))]
        band = Band((-0.010, 0.0), q, kind.stiffness, kind.rest_length)
        made.append(Cell(band, lever=levers[int(rng.integers(len(levers)))]))
    return Chain(made)


def _widest(chain: Chain, machine: Machine, by_hand: bool, turns: int) -> list[Realisation]:
    """The realisation with the widest intervals, if there is any."""
    try:
        ways = [*realisations(chain, machine, by_hand=by_hand, turns=turns)]
    except (StaticsError, ValueError):
        return []
    return [max(ways, key=lambda one: one.slack)] if ways else []


def _improved(
    first: Realisation,
    within: AnchorBox,
    tolerances: Tolerances,
    rng: np.random.Generator,
    steps: int,
) -> Realisation:
    """The realisation with its anchors displaced at random where more samples succeed."""
    if not steps:
        return first
    best, scored, step = first, _score(first, tolerances), _STEP
    for _ in range(steps):
        if scored == 2 * _COMPARED:
            break
        other = _displaced(best, within, step, rng)
        score = -1 if other is None else _score(other, tolerances)
        if other is None or score <= scored:
            step *= _SMALLER
        if other is not None and score >= scored:
            best, scored = other, score
    return best


def _score(one: Realisation, tolerances: Tolerances) -> int:
    """Successes among some samples within the tolerances, and within twice these."""
    wide = tolerances.scaled(2.0, "anchor").scaled(2.0, "stiffness", most=0.2)
    return sum(
        machine_yield(one, spread, samples=_COMPARED, seed=1).successes
        for spread in (tolerances, wide)
    )


def _displaced(
    one: Realisation, within: AnchorBox, step: float, rng: np.random.Generator
) -> Realisation | None:
    """The realisation on a chain with displaced anchors, with all intervals computed again."""
    size = step * np.array([within.right - within.left, within.top - within.bottom])
    cells: list[Cell] = []
    for cell in one.chain.levers:
        x, y = np.array(cell.bands[0].q) + size * rng.standard_normal(2)
        q = (
            float(np.clip(x, within.left, within.right)),
            float(np.clip(y, within.bottom, within.top)),
        )
        cells.append(replace(cell, band=replace(cell.bands[0], q=q)))
    try:
        chain = replace(one.chain, cells=tuple(cells))
        if not one.holds_in(chain):
            return None
        turns = max(map(len, one.inputs))
        ways = [*realisations(chain, one.machine, by_hand=one.by_hand, turns=turns)]
    except (StaticsError, ValueError):
        return None
    return max(ways, key=lambda way: way.slack, default=None)
