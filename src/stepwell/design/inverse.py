"""Anchors that make a chain do what is wanted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from stepwell.design._attempt import Attempt, look
from stepwell.design._box import Box
from stepwell.design._candidates import Kind, Rule
from stepwell.design._full_cycle import short
from stepwell.design._orders import NoOrders, Wish, of_sequence, of_states
from stepwell.design.designed import Design
from stepwell.design.impossible import Impossible, engine_disagrees, nothing_works
from stepwell.design.region import PAPER_BOX, AnchorBox, AnchorPolygon, Region
from stepwell.design.stock import PAPER_BAND, Stock
from stepwell.design.tolerances import Tolerances
from stepwell.design.yields import yields
from stepwell.mechanism import Chain
from stepwell.sequences import cycle, graph
from stepwell.statics import StaticsError

Levers = float | Sequence[float]

USUAL = Tolerances(anchor=0.0003, stiffness=0.05)
"""What a careful workshop with a bag of rubber bands can do."""

PAPER_LEVER = 0.010 * math.sqrt(2.0)
_OBJECTIVES = ("yield", "worst")
_REFINED = 3  # attempts
# The longest chain whose states are all looked at by the engine.
_SEEN_WHOLE = 8


def design(
    sequence: str | None = None,
    *,
    states: Iterable[str] | str | None = None,
    cells: int | None = None,
    within: Region | Sequence[Region] = PAPER_BOX,
    holes: float | None = None,
    p: tuple[float, float] = (-0.010, 0.0),
    bands: Sequence[Stock] = (PAPER_BAND,),
    lever: Levers = PAPER_LEVER,
    limit: float = math.pi / 4,
    equal_levers: bool = True,
    tolerances: Tolerances = USUAL,
    objective: str = "yield",
    most_force: float = math.inf,
    actuator_stiffness: float = math.inf,
    n: int = 100_000,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Design:
    """Find anchors for a wanted cycle, or for a wanted set of states.

    Cells of one taut band with falling force load in ascending F0 and unload in descending F1.
    So a cycle is two orders, and a set of states that can be reached, turning back early
    included, is what two orders have in common. A cell is chosen from the pairs (F0, F1) that
    the allowed anchors, bands and levers can give.

    Args:
        sequence: the full cycle, such as "000>100>110>111>011>001>000", inner cell first; or
        states: all states that shall be in reach from all cells at 0, and no others, or "all";
            looked at one by one by the engine for chains of up to eight cells.
        cells: how many, for states="all".
        within: where the outer anchors may be, for all cells or one for each.
        holes: pitch of drilled holes, counted from the lower left corner of (the rectangle
            round) the region [m]; None for anywhere.
        p: inner anchor of every cell [m].
        bands: those that can be had.
        lever: r, or several to choose from [m].
        limit: θc of every cell [rad].
        equal_levers: whether all cells must have the same lever. If not, whether the order of
            F0 and F1 decides is for the engine to say, and the next best is tried where it does
            not.
        tolerances: how far what is built may be from the drawing.
        objective: "yield" for the largest share of mechanisms that work, "worst" for the largest
            displacement that all outer anchors may have at once, as `robustness` tells.
        most_force: that the actuator has: no |F0| or |F1| is larger [N].
        actuator_stiffness: K, infinite for a prescribed stroke [N/m].
        n: mechanisms made at random for the yield.
        seed: which ones.
        progress: called with (done, total).

    Returns:
        The design; `Design.method` tells what was searched. Among holes the choice is the best
        one by the objective, elsewhere a local optimum.

    Raises:
        Impossible: nothing that is allowed does it, with the proof; or, and it says so, none was
            found.
        ValueError: a wish or a number that makes no sense.

    Source: sorting theorem, theory page; defaults from Kamp et al. 2024, Figs. 1 and 2.
    """
    wanted, wish, regions = _wanted(sequence, states, cells, within)
    levers = [float(r) for r in np.atleast_1d(lever)]
    _refuse(p, bands, levers, limit, tolerances, objective, most_force, n)
    sets = [[(band, r) for band in bands] for r in levers]
    if not equal_levers and len(levers) > 1:
        sets.insert(0, [kind for kinds in sets for kind in kinds])
    rules = [
        Rule(
            (float(p[0]), float(p[1])),
            tuple(Kind(band, r, float(limit)) for band, r in kinds),
            tolerances,
            float(most_force),
            objective == "worst",
            _round(regions),
        )
        for kinds in sets
    ]
    tasks = [(rule, orders) for rule in rules for orders in wish.orders]
    steps = len(tasks) + _REFINED + 1

    def tell(done: int) -> None:
        if progress is not None:
            progress(done, steps)

    attempts: list[Attempt] = []
    for done, (rule, orders) in enumerate(tasks):
        tell(done)
        attempts.append(look(rule, orders, regions, holes))
    attempts.sort(key=lambda attempt: attempt.quality, reverse=True)
    for k in range(min(_REFINED, len(attempts))):
        tell(len(tasks) + k)
        attempts[k] = attempts[k].refined()
    tell(steps - 1)
    found, chain, refused = _verified(wanted, attempts, wish.complete, actuator_stiffness)
    text = str(found.orders.sequence)
    share = yields(chain, _widest(found, tolerances), n=n, seed=seed, wanted=text)
    tell(steps)
    return Design(
        chain,
        text,
        found.orders.loading,
        found.orders.unloading,
        share,
        found.region(),
        holes,
        found.candidates,
        holes is not None and wish.complete and all(a.complete for a in attempts),
        _method(found, len(tasks), refused),
    )


def _verified(
    wanted: str, attempts: list[Attempt], complete: bool, actuator_stiffness: float
) -> tuple[Attempt, Chain, str]:
    """The best attempt that does by the engine what its orders say, and what a better one does."""
    attempts = sorted(attempts, key=lambda attempt: attempt.quality, reverse=True)
    working = [attempt for attempt in attempts if attempt.works]
    if not working:
        raise nothing_works(wanted, attempts, complete)
    does = ""
    for attempt in working:
        chain = attempt.chain(actuator_stiffness, f"Designed for {wanted}")
        try:
            result = cycle(chain)
        except StaticsError as failure:
            does = does or str(failure)
            continue
        if result.sequence == attempt.orders.sequence and not result.degenerate:
            return attempt, chain, does
        does = does or str(result.sequence)
    raise engine_disagrees(wanted, working[0], does)


def _reached(chain: Chain) -> frozenset[str]:
    """States with every cell at a stop that the actuator can bring the chain to from all at 0."""
    found = graph(chain, start="0" * len(chain)).reachable()
    return frozenset(label for label in found if "-" not in label)


def _wanted(
    sequence: str | None,
    states: Iterable[str] | str | None,
    cells: int | None,
    within: Region | Sequence[Region],
) -> tuple[str, Wish, tuple[Region, ...]]:
    """What is wanted as text and as orders, and the region of every cell."""
    if (sequence is None) == (states is None):
        raise ValueError(
            'say what is wanted, a sequence or states: design("00>10>11>01>00") or '
            'design(states=["00", "10", "11"]) or design(states="all", cells=3).'
        )
    some = (within,) if isinstance(within, AnchorBox | AnchorPolygon) else tuple(within)
    if not some or not all(isinstance(region, AnchorBox | AnchorPolygon) for region in some):
        raise ValueError(
            f"within = {within!r}: must be an AnchorBox or an AnchorPolygon, or one for each cell."
        )
    alike = len(set(some)) == 1
    if states is None:
        orders = of_sequence(str(sequence))
        wanted, wish = str(orders.sequence), Wish((orders,), True)
    else:
        states = states if isinstance(states, str) else tuple(states)
        every = f"all states of {cells} cells"
        wanted = every if states == "all" else f"states {' '.join(states)}"
        try:
            wish = of_states(states, cells, alike)
        except NoOrders as reason:
            raise Impossible(wanted, str(reason), proved=True) from None
    count = len(wish.orders[0])
    if len(some) not in (1, count):
        raise ValueError(
            f"within has {len(some)} regions for {count} cells: must be one for all, or one each."
        )
    return short(wanted), wish, some if len(some) == count else some * count


def _refuse(
    p: tuple[float, float],
    bands: Sequence[Stock],
    levers: Sequence[float],
    limit: float,
    tolerances: Tolerances,
    objective: str,
    most_force: float,
    n: int,
) -> None:
    if len(p) != 2 or not all(math.isfinite(x) for x in p):
        raise ValueError(f"p = {p!r}: must be two finite numbers (x, y) [m].")
    if not bands or not all(isinstance(band, Stock) for band in bands):
        raise ValueError(f"bands = {bands!r}: must be one Stock or more, as (Stock(28.5, 0.010),).")
    if not levers or not all(0 < r < math.inf for r in levers):
        raise ValueError(f"lever = {levers}: must be > 0 and finite [m].")
    if not 0 < limit < math.pi / 2:
        raise ValueError(f"limit = {limit} rad: must be between 0 and π/2.")
    if not isinstance(tolerances, Tolerances):
        raise ValueError(f"tolerances = {tolerances!r}: must be Tolerances(anchor=0.0003, ...).")
    if objective not in _OBJECTIVES:
        raise ValueError(f"objective = {objective!r}: must be one of {_OBJECTIVES}.")
    if not most_force > 0:
        raise ValueError(f"most_force = {most_force} N: must be > 0.")
    if n < 1:
        raise ValueError(f"n = {n}: must be 1 mechanism or more.")


def _round(regions: tuple[Region, ...]) -> Box:
    """The smallest rectangle round all regions."""
    boxes = [region.bounds for region in regions]
    return Box(
        min(box.left for box in boxes),
        max(box.right for box in boxes),
        min(box.bottom for box in boxes),
        max(box.top for box in boxes),
    )


def _widest(found: Attempt, tolerances: Tolerances) -> Tolerances:
    """The tolerances with the largest spread of the bands that were chosen."""
    assert found.best is not None
    chosen = [found.rule.kinds[k].band.spread for k in found.best.cells.kind.tolist()]
    spread = max(tolerances.stiffness if one is None else one for one in chosen)
    return replace(tolerances, stiffness=spread)


def _method(found: Attempt, tried: int, refused: str) -> str:
    objective = (
        "the largest displacement of all anchors at once for which the order stays and every cell "
        "is proved taut and concave"
        if found.rule.worst
        else "the product of the chances that neighbours in F0 and in F1 keep their order, to "
        "first order in the tolerances, the gaps taken as independent; where nothing fails, the "
        "same with larger tolerances"
    )
    how = "the best of all choices, by complete search," if found.complete else "the best found"
    how += f" among {found.candidates} {'places' if found.holes is None else 'holes'} for a band"
    if found.holes is None:
        how += "; from there each cell in turn on finer and finer lattices: a local optimum"
    if tried > 1:
        how += f"; the best of {tried} combinations of orders and levers"
    if refused:
        how += f"; what seemed better with unequal levers does {short(refused)} by the engine"
    if len({kind.band.spread for kind in found.rule.kinds}) > 1:
        objective += "; the yield gives all bands the widest spread of those chosen"
    return f"searched: {how}; objective: {objective}"
