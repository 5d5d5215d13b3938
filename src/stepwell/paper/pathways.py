"""Claims about two cells: their map, their four pathways, their energy landscape (Fig. 2)."""

from dataclasses import dataclass
from functools import cache, partial
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from stepwell.base import Bools, Floats, InputError, to_unit
from stepwell.design import transition_map
from stepwell.files import preset
from stepwell.mechanism import Cell, Chain
from stepwell.paper.cells import PAIRS, falls, monostable_pair, outer_anchor, pair_cycle
from stepwell.paper.claims import Claim, Finding, claim, finding_of
from stepwell.sequences import Cycle, Pathway

# Fractions of area from the paper's equations and parameters, with q_out over x 0 to 20 and
# y -15 to 15 mm.
SHARES = {
    Pathway.COUNTERCLOCKWISE: 0.261,
    Pathway.VIA_01: 0.262,
    Pathway.VIA_10: 0.262,
    Pathway.CLOCKWISE: 0.215,
}
SHARE_TOLERANCE = 0.001
_PLACES = 400  # each way
_BAND = 0.005  # m


@dataclass(frozen=True)
class PaperMap:
    """The paper's map at the centres of equal rectangles: a mean is a fraction of area."""

    x: Floats  # (n,) anchor q of the outer cell [m]
    y: Floats
    pathway: NDArray[np.int8]  # (n, n) code, by place in `Pathway`
    snap_loading: Floats  # (n, n) stroke [m], NaN where there is no snap
    snap_unloading: Floats
    full_stroke: float  # of every design [m]

    def takes(self, *pathways: Pathway) -> Bools:
        """(n, n) whether a design takes one of these pathways."""
        return np.isin(self.pathway, [list(Pathway).index(pathway) for pathway in pathways])

    @property
    def directed(self) -> Bools:
        """(n, n) whether loading and unloading take different pathways."""
        return self.takes(Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)

    @property
    def undirected(self) -> Bools:
        """(n, n) whether loading and unloading take the same pathway."""
        return self.takes(Pathway.VIA_01, Pathway.VIA_10)


@cache
def paper_map() -> PaperMap:
    """The map of Fig. 2C, each of its designs solved in closed form."""
    x = 0.020 * (np.arange(_PLACES) + 0.5) / _PLACES
    y = -0.015 + 0.030 * (np.arange(_PLACES) + 0.5) / _PLACES
    chain = preset(PAIRS[Pathway.CLOCKWISE])
    table = transition_map(chain, 1, x=x, y=y)
    names = "pathway", "snap_loading", "snap_unloading"
    pathway, loading, unloading = (table[name].to_numpy() for name in names)
    return PaperMap(x, y, pathway, loading, unloading, chain.full_stroke)


def _share(pathway: Pathway) -> Finding:
    share = float(np.mean(paper_map().takes(pathway)))
    return finding_of(abs(share - SHARES[pathway]) <= SHARE_TOLERANCE, f"{share:.3f}")


@claim("Fig. 2C", "rises with |q_y|", "rises from band to band")
def large_qy_undirected() -> Finding:
    """A large |q_y| of the outer cell favours undirected pathways."""
    shown = paper_map()
    shares = _by_band(np.abs(shown.y), np.mean(shown.undirected, axis=1))
    edge = shown.undirected[np.abs(shown.y) > 0.0145]
    return finding_of(
        bool(np.all(np.diff(shares) > 0)) and shares[-1] > 0.5 > shares[0],
        _listed(shares),
        note=f"Shares of undirected designs in bands of |q_y| 0 to 5, 5 to 10 and 10 to 15 mm. "
        f"It is a tendency and no rule: in the last half millimetre {1 - np.mean(edge):.0%} are "
        f"still directed.",
        otherwise="The share of undirected designs does not rise from band to band past a half.",
    )


