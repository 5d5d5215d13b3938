"""The paper's claims about cells and chains, each with its proof by enclosures, or why it has none.

Needs python-flint, the extra `proof`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

from stepwell import proof as proving
from stepwell.base import ByValue, Floats, Progress, to_unit, tracked
from stepwell.mechanism import Cell
from stepwell.paper import cells, order, pathways
from stepwell.paper.claims import Claim
from stepwell.sequences import Cycle, Pathway

# Narrowest rectangle of the map [m], and the number of bands of the claims on its shares.
_FINEST = 3e-6


@dataclass(frozen=True, slots=True, eq=False)
class ClaimProof(ByValue):
    """What is proved of a claim.

    Attributes:
        claim: the claim.
        outcome: proved, refuted, or not decided.
        statement: what exactly is proved, or why nothing is.
    """

    claim: Claim
    outcome: proving.BoxOutcome
    statement: str


Proof = tuple[proving.BoxOutcome, str]
Ranges = tuple[tuple[float, float], ...]


def _decided(holds: bool, statement: str) -> Proof:
    return (proving.BoxOutcome.PROVED if holds else proving.BoxOutcome.UNDECIDED), statement


def _forces(q: str) -> Proof:
    cell = cells.six_cells()[q]
    scale = cell.bands[0].stiffness * cell.lever
    limit = cells.FORCE_TOLERANCE * scale
    ranges = proving.critical_ranges(cell)
    near = all(
        abs(end - number * scale) <= limit
        for one, number in zip(ranges, cells.FORCES[q], strict=True)
        for end in one
    )
    return _decided(near, "enclosed F0 and F1")


def _force_falls() -> Proof:
    done = sum(map(proving.falling, cells.six_cells().values()))
    return _decided(done == 6, f"κ < 0 on boxes that cover the travel, {done} of 6 cells")


def _theta_max() -> Proof:
    return _decided(
        all(_peak_is_near(cell) for cell in cells.six_cells().values()),
        "F falls, and changes its sign within 0.001° of Eq. 3, or has one sign",
    )


def _peak_is_near(cell: Cell) -> bool:
    (low_0, high_0), (low_1, high_1) = proving.critical_ranges(cell)
    angle = math.atan2(*cell.bands[0].d[::-1])
    if not proving.falling(cell):
        return False
    if abs(angle) >= cell.limit:
        return high_0 < 0 if angle < 0 else low_1 > 0
    off = math.radians(cells.PEAK_TOLERANCE)
    before, after = (proving.force_range(cell, math.sin(angle + way * off)) for way in (-1, 1))
    return before[0] > 0 > after[1] and low_0 > 0 > high_1


def _bistable() -> Proof:
    signs = {q: proving.critical_ranges(cell) for q, cell in cells.six_cells().items()}
    stable = [q for q, ((low, _), (_, high)) in signs.items() if low > 0 > high]
    decided = [q for q, ends in signs.items() if all(low > 0 or high < 0 for low, high in ends)]
    holds = len(decided) == 6 and set(signs) - set(stable) == set(cells.MONOSTABLE)
    return _decided(holds, "signs of the enclosed F0 and F1")


@cache
def _path_proof(pathway: Pathway) -> "proving.PathProof":
    return cells.pair_cycle(pathway).path.prove()


def _pathway(pathway: Pathway) -> Proof:
    proof = _path_proof(pathway)
    return _decided(proof.proved, f"all {len(proof.events)} events of its cycle, and no others")


def _sequential() -> Proof:
    pairs = [cells.pair_cycle(one).chain for one in cells.PAIRS]
    falls = all(proving.falling(cell) for chain in pairs for cell in chain.levers)
    proved = all(_path_proof(one).proved for one in cells.PAIRS)
    return _decided(
        falls and proved, "the four cycles; two cells of falling force between stops are unstable"
    )


def _no_snap() -> Proof:
    proofs = [_path_proof(one) for one in cells.PAIRS if not one.is_directed]
    snaps = any(event.theorem for proof in proofs for event in proof.events)
    holds = all(proof.proved for proof in proofs) and not snaps
    return _decided(
        holds, "the cycles of both pairs; for the map's other designs the theorem says it"
    )


def _directed_snaps() -> Proof:
    far: list[float] = []
    for pathway in (one for one in cells.PAIRS if one.is_directed):
        proof = _path_proof(pathway)
        if not proof.proved:
            return _decided(False, proof.outcome)
        far += [
            abs(_corner(proof, one.event.direction) - one.event.stroke) + one.stroke_error
            for one in proof.events
            if one.theorem
        ]
    worst = f"{to_unit(max(far), 'mm'):.3f} mm"
    return _decided(
        max(far) <= pathways.NEAR, f"{len(far)} snaps, at most {worst} from the corners"
    )


def _corner(proof: "proving.PathProof", direction: int) -> float:
    return proof.path.chain.full_stroke if direction > 0 else 0.0


def _wells() -> Proof:
    held = 1
    chain = cells.monostable_pair().chain
    for cell in chain.levers:
        (low_0, high_0), (low_1, high_1) = proving.critical_ranges(cell)
        if not proving.falling(cell) or low_0 <= 0 <= high_0 or low_1 <= 0 <= high_1:
            return _decided(False, "a cell at a stop with no force")
        held *= (low_0 > 0) + (high_1 < 0)
    return _decided(held == 2, "two wells: both cells fall, and the signs of four enclosed forces")


def _orders(chains: Callable[[], list[Cycle]]) -> Proof:
    cycles = chains()
    done = sum(proving.sorted_as(cycle) for cycle in cycles)
    return _decided(
        done == len(cycles), f"the theorem's conditions, {done} of {len(cycles)} chains"
    )


# The map: its area divided until each rectangle has one pathway.


@cache
def map_areas() -> tuple[Floats, Floats]:
    """Rectangles (m, 4) of the map [m] with one pathway each, proved, and its number (m,).

    The number is that of `Pathway`; -1 where it is not decided.
    """
    inner = cells.pair_cycle(Pathway.CLOCKWISE).chain.levers[0]
    own = proving.critical_ranges(inner)
    codes = {one: k for k, one in enumerate(Pathway)}
    waiting = [(0.0, 0.020, -0.015, 0.015, False)]
    boxes: list[tuple[float, float, float, float]] = []
    found: list[int] = []
    while waiting:
        left, right, bottom, top, falls = waiting.pop()
        place = (left + right) / 2, (bottom + top) / 2
        cell = inner.with_anchors(q=place)
        reach = (right - left) / 2, (top - bottom) / 2
        taken = _taken(own, proving.critical_ranges(cell, reach))
        falls = falls or proving.falling(cell, reach)
        if taken is not None and falls:
            boxes.append((left, right, bottom, top))
            found.append(codes[taken])
        elif max(reach) < _FINEST:
            boxes.append((left, right, bottom, top))
            found.append(-1)
        elif right - left > top - bottom:
            waiting += [(left, place[0], bottom, top, falls), (place[0], right, bottom, top, falls)]
        else:
            waiting += [(left, right, bottom, place[1], falls), (left, right, place[1], top, falls)]
    return np.array(boxes), np.array(found)


def _taken(inner: Ranges, outer: Ranges) -> Pathway | None:
    """The pathway of two cells by their enclosed F0 and F1; None where these overlap."""
    first: list[bool] = []
    for (a, b), (c, d) in zip(inner, outer, strict=True):
        if not (b < c or d < a):
            return None
        first.append(b < c)
    # Loading takes the inner cell first where its F0 is the smaller one, unloading where its F1
    # is the larger one.
    loading, unloading = first[0], not first[1]
    if loading == unloading:
        return Pathway.CLOCKWISE if loading else Pathway.COUNTERCLOCKWISE
    return Pathway.VIA_10 if loading else Pathway.VIA_01


def _shares(band: Callable[[Floats], Floats], *codes: int) -> tuple[float, float]:
    """Least and largest fraction of area with one of these pathways, in a part of the map."""
    boxes, found = map_areas()
    parts = band(boxes)
    area = np.maximum(parts[:, 1] - parts[:, 0], 0) * np.maximum(parts[:, 3] - parts[:, 2], 0)
    low, whole = float(np.sum(area[np.isin(found, codes)])), float(np.sum(area))
    return low / whole, (low + float(np.sum(area[found < 0]))) / whole


def _share(pathway: Pathway) -> Proof:
    low, high = _shares(lambda boxes: boxes, list(Pathway).index(pathway))
    number = pathways.SHARES[pathway]
    near = number - pathways.SHARE_TOLERANCE <= low and high <= number + pathways.SHARE_TOLERANCE
    return _decided(near, f"between {low:.5f} and {high:.5f}")


def _clipped(axis: int, low: float, high: float) -> Callable[[Floats], Floats]:
    def clip(boxes: Floats) -> Floats:
        out = boxes.copy()
        out[:, 2 * axis : 2 * axis + 2] = np.clip(out[:, 2 * axis : 2 * axis + 2], low, high)
        return out

    return clip


def _rises(shares: list[tuple[float, float]]) -> bool:
    return all(a[1] < b[0] for a, b in pairwise(shares))


def _undirected_by_y() -> Proof:
    codes = [k for k, one in enumerate(Pathway) if one in (Pathway.VIA_01, Pathway.VIA_10)]
    shares: list[tuple[float, float]] = []
    for low in (0.0, 0.005, 0.010):
        two = [_shares(_clipped(1, *ends), *codes) for ends in _both(low)]
        shares.append((sum(s[0] for s in two) / 2, sum(s[1] for s in two) / 2))
    return _decided(_rises(shares), f"enclosed shares {_listed(shares)}")


def _both(low: float) -> tuple[tuple[float, float], tuple[float, float]]:
    return (low, low + 0.005), (-low - 0.005, -low)


def _directed_by_x() -> Proof:
    directed = (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)
    codes = [k for k, one in enumerate(Pathway) if one in directed]
    shares = [_shares(_clipped(0, x, x + 0.005), *codes) for x in (0.0, 0.005, 0.010, 0.015)]
    refuted = any(a[0] > b[1] for a, b in pairwise(shares))
    outcome, text = _decided(_rises(shares), f"enclosed shares {_listed(shares)}")
    return (proving.BoxOutcome.REFUTED if refuted else outcome), text


def _listed(shares: list[tuple[float, float]]) -> str:
    return ", ".join(f"{low:.3f}–{high:.3f}" for low, high in shares)


def _identity() -> Proof:
    return _decided(False, "an identity of formulas; it is compared on samples")


def _proofs() -> dict[str, Callable[[], Proof]]:
    named: dict[str, Callable[[], Proof]] = {
        "curves": _identity,
        "force-falls": _force_falls,
        "theta-max": _theta_max,
        "bistable": _bistable,
        "sequential": _sequential,
        "undirected-boundary": _no_snap,
        "directed-snaps": _directed_snaps,
        "wells": _wells,
        "order-two-cells": lambda: _orders(order.random_pairs),
        "order-many-cells": lambda: _orders(order.random_chains),
        "large-qy-undirected": _undirected_by_y,
        "large-qx-directed": _directed_by_x,
    }
    named |= {cells.force_id(q): lambda q=q: _forces(q) for q in cells.FORCES}
    for one in Pathway:
        label = one.label.replace(" ", "-")
        named[f"pathway-{label}"] = lambda one=one: _pathway(one)
        named[f"share-{label}"] = lambda one=one: _share(one)
    return named


def claim_proofs(progress: Progress = None) -> tuple[ClaimProof, ...]:
    """Prove the paper's claims about unit cells, pairs and chains; those on robots are not here.

    Args:
        progress: called with (done, total) claims.

    Raises:
        ExtraError: python-flint is not installed.

    Source: Kamp et al. 2024; proofs ours (theory page, "Proofs").
    """
    asked = (
        *cells.CELL_CLAIMS,
        *pathways.PATHWAY_CLAIMS,
        *order.ORDER_CLAIMS,
        *pathways.WELL_CLAIMS,
        *pathways.MAP_CLAIMS,
    )
    proofs = _proofs()
    return tuple(ClaimProof(one, *proofs[one.id]()) for one in tracked(asked, progress))
