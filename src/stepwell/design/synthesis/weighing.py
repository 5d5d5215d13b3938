"""Choice between candidates by weights, and the yield of requirements."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stepwell.base import Floats, InputError, ReadOnly
from stepwell.design.orders import Orders
from stepwell.design.requirements import Requirements
from stepwell.design.synthesis.attempt import Attempt, from_lattice
from stepwell.design.synthesis.tries import Placed, TargetSearch
from stepwell.design.targets import MOST_CELLS
from stepwell.design.tolerances.yields import Yield, yields
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, Unreachable, cycle
from stepwell.statics import StaticsError

# Quantities, and whether large values are good.
QUANTITIES = {"yield": True, "peak force": False, "snap energy": False, "window": True}
# Limits of the force of further candidates, as fractions of the peak force of one.
_FORCES = (0.9, 0.75, 0.6)
# Candidates that are weighed, and samples of each for its yield.
_MOST_WEIGHED, _SAMPLES = 48, 2000


def checked_weights(weights: Mapping[str, float]) -> dict[str, float]:
    """Weights by quantity; InputError for another name or number."""
    for name, weight in weights.items():
        if name not in QUANTITIES:
            raise InputError(f"weights: {name!r}: must be one of {', '.join(QUANTITIES)}.")
        if not math.isfinite(weight) or weight == 0:
            raise InputError(f"weights: {name!r} = {weight}: must be a number other than 0.")
    return {name: float(weight) for name, weight in weights.items()}


def weighed(search: TargetSearch, placed: Placed, weights: dict[str, float]) -> Placed:
    """The best candidate by weights: of each pair of orders the best, and some of less force."""
    if placed.best is None:
        return placed
    kept = [one for one in _candidates(placed) if _chain(search, one) is not None][:_MOST_WEIGHED]
    numbers = np.array([_quantities(search, one, weights) for one in kept])
    score = _scaled(numbers) @ np.array([*weights.values()])
    best = int(np.argmax(score))
    named = ", ".join(f"{name} {weight:g}" for name, weight in weights.items())
    text = f"; best by weights ({named}) of {len(kept)} candidates that meet the target"
    return replace(placed, best=kept[best], weighed=text, complete=False)


def _candidates(placed: Placed) -> list[Attempt]:
    assert placed.best is not None
    first = [placed.best, *(one for one in placed.attempts if one is not placed.best)]
    found = [one for one in first if one.meets_orders]
    for one in [*found]:
        assert one.best is not None
        peak = float(np.max(np.abs(one.best.cells.force)))
        for fraction in _FORCES:
            rule = replace(one.rule, most_force=min(one.rule.most_force, fraction * peak))
            weaker = from_lattice(rule, one.orders, one.regions, one.holes)
            if weaker.meets_orders:
                found.append(weaker)
    return found


def _chain(search: TargetSearch, attempt: Attempt) -> Chain | None:
    """The chain of an attempt, if it meets the target in the simulation."""
    chain = attempt.chain(search.actuator_stiffness, "")
    return None if search.target.fault(chain, attempt.orders) else chain


def _quantities(search: TargetSearch, attempt: Attempt, weights: dict[str, float]) -> list[float]:
    """The weighed quantities of one candidate; large values are good."""
    chain = attempt.chain(search.actuator_stiffness, "")
    result = cycle(chain)

    def of(name: str) -> float:
        if name == "yield":
            counted = yields(chain, attempt.rule.tolerances, samples=_SAMPLES, seed=search.seed)
            parts = search.target.requirements
            return (counted if parts is None else of_requirements(counted, parts)).fraction
        if name == "peak force":
            return -abs(result.peak_force)
        if name == "snap energy":
            return -sum(event.released for event in result.snaps)
        return narrowest_window(chain, search.target.requirements)

    return [of(name) for name in weights]


def narrowest_window(chain: Chain, parts: Requirements | None) -> float:
    """Half width of the narrowest window of the programs to the required states [m].

    Without required states, of the programs to all states of the full cycle.
    """
    states = [one.state for one in parts.parts if one.kind in ("state", "after")] if parts else []
    states = states or list(dict.fromkeys(cycle(chain).sequence.states))
    if len(chain) > MOST_CELLS:
        raise InputError(f"weights: 'window' is computed for up to {MOST_CELLS} cells.")
    slacks: list[float] = []
    for state in states:
        try:
            slacks.append(chain.program(state).slack)
        except (Unreachable, StaticsError):
            return 0.0
    return min(filter(math.isfinite, slacks), default=chain.full_stroke)


def _scaled(numbers: Floats) -> Floats:
    """Each column from 0 for its least number to 1 for its largest; 1 if all are equal."""
    low, span = np.min(numbers, axis=0), np.ptp(numbers, axis=0)
    return np.where(span > 0, (numbers - low) / np.where(span > 0, span, 1.0), 1.0)


def of_requirements(counted: Yield, parts: Requirements) -> Yield:
    """The yield of requirements from that of the nominal cycle: other cycles may meet them too.

    Cycles that are not listed count as failures. Of states, those that two orders give are counted.
    """
    met = {text: times for text, times in counted.outcomes.items() if _meets(text, parts)}
    others = {text: times for text, times in counted.outcomes.items() if text not in met}
    if any(one.kind == "after" for one in parts.parts):
        note = "; the requirement on a stroke in mm was checked in the nominal design only"
    else:
        note = ""
    return replace(
        counted,
        successes=counted.successes + sum(met.values()),
        target=parts.text,
        outcomes=ReadOnly(others),
        assumptions=f"{counted.assumptions}; samples whose orders meet all requirements are counted"
        + note,
    )


def _meets(text: str, parts: Requirements) -> bool:
    if ">" not in text:
        return False
    orders = Sequence.parse(text).orders
    return orders is not None and parts.met_by(Orders(*orders))