@claim("Fig. 2C (our reading)", "rises with q_x", "rises from band to band")
def large_qx_directed() -> Finding:
    """A large q_x of the outer cell favours directed pathways."""
    shown = paper_map()
    column = np.mean(shown.directed, axis=0)
    shares = _by_band(shown.x, column)
    least = shown.x[np.argmin(column)]
    below, above = (np.mean(shown.directed[:, side]) for side in (shown.x < 0.01, shown.x > 0.01))
    turning = shown.takes(Pathway.CLOCKWISE), shown.takes(Pathway.COUNTERCLOCKWISE)
    left = [np.mean(way[:, shown.x < 0.01]) for way in turning]
    right = [np.mean(way[:, shown.x > 0.01]) for way in turning]
    return finding_of(
        bool(np.all(np.diff(shares) > 0)),
        _listed(shares),
        note="Shares of directed designs in bands of q_x of 5 mm.",
        otherwise=f"Shares of directed designs in bands of q_x of 5 mm, 0 to 20 mm. True from "
        "q_x = 10 mm on, the inner cell's own, where the share is least (at "
        f"{to_unit(least, 'mm'):.1f} mm) and from where it rises to {column[-1]:.2f}; but it rises "
        f"as well towards small q_x, to {column[0]:.2f}. Of the designs below 10 mm {below:.0%} "
        f"are directed, of those above {above:.0%}. What q_x decides is the sense: directed "
        f"designs are counterclockwise below 10 mm ({left[1]:.0%} of all there, clockwise "
        f"{left[0]:.0%}) and clockwise above ({right[0]:.0%}, counterclockwise {right[1]:.0%}).",
    )


def _by_band(along: Floats, share: Floats) -> Floats:
    """Means of (n,) fractions over bands of (n,) places [m]."""
    number = np.floor(along / _BAND).astype(int)
    return np.array([float(np.mean(share[number == k])) for k in range(number.max() + 1)])


def _listed(shares: Floats) -> str:
    return ", ".join(f"{share:.2f}" for share in shares)


MAP_CLAIMS = (
    *(
        Claim(
            f"share-{pathway.label.replace(' ', '-')}",
            f"Share of the map's area that runs {pathway.label}.",
            "Fig. 2C, from its equations and parameters",
            f"{share:.3f}",
            f"{SHARE_TOLERANCE:g}",
            partial(_share, pathway),
        )
        for pathway, share in SHARES.items()
    ),
    large_qy_undirected,
    large_qx_directed,
)


_STILL = 1e-9  # of the full travel
NEAR = 0.005  # m: an eighth of the full stroke


def _taken(pathway: Pathway) -> Finding:
    cycle = pair_cycle(pathway)
    return finding_of(cycle.pathway is pathway, str(cycle.sequence))


@claim("Figs. 2D to 2G", "1 cell at a time", "exact, outside of snaps")
def sequential() -> Finding:
    """The cells move one after the other, never together."""
    cycles = [pair_cycle(pathway) for pathway in PAIRS]
    together = max(int(np.max(_in_transit(cycle))) for cycle in cycles)
    snaps = sum(len(cycle.snaps) for cycle in cycles)
    both = sum(len(snap.cells) > 1 for cycle in cycles for snap in cycle.snaps)
    return finding_of(
        together == 1,
        f"{together} cell between stops at most",
        note=f"Looked at on every sample of the four cycles. In a snap the cells do move at once: "
        f"both in {both} of the {snaps} snaps of the two directed pairs.",
        otherwise=f"{together} cells are between their stops at once outside of a snap.",
    )


def _in_transit(cycle: Cycle) -> np.ndarray:
    """(n,) number of cells between their stops."""
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
    return finding_of(
        inside == snaps == elsewhere == 0,
        f"{snaps} snaps, {inside} samples inside the square",
        note=f"Nor does any of the {int(np.sum(shown.undirected))} undirected designs of the map "
        f"snap.",
        otherwise=f"{elsewhere} undirected designs of the map snap.",
    )


