"""Claims about the four pathways of two cells (Figs. 2D to 2G)."""

from functools import partial

import numpy as np

from stepwell.paper.claims import Claim, Finding, claim, judged
from stepwell.paper.mechanisms.designs import PAIRS, monostable_pair, outer_anchor, pair_cycle
from stepwell.paper.mechanisms.map import paper_map
from stepwell.sequences import Cycle, Pathway
from stepwell.statics import Event

_STILL = 1e-9  # of the full travel
_NEAR = 0.005  # m: an eighth of the full stroke


def _taken(pathway: Pathway) -> Finding:
    found = pair_cycle(pathway)
    return judged(found.pathway is pathway, str(found.sequence))


@claim("Figs. 2D to 2G", "1 cell at a time", "exact, outside of snaps")
def sequential() -> Finding:
    """The cells move one after the other, never together."""
    cycles = [pair_cycle(pathway) for pathway in PAIRS]
    together = max(int(np.max(_in_transit(cycle))) for cycle in cycles)
    snaps = sum(len(cycle.snaps) for cycle in cycles)
    both = sum(len(snap.cells) > 1 for cycle in cycles for snap in cycle.snaps)
    return judged(
        together == 1,
        f"{together} cell between stops at most",
        note=f"Looked at on every sample of the four cycles. In a snap the cells do move at once: "
        f"both in {both} of the {snaps} snaps of the two directed pairs.",
        otherwise=f"{together} cells are between their stops at once outside of a snap.",
    )


def _in_transit(cycle: Cycle) -> np.ndarray:
    """(n,) how many cells are between their stops."""
    full = np.array(cycle.chain.full_travels)
    travel = cycle.path.travel
    return np.sum((travel > _STILL * full) & (travel < (1 - _STILL) * full), axis=1)


@claim("Figs. 2B to 2G", "no snap", "exact")
def undirected_boundary() -> Finding:
    """Undirected pathways keep to the edges of the square of both travels and do not snap."""
    cycles = [pair_cycle(pathway) for pathway in PAIRS if not pathway.is_directed]
    inside = sum(int(np.sum(_in_transit(cycle) == len(cycle.chain))) for cycle in cycles)
    snaps = sum(len(cycle.snaps) for cycle in cycles)
    shown = paper_map()
    jumps = np.isfinite(shown.snap_loading) | np.isfinite(shown.snap_unloading)
    elsewhere = int(np.sum(jumps & shown.undirected))
    return judged(
        inside == snaps == elsewhere == 0,
        f"{snaps} snaps, {inside} samples inside the square",
        note=f"Nor does any of the {int(np.sum(shown.undirected))} undirected designs of the map "
        f"snap.",
        otherwise=f"{elsewhere} undirected designs of the map snap.",
    )


@claim("Figs. 2D to 2G", "near (no number)", f"{_NEAR * 1e3:g} mm of 40 mm (our reading of near)")
def directed_snaps() -> Finding:
    """Directed pathways snap near 11 while loading and near 00 while unloading."""
    worst = 0.0
    parts: list[str] = []
    for pathway in (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE):
        cycle = pair_cycle(pathway)
        loading, unloading = (_distances(cycle, way) for way in (1, -1))
        if len(loading) != 1 or len(unloading) != 1:
            return judged(
                False,
                f"{len(cycle.snaps)} snaps {pathway.label}",
                otherwise="One snap while loading and one while unloading were expected.",
            )
        worst = max(worst, *loading, *unloading)
        parts.append(f"{loading[0] * 1e3:.2f} and {unloading[0] * 1e3:.2f} mm {pathway.label}")
    shown = paper_map()
    far = np.maximum(shown.full_stroke - shown.snap_loading, shown.snap_unloading)[shown.directed]
    lone = max(*_distances(monostable_pair(), 1), *_distances(monostable_pair(), -1))
    return judged(
        worst <= _NEAR,
        "; ".join(parts),
        note=f"Stroke left to 11 while loading, to 00 while unloading. Over the whole map the "
        f"farther of the two snaps is {np.median(far) * 1e3:.1f} mm away in the median and up to "
        f"{np.max(far) * 1e3:.1f} mm, beyond {_NEAR * 1e3:g} mm in {np.mean(far > _NEAR):.0%} of "
        f"the directed designs; with the monostable outer cell (0, -15) it is "
        f"{lone * 1e3:.2f} mm.",
        otherwise=f"A snap is {worst * 1e3:.2f} mm from its corner.",
    )


def _distances(cycle: Cycle, direction: int) -> list[float]:
    """Stroke [m] from each snap to the corner that it leads to."""
    full = cycle.chain.full_stroke

    def left(snap: Event) -> float:
        return full - snap.stroke if direction > 0 else snap.stroke

    return [left(snap) for snap in cycle.snaps if snap.direction == direction]


def _claim(pathway: Pathway) -> Claim:
    q = ", ".join(f"{part * 1e3:g}" for part in outer_anchor(pathway))
    return Claim(
        f"pathway-{pathway.label.replace(' ', '-')}",
        f"With q = (10, 0) mm inside and ({q}) mm outside, two cells run {pathway.label}.",
        "Figs. 2C to 2G (designs: our reading)",
        pathway.value,
        "exact",
        partial(_taken, pathway),
    )


CLAIMS = (
    *map(_claim, PAIRS),
    sequential,
    undirected_boundary,
    directed_snaps,
)
