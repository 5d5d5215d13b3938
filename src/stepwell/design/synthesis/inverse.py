"""Inverse design: anchors with which a chain reaches a target."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from stepwell.base import ONE_BY_ONE, QUICKLY, InputError, Progress, Vec2, check, to_unit
from stepwell.design.orders import by_cells_at_1, of_sequence, of_states, order_of, short
from stepwell.design.plane import Box
from stepwell.design.requirements import Requirements
from stepwell.design.switches import switching_forces
from stepwell.design.synthesis import region as areas
from stepwell.design.synthesis.attempt import Attempt
from stepwell.design.synthesis.candidates import LOOKS, Kind, Rule
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.elements import Allowed, ElementTarget, Range, Scaled, scaled
from stepwell.design.synthesis.region import AnchorBox, AnchorPolygon, BandType, HoleGrid, Region
from stepwell.design.synthesis.tries import Placed, TargetSearch
from stepwell.design.synthesis.weighing import checked_weights, of_requirements, weighed
from stepwell.design.targets import Target, unsearchable
from stepwell.design.tolerances.draws import (
    DEFAULT_TOLERANCES,
    CellTolerances,
    Tolerances,
    levers_of,
    refuse_slips,
)
from stepwell.design.tolerances.yields import Yield, yields
from stepwell.mechanism import Band, Chain, Element, Linear, SlipError, sizes
from stepwell.sequences import Cycle, cycle

Levers = float | Sequence[float | tuple[float, ...]]
Order = str | Sequence[int | str]

_WAY = "If the value is intended, set unusual=True."
_FREE = ("q", "p", "both")
MOST_BANDS = 10  # equal bands in a cell
_OBJECTIVES = ("yield", "worst")


def design(
    sequence: str | None = None,
    *,
    states: Iterable[str] | str | None = None,
    order: Order | None = None,
    requirements: Iterable[str] | str | None = None,
    weights: Mapping[str, float] | None = None,
    cells: int | None = None,
    within: Region | Sequence[Region] | None = None,
    holes: float | None = None,
    origin: Vec2 = (0.0, 0.0),
    p: tuple[float, float] = (-0.010, 0.0),
    q: tuple[float, float] = (0.010, 0.0),
    free: str = "q",
    bands: Sequence[BandType] = (areas.PAPER_BAND,),
    most_bands: int = 1,
    lever: Levers = areas.PAPER_LEVER,
    limit: float = math.pi / 4,
    equal_levers: bool = True,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    objective: str = "yield",
    most_force: float = math.inf,
    actuator_stiffness: float = math.inf,
    elements: Sequence[Element] = (),
    force_scale: Range = (0.5, 2.0),
    travel_scale: Range = (1.0, 1.0),
    unusual: bool = False,
    samples: int | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> Design:
    """Find anchors for a target cycle, a target order, or a target set of states.

    Cells of one taut band with falling force load in ascending F0 and unload in descending F1. So
    two orders give a cycle, and also the set of states that are reachable with early reversals.
    Each cell is chosen from the pairs (F0, F1) of the allowed anchors, bands and levers.

    With `elements`, their kinds and scales are chosen instead. Under a prescribed force the order
    of the switching forces decides the sequence. All forces of an element scale together, so a
    linear program finds the scales, or proves that there are none. Under any other drive the engine
    simulates these candidates first and then random ones. The arguments on bands, levers and
    anchors do not apply to elements. Their objective is the largest fraction by which all forces
    may deviate at once.

    Args:
        sequence: the full cycle, such as "000>100>110>111>011>001>000", inner cell first; or its
            orders of loading and unloading, such as "1-2-3/1-2-3"; or the loading order alone.
        states: all states reachable from all cells at 0, and no others, or "all". For up to eight
            cells the engine follows every branch of the nominal design and of each sample;
            `Design.reached` contains whether it did.
        order: the loading order instead, such as [2, 1, 3], with any unloading order.
        requirements: parts of a target instead, as in `Requirement`, in a list or in one text with
            semicolons, such as "2 before 1 loading; state 101". Of all orders that meet them, the
            one with the best objective is chosen. `Design.yield_` counts samples that meet them.
        weights: of "yield", "peak force", "snap energy" and "window" in the choice between
            candidates that meet the target, instead of the objective alone. Each quantity is scaled
            to 0 for the worst candidate and 1 for the best one: large yields and windows, small
            forces and energies; a negative weight reverses this.
        cells: number of cells for states="all" or requirements.
        within: regions of the free anchors, one for all cells or one for each; by default the
            paper's box, scaled with the largest lever, and its mirror image for p.
        holes: pitch of drilled holes [m]. None for anywhere.
        origin: a point of their grid [m], in the frame of each block; by default its origin,
            halfway between the lever joints.
        p, q: inner and outer anchor of every cell [m], if it is not free.
        free: which anchors are placed: "q", "p", or "both" with p = -q. Only q - p matters, so
            mirror images cover two anchors anywhere in a convex region and its image.
        bands: available bands. With a nonlinear elastic law, such as a measured one, forces are
            sampled, the engine decides, and nothing is proved. If their packs are limited, no
            design needs more bands than these hold.
        most_bands: most equal bands in a cell, all between the same two anchors; the number in
            each cell is chosen. Their stiffnesses deviate together.
        lever: r, or several to choose from [m]; each for all cells, or a tuple with one per cell.
        limit: θc of every cell [rad].
        equal_levers: whether all cells must have the same lever. If not, the engine checks whether
            the order of F0 and F1 decides; if it does not, the next best candidate is tried.
        tolerances: manufacturing tolerances, of all cells or of each.
        objective: "yield" for the largest fraction of samples that reach the target, "worst" for
            the largest displacement of all outer anchors at once, as in `robustness`.
        most_force: limit of the actuator for all |F0| and |F1| [N].
        actuator_stiffness: K, infinite for a prescribed stroke, 0 for a prescribed force [N/m].
        elements: available elements, each as often as needed.
        force_scale, travel_scale: least and largest factor of an element's own scale.
        unusual: True to accept lengths that look like unit errors, as for a Cell.
        samples: number of random samples for the yield; by default 100,000 where their critical
            forces decide the sequence, and 500 where the engine simulates each.
        seed: random seed.
        progress: called with (done, total).

    Returns:
        The design; `Design.method` describes the search. Among holes the choice is the best
        one by the objective, elsewhere a local optimum.

    Raises:
        Impossible: no allowed design reaches the target, with the proof; or none was found, as its
            text states. Among holes the closed form decides all choices of cells proved concave;
            others are simulated for some seconds, if their bands stay taut.
        ValueError: a target or a number that is not allowed, or is probably in another unit.

    Source: sorting theorem, theory page; defaults from Kamp et al. 2024, Figs. 1 and 2.
    """
    parts = None if requirements is None else Requirements.parse(requirements, cells or 0)
    sequence = _one_target(sequence, states, order, parts, samples)
    grid = _grid_of(holes, origin)
    if elements:
        _check_elements_alone(parts, weights, within, grid)
        allowed = Allowed(elements, force_scale, travel_scale, most_force, tolerances)
        goal = ElementTarget.of(sequence, states, cells)
        choice = scaled(goal, allowed, actuator_stiffness, seed, progress)
        return _design_of_elements(goal, choice, allowed, samples, seed)
    choices = lever_choices(lever)
    levers = list(itertools.chain.from_iterable(choices))
    _check_anchors(p, q, free)
    _check_sizes(bands, levers, limit)
    bands = areas.pooled(bands)
    _check_regions(within)
    if check.whole("most_bands", most_bands, 1) > MOST_BANDS:
        raise InputError(f"most_bands = {most_bands}: must be at most {MOST_BANDS}.")
    _check_objective(tolerances, objective, bands, most_force)
    fixed = q if free == "p" else p
    usual = within is None
    within = _usual_regions(choices, free) if within is None else within
    alike = _alike(choices, tolerances, within)
    target = _target(parts or sequence, states, cells, alike)
    choices = of_each_cell(choices, target.orders.cells)
    each = tolerances.each(target.orders.cells)
    regions = _regions(within, target.orders.cells)
    way = bands, float(limit), unusual, most_bands
    rule = Rule(
        (float(fixed[0]), float(fixed[1])),
        _kinds(choices, each, way),
        tolerances,
        float(most_force),
        objective == "worst",
        _enclosing_box(regions),
        free=free,
    )
    _check_units(rule, grid)
    _check_holes(regions, grid, free)
    mixed = not equal_levers and len(choices) > 1
    rules = [rule] * mixed + _one_choice_each(rule, choices, each, way)
    n = len(rules)
    search = TargetSearch(
        *(target, regions, grid, actuator_stiffness, seed, progress, n, free, usual, tuple(bands))
    )
    _check_packs(target, bands)
    _check_strokes(parts, target.orders.cells * 2.0 * max(levers) * math.sin(limit))
    placed = search.placed(rules)
    placed = weighed(search, placed, checked_weights(weights)) if weights else placed
    attempt = placed.best
    if attempt is not None:
        chain = attempt.chain(actuator_stiffness, f"Designed for {target.text}")
        how = _method(attempt, placed)
    else:
        # The union of all levers holds what each of them alone can do.
        chain, how = search.simulated(rules[:1] if mixed else rules, placed, tolerances)
    result = cycle(chain)
    criterion = _success_criterion(target.states, result, tolerances)
    count = samples or _default_samples(attempt, criterion)
    chosen = _bands_of(attempt, chain, bands)
    own = _with_spreads(tolerances, chosen)
    counted = yields(chain, own, samples=count, seed=seed, target=criterion)
    if parts is not None:
        counted = of_requirements(counted, parts)
    search.end()
    return Design(
        chain,
        result,
        counted,
        () if attempt is None else attempt.region(),
        grid,
        placed.candidates,
        placed.proved_best,
        how,
        _standing(attempt) + _not_searched(target, counted),
        chosen,
    )


def _check_elements_alone(
    parts: Requirements | None,
    weights: Mapping[str, float] | None,
    within: Region | Sequence[Region] | None,
    holes: HoleGrid | None,
) -> None:
    if parts is not None or weights:
        raise InputError("elements: leave `requirements` and `weights` out, or use bands.")
    if within is not None or holes is not None:
        raise InputError("elements have no anchors: leave `within` and `holes` out.")


def lever_choices(lever: Levers) -> list[tuple[float, ...]]:
    """The levers to choose from: one for all cells, or one per cell; InputError for others."""
    given = [lever] if not isinstance(lever, Iterable) else list(lever)
    choices = [tuple(map(float, np.atleast_1d(one))) for one in given]
    numbers = {len(one) for one in choices if len(one) != 1}
    if len(numbers) > 1 or 0 in numbers:
        raise InputError(f"lever = {lever!r}: must be one for all cells, or one for each [m].")
    return choices


def _alike(
    choices: list[tuple[float, ...]], tolerances: Tolerances, within: Region | Sequence[Region]
) -> bool:
    """Whether all cells have the same levers to choose from, tolerances, and region."""
    same = len({*tolerances.each(tolerances.cells or 1)}) == 1
    one = isinstance(within, AnchorBox | AnchorPolygon) or len({*within}) == 1
    return one and same and all(len({*levers}) == 1 for levers in choices)


def of_each_cell(choices: list[tuple[float, ...]], cells: int) -> list[tuple[float, ...]]:
    """The same with a lever of every cell; InputError for another number of cells."""
    for one in choices:
        if len(one) not in (1, cells):
            raise InputError(
                f"lever has {len(one)} lengths for {cells} cells: must be one for all, or one for "
                f"each, inner cell first."
            )
    return [one * cells if len(one) == 1 else one for one in choices]


def _usual_regions(choices: list[tuple[float, ...]], free: str) -> Region | tuple[Region, ...]:
    """The usual region of the longest lever, or of the longest one of each cell."""
    cells = max(map(len, choices), default=1)
    each = zip(*of_each_cell(choices, cells), strict=True)
    regions = tuple(areas.usual_box(max(levers), free) for levers in each)
    return regions if len({*regions}) > 1 else regions[0]


def _one_choice_each(
    rule: Rule,
    choices: list[tuple[float, ...]],
    each: Sequence[CellTolerances],
    way: tuple[Sequence[BandType], float, bool, int],
) -> list[Rule]:
    """The rule for each choice of levers alone."""
    return [replace(rule, kinds=_kinds([choice], each, way)) for choice in choices]


def _kinds(
    choices: list[tuple[float, ...]],
    each: Sequence[CellTolerances],
    way: tuple[Sequence[BandType], float, bool, int],
) -> tuple[Kind, ...]:
    """Cells with every lever and band, for the cells that may have this lever."""
    bands, limit, unusual, most_bands = way
    cells: dict[tuple[float, CellTolerances], list[int]] = {}
    for levers in choices:
        for cell, key in enumerate(zip(levers, each, strict=True)):
            cells.setdefault(key, []).append(cell)
    return tuple(
        Kind(band, lever, limit, unusual, count, frozenset(those), own)
        for (lever, own), those in cells.items()
        for band in bands
        for count in range(1, most_bands + 1)
    )


def _check_packs(target: Target, bands: Sequence[BandType]) -> None:
    """Raise Impossible if the packs hold fewer bands than there are cells."""
    held = sum(math.inf if band.pack is None else band.pack for band in bands)
    if held < target.orders.cells:
        raise Impossible(
            target.text,
            f"{target.orders.cells} cells need a band each, and the packs hold {held:g}: allow "
            f"more bands",
            proved=True,
            allowed=areas.packs_text(bands).removeprefix(" and "),
        )


def _check_strokes(parts: Requirements | None, most: float) -> None:
    for one in parts.parts if parts is not None else ():
        if one.drive > most:
            raise InputError(
                f"requirement '{one}': the stroke of this chain is at most "
                f"{to_unit(most, 'mm'):.4g} mm: give a stroke below."
            )


def _default_samples(attempt: Attempt | None, criterion: str | tuple[str, ...] | None) -> int:
    """More samples if critical forces decide their sequences."""
    by_forces = attempt is not None and not (attempt.rule.as_drawn or attempt.rule.bends)
    return QUICKLY if by_forces and isinstance(criterion, str) else ONE_BY_ONE


def _design_of_elements(
    goal: ElementTarget, choice: Scaled, allowed: Allowed, n: int | None, seed: int
) -> Design:
    chain = choice[0]
    result = cycle(chain)
    criterion = _success_criterion(goal.states, result, allowed.tolerances)
    ranges = [switching_forces(Chain([replace(one, friction=0.0)])) for one in allowed.elements]
    low, high = allowed.force_scale
    return Design(
        chain,
        result,
        yields(chain, allowed.tolerances, samples=n, seed=seed, target=criterion),
        # All forces of an element grow together: a line from the least to the largest.
        tuple(np.array([low * one, high * one]) for forces in ranges for one in forces),
        None,
        *choice[1:],
        (),
    )


def _check_regions(within: Region | Sequence[Region] | None) -> None:
    if within is None or isinstance(within, AnchorBox | AnchorPolygon):
        return
    if not within or not all(isinstance(region, AnchorBox | AnchorPolygon) for region in within):
        raise InputError(
            f"within = {within!r}: must be an AnchorBox or an AnchorPolygon, or one for each cell."
        )


def _target(
    sequence: str | Requirements | None,
    states: Iterable[str] | str | None,
    cells: int | None,
    alike: bool,
) -> Target:
    """The target; `alike` if any cell can be any other one."""
    if isinstance(sequence, Requirements):
        orders = sequence.orders(alike=alike)
        return Target(sequence.text, orders, by_states=False, requirements=sequence)
    if states is None:
        orders = of_sequence(str(sequence))
        text = str(orders.orders[0].sequence) if len(orders.orders) == 1 else f"order {sequence}"
        return Target(short(text), orders, by_states=False)
    states = states if isinstance(states, str) else tuple(states)
    every = f"all states of {cells} cells"
    text = every if states == "all" else f"states {' '.join(states)}"
    return Target(short(text), of_states(states, cells, alike), by_states=True)


def _regions(within: Region | Sequence[Region], cells: int) -> tuple[Region, ...]:
    """The region of every cell."""
    given = (within,) if isinstance(within, AnchorBox | AnchorPolygon) else tuple(within)
    if len(given) not in (1, cells):
        raise InputError(
            f"within has {len(given)} regions for {cells} cells: must be one for all, or one each."
        )
    return given if len(given) == cells else given * cells


def _one_target(
    sequence: str | None,
    states: Iterable[str] | str | None,
    order: Order | None,
    parts: Requirements | None,
    n: int | None,
) -> str | None:
    """The target sequence or order as text, None for states; ValueError unless there is one."""
    if n is not None and n < 1:
        raise InputError(f"samples = {n}: must be 1 or more.")
    if sum(one is not None for one in (sequence, states, order, parts)) != 1:
        raise InputError(
            "give one target, a sequence, an order, states or requirements: "
            'design("00>10>11>01>00"), design(order=[2, 1, 3]), '
            'design(states=["00", "10", "11"]), design(states="all", cells=3) or '
            'design(requirements="2 before 1 loading").'
        )
    if order is None:
        return sequence
    text = order if isinstance(order, str) else "-".join(map(str, order))
    if not order_of(text.partition("/")[0], ("inner", "outer")):
        raise InputError(
            f"order = {order!r}: must hold the number of every cell once, 1 for the innermost, "
            f"as in [2, 1, 3], or '2-1-3/1-2-3' with the unloading order."
        )
    return text


def _success_criterion(
    states: frozenset[str] | None, result: Cycle, tolerances: Tolerances
) -> str | tuple[str, ...]:
    """Criterion that a sample must meet: the target states, or the nominal cycle."""
    if states is None or unsearchable(result.chain, tolerances.most.friction):
        return str(result.sequence)
    return by_cells_at_1(states)


def _not_searched(target: Target, counted: Yield) -> str:
    if not target.by_states or counted.states is not None:
        return ""
    why = unsearchable(counted.chain, counted.tolerances.most.friction)
    return f"; the yield counts samples with the nominal cycle, because {why}"


def _check_anchors(p: tuple[float, float], q: tuple[float, float], free: str) -> None:
    for name, place in (("p", p), ("q", q)):
        if len(place) != 2 or not all(math.isfinite(x) for x in place):
            raise InputError(f"{name} = {place!r}: must be two finite numbers (x, y) [m].")
    if free not in _FREE:
        raise InputError(f"free = {free!r}: must be one of {_FREE}.")


def _check_sizes(bands: Sequence[BandType], levers: Sequence[float], limit: float) -> None:
    if not bands or not all(isinstance(band, BandType) for band in bands):
        raise InputError(
            f"bands = {bands!r}: must be one BandType or more, as (BandType(28.5, 0.010),)."
        )
    if not levers or not all(0 < r < math.inf for r in levers):
        raise InputError(f"lever = {levers}: must be > 0 and finite [m].")
    if not 0 < limit < math.pi / 2:
        raise InputError(f"limit = {limit} rad: must be between 0 and π/2.")


def _check_objective(
    tolerances: Tolerances, objective: str, bands: Sequence[BandType], most_force: float
) -> None:
    if not isinstance(tolerances, Tolerances):
        raise InputError(f"tolerances = {tolerances!r}: must be Tolerances(anchor=0.0003, ...).")
    if objective not in _OBJECTIVES:
        raise InputError(f"objective = {objective!r}: must be one of {_OBJECTIVES}.")
    if objective == "worst" and not all(isinstance(band.law, Linear) for band in bands):
        raise InputError(
            "objective = 'worst': its extreme forces are known for linear bands only, and a band "
            "here has a nonlinear elastic law: use objective = 'yield'."
        )
    if not most_force > 0:
        raise InputError(f"most_force = {most_force} N: must be > 0.")


def _check_units(rule: Rule, holes: HoleGrid | None) -> None:
    if rule.kinds[0].unusual:
        return
    name, around = "q" if rule.free == "p" else "p", rule.looked_at
    levers = list(dict.fromkeys(kind.lever for kind in rule.kinds))
    bands = list(dict.fromkeys(kind.band for kind in rule.kinds))
    lever = max(levers)
    corner = max(abs(around.left), abs(around.right)), max(abs(around.bottom), abs(around.top))
    slips = [slip for r in levers for slip in sizes.lever_of("lever", r)]
    if not slips:
        slips += sizes.length(name, rule.fixed, lever)
        far = [*sizes.far("within, x", corner[0], lever), *sizes.far("within, y", corner[1], lever)]
        slips += far or sizes.length("within", corner, lever)
        if holes is not None:
            slips += sizes.length("holes", holes.pitch, lever)
            slips += sizes.far("origin", holes.origin, lever)
        for band in bands:
            slips += sizes.length("rest_length", band.rest_length, lever)
            if isinstance(band.law, Linear):
                slips += sizes.spring("stiffness", band.stiffness)
    if slips:
        raise SlipError(tuple(slips), _WAY)
    strongest = max(band.stiffness for band in bands) * lever
    travel = 2.0 * lever * math.sin(rule.kinds[0].limit)
    refuse_slips(rule.tolerances, travel, strongest, _WAY)


def _grid_of(pitch: float | None, origin: Vec2) -> HoleGrid | None:
    if pitch is not None:
        return HoleGrid(pitch, origin)
    if any(origin):
        raise InputError(f"origin = {origin!r}: needs `holes`, the pitch of the grid [m].")
    return None


def _check_holes(regions: Sequence[Region], holes: HoleGrid | None, free: str) -> None:
    if holes is None:
        return
    if free == "both" and not holes.mirrored:
        raise InputError(
            f"holes {holes.shifted}: with p = -q, no p is in a hole: use an origin at multiples of "
            f"{to_unit(holes.pitch / 2, 'mm'):.4g} mm, or free one anchor, q or p."
        )
    for region in dict.fromkeys(regions):
        if len(areas.drilled(region, holes)):
            continue
        finer = holes
        for _ in range(20):
            finer = replace(finer, pitch=finer.pitch / 2)
            if len(areas.drilled(region, finer)):
                break
        raise InputError(
            f"holes {to_unit(holes.pitch, 'mm'):.4g} mm apart: none is in {region!r}. Their grid "
            f"passes {holes.shifted or 'through (0, 0), halfway between the lever joints'}: move "
            f"the region, or use holes {to_unit(finer.pitch, 'mm'):.4g} mm apart."
        )


def _enclosing_box(regions: tuple[Region, ...]) -> Box:
    boxes = [region.bounds for region in regions]
    sides = ((box.left, box.right, box.bottom, box.top) for box in boxes)
    left, right, bottom, top = zip(*sides, strict=True)
    return Box(min(left), max(right), min(bottom), max(top))


def _with_spreads(tolerances: Tolerances, chosen: Sequence[tuple[BandType, int]]) -> Tolerances:
    """The tolerances with the standard deviation of each cell's band, if it has one."""
    spreads = [band.spread for band, _ in chosen]
    if all(spread is None for spread in spreads):
        return tolerances
    each = zip(spreads, tolerances.each(len(spreads)), strict=True)
    own = tuple(t.stiffness if spread is None else spread for spread, t in each)
    return replace(tolerances, stiffness=own if len({*own}) > 1 else own[0])