@claim(
    "Figs. 2D to 2G",
    "near (no number)",
    f"{to_unit(NEAR, 'mm'):g} mm of 40 mm (our reading of near)",
)
def directed_snaps() -> Finding:
    """Directed pathways snap near 11 while loading and near 00 while unloading."""
    parts, worst = list[str](), 0.0
    for pathway in (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE):
        cycle = pair_cycle(pathway)
        loading, unloading = (_distances(cycle, way) for way in (1, -1))
        if len(loading) != 1 or len(unloading) != 1:
            return finding_of(
                False,
                f"{len(cycle.snaps)} snaps {pathway.label}",
                otherwise="One snap while loading and one while unloading were expected.",
            )
        worst = max(worst, *loading, *unloading)
        both = (f"{to_unit(each, 'mm'):.2f}" for each in (*loading, *unloading))
        parts.append(f"{' and '.join(both)} mm {pathway.label}")
    shown = paper_map()
    far = np.maximum(shown.full_stroke - shown.snap_loading, shown.snap_unloading)[shown.directed]
    lone = max(*_distances(monostable_pair(), 1), *_distances(monostable_pair(), -1))
    return finding_of(
        worst <= NEAR,
        "; ".join(parts),
        note=f"Stroke left to 11 while loading, to 00 while unloading. Over the whole map the "
        f"farther of the two snaps is {to_unit(np.median(far), 'mm'):.1f} mm away in the median "
        f"and up to {to_unit(np.max(far), 'mm'):.1f} mm, beyond {to_unit(NEAR, 'mm'):g} mm in "
        f"{np.mean(far > NEAR):.0%} of the directed designs; with the monostable outer cell (0, "
        f"-15) it is {to_unit(lone, 'mm'):.2f} mm.",
        otherwise=f"A snap is {to_unit(worst, 'mm'):.2f} mm from its corner.",
    )


def _distances(cycle: Cycle, direction: int) -> list[float]:
    """Stroke [m] from each snap to the corner that it leads to."""
    corner = cycle.chain.full_stroke if direction > 0 else 0.0
    return [abs(corner - snap.stroke) for snap in cycle.snaps if snap.direction == direction]


def _claim(pathway: Pathway) -> Claim:
    q = ", ".join(f"{to_unit(part, 'mm'):g}" for part in outer_anchor(pathway))
    return Claim(
        f"pathway-{pathway.label.replace(' ', '-')}",
        f"With q = (10, 0) mm inside and ({q}) mm outside, two cells run {pathway.label}.",
        "Figs. 2C to 2G (designs: our reading)",
        pathway.value,
        "exact",
        partial(_taken, pathway),
    )


PATHWAY_CLAIMS = (*map(_claim, PAIRS), sequential, undirected_boundary, directed_snaps)


_NODES = 401


@claim("Fig. 2B", "more than 1", "exact")
def wells() -> Finding:
    """The landscape of two cells has several wells even where the outer cell is monostable."""
    chain = monostable_pair().chain
    states, seen = stable_states(chain), count_minima(landscape(chain))
    others = [pair_cycle(pathway).chain for pathway in PAIRS]
    four = {len(stable_states(other)) for other in others}
    return finding_of(
        not chain.cells[1].is_bistable and len(states) == seen >= 2,
        f"{seen} wells: {' and '.join(states)}",
        note=f"Counted on a grid of {_NODES} × {_NODES} with its edges, and by the forces that "
        f"hold each corner; both agree. The outer cell alone has one stable state; pairs of "
        f"bistable cells have {', '.join(map(str, sorted(four)))}.",
        otherwise=f"The grid shows {seen}, the corners' forces hold {len(states)}, outer bistable: "
        f"{chain.cells[1].is_bistable}.",
    )


def stable_states(chain: Chain) -> list[str]:
    """Corners of the square of travels that are local minima of the total energy, strictly.

    The energy is a sum over the cells, so its minima are minima of each cell; and cells with
    falling force have no minimum between their stops. A `ValueError` refuses other cells.
    """
    return ["".join(state) for state in product(*map(_held, chain.levers))]


def _held(cell: Cell) -> str:
    if not falls(cell):
        raise InputError(f"{cell!r}: must be a cell whose force is proved to fall.")
    return "0" * (cell.force_0 > 0) + "1" * (cell.force_1 < 0)


def landscape(chain: Chain, nodes: int = _NODES) -> Floats:
    """(nodes, nodes) total energy [J] over the travels of two cells, stops included."""
    inner, outer = (
        cell.energy(cell.angle(np.linspace(0.0, cell.full_travel, nodes))) for cell in chain.levers
    )
    return inner[:, None] + outer


def count_minima(energy: Floats) -> int:
    """Local minima of a sampled landscape, its edges included.

    A node counts where none of its up to eight neighbours is lower, nodes side by side once.
    """
    lowest = energy <= ndimage.minimum_filter(energy, size=3, mode="nearest")
    _, count = ndimage.label(lowest, structure=np.ones((3, 3)))  # pyright: ignore[reportGeneralTypeIssues]
    return int(count)


WELL_CLAIMS = (wells,)