def _counted(band: BandType, made: Band) -> int:
    """How many equal bands of a type a band stands for; 0 if it is of another type."""
    count = round(made.stiffness / band.stiffness)
    alike = math.isclose(count * band.stiffness, made.stiffness, rel_tol=1e-9)
    same = band.rest_length == made.rest_length and band.law == made.law
    return count * (alike and same and 1 <= count <= MOST_BANDS)


def _bands_of(
    attempt: Attempt | None, chain: Chain, bands: Sequence[BandType]
) -> tuple[tuple[BandType, int], ...]:
    """The type of band of each cell, and the number of its equal bands."""
    if attempt is not None and attempt.best is not None:
        kinds = [attempt.rule.kinds[k] for k in attempt.best.cells.kind.tolist()]
        return tuple((kind.band, kind.count) for kind in kinds)
    made = [cell.bands[0] for cell in levers_of(chain)]
    chosen = [next(b for b in bands if _counted(b, one)) for one in made]
    return tuple((b, _counted(b, one)) for b, one in zip(chosen, made, strict=True))


def _standing(attempt: Attempt | None) -> str:
    if attempt is None:
        return "not all cells are proved concave; the nominal design was simulated"
    if attempt.rule.bends:
        return (
            f"one band in tension with falling force in each cell, sampled at {LOOKS} angles in "
            f"the nominal design, which was simulated (a nonlinear elastic law allows no proof)"
        )
    where = "nominal" if attempt.rule.as_drawn else "for all anchors within the tolerances"
    return (
        f"concave cells: one band in tension with falling force in each, proved {where}; cells "
        f"load in ascending F0 and unload in descending F1, confirmed by simulation of the nominal "
        f"design"
    )


def _method(attempt: Attempt, placed: Placed) -> str:
    objective = (
        "the largest displacement of all anchors at once up to which the order stays and every "
        "cell is proved taut and concave"
        if attempt.rule.worst
        else "the product of the probabilities that neighbours in F0 and in F1 keep their order, "
        "to first order in the tolerances, with independent gaps; if no sample fails, the same "
        "with larger tolerances"
    )
    how = "complete search" if attempt.complete else "best candidate"
    places = "places" if attempt.holes is None else "holes"
    how += f" among {attempt.candidates} {places} for a band"
    if attempt.holes is None:
        how += ", then each cell in turn refined on finer lattices: a local optimum"
    if attempt.excluded:
        how += f"; {attempt.excluded} excluded (band not proved taut and concave)"
    if len(placed.attempts) > 1:
        how += f"; best of {len(placed.attempts)} combinations of orders and levers"
    how += placed.weighed
    if placed.mismatch:
        how += f"; better candidates miss the target in the simulation ({placed.mismatch})"
    if placed.others:
        how += f"; the most robust of {placed.others} random choices that reaches the target"
    return f"searched: {how}; objective: {objective}"
