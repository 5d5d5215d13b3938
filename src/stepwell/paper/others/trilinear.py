"""Chains of equal bistable springs of three straight pieces: branches, their ends, hysteresis."""

import math

from stepwell.base import to_unit
from stepwell.mechanism import Chain, Element
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.statics import Event, EventKind

WHERE = "Puglisi and Truskinovsky 2000 (formula: our derivation)"
# A spring: travel [m] and force [N] of its peak and valley, stiffness of both phases [N/m].
PEAK, VALLEY = (0.001, 1.0), (0.002, -1.0)
STIFFNESS = 1000.0
LENGTHS = (2, 5, 20, 100)
# A distant valley: a few springs together are stiffer than the fall between the phases.
GENTLE = (0.006, -1.0)
_SAME = 1e-9
_CYCLED = 20


def spring(valley: tuple[float, float] = VALLEY) -> Element:
    """A bistable spring: two phases of one stiffness, a straight fall between them."""
    (p, up), (q, down) = PEAK, valley
    drop = (up - down) / STIFFNESS
    return Element.from_points((p - drop, p, q, q + drop), (down, up, down, up))


def transformation(valley: tuple[float, float] = VALLEY) -> float:
    """Δ [m]: difference in length between the second and the first phase, at one force."""
    (p, up), (q, down) = PEAK, valley
    return q - p + (up - down) / STIFFNESS


def length(force: float, n: int, cells: int, valley: tuple[float, float] = VALLEY) -> float:
    """u [m] of a chain with n springs in the second phase.

    Each is PEAK's travel long at PEAK's force, and Δ longer in its second phase.
    """
    each = PEAK[0] + (force - PEAK[1]) / STIFFNESS
    return cells * each + n * transformation(valley)


def hysteresis(cells: int, valley: tuple[float, float] = VALLEY) -> float:
    """Energy lost in a cycle of the total length [J]: N Δ (F+ - F- - k Δ/N), or none below zero.

    A spring that switches at the force F+ reduces the force by k Δ/N, since the chain keeps its
    length, and one that switches back at F- raises it by the same. Both branches are straight with
    stiffness k/N, so the two jumps together release Δ (F+ - F- - k Δ/N).
    """
    size = transformation(valley)
    return max(0.0, cells * size * (PEAK[1] - valley[1] - STIFFNESS * size / cells))


def fewest(valley: tuple[float, float] = VALLEY) -> float:
    """1 + k/κ: chains of more springs than this snap, κ being the stiffness of the fall.

    In shorter chains the other springs are stiff enough to stabilise the one that falls.
    """
    (p, up), (q, down) = PEAK, valley
    return 1.0 + STIFFNESS * (q - p) / (up - down)


@claim(
    WHERE,
    "straight, of stiffness k/N; from one spring at its valley to one at its peak",
    "1e-9 of its size",
)
def trilinear_branches() -> Finding:
    """In a hard device each number n of N springs in the second phase has a branch of its own."""
    worst, branches = 0.0, 0
    for cells in LENGTHS:
        chain = Chain((spring(),) * cells)
        for n in sorted({0, 1, cells // 2, cells - 1, cells}):
            branches += 1
            for direction, force in ((+1, PEAK[1]), (-1, VALLEY[1])):
                if 0 <= n + direction <= cells:
                    snap = _snap(chain, n, direction)
                    size = abs(length(PEAK[1], 0, cells) - length(VALLEY[1], 0, cells))
                    worst = max(
                        worst,
                        abs(snap.drive - length(force, n, cells)) / size,
                        abs(snap.force_before - force) / PEAK[1],
                    )
    return finding_of(
        worst <= _SAME,
        f"{branches} branches, N = {_listed(LENGTHS)}: ends and forces the same",
        note=f"N C n ways to choose the springs of a branch all have the same. Peak {PEAK[1]:g} N, "
        f"valley {VALLEY[1]:g} N, k = {STIFFNESS:g} N/m, Δ = {to_unit(transformation(), 'mm'):g} "
        "mm.",
        otherwise=f"A branch or its end is off by {worst:.2g} of its size.",
    )


@claim(WHERE, "N Δ (F+ - F- - k Δ/N)", "1e-9 of its size")
def trilinear_hard_device() -> Finding:
    """A hard device turns springs over one by one, and its hysteresis grows with their number."""
    worst, one_by_one, energies = 0.0, True, []
    for cells in LENGTHS:
        chain, each = Chain((spring(),) * cells), hysteresis(cells) / cells
        for n in sorted({0, cells // 2, cells - 1}):
            snaps = _snap(chain, n, +1), _snap(chain, n + 1, -1)
            one_by_one &= all(map(_single, snaps))
            worst = max(worst, abs(sum(snap.released for snap in snaps) - each) / each)
        energies.append(f"{to_unit(each, 'mJ'):.4g} mJ a spring of {cells}")
    cycle = Chain((spring(),) * _CYCLED).cycle()
    one_by_one &= len(cycle.snaps) == 2 * _CYCLED and all(map(_single, cycle.snaps))
    worst = max(worst, abs(cycle.dissipated - hysteresis(_CYCLED)) / hysteresis(_CYCLED))
    soft = to_unit(transformation() * (PEAK[1] - VALLEY[1]), "mJ")
    return finding_of(
        worst <= _SAME and one_by_one,
        ", ".join(energies),
        note=f"Towards the {soft:g} mJ of a soft device as N grows. The first, the middle and the "
        f"last spring there and back, and all of {_CYCLED}. Equal springs tie: which goes first is "
        f"free, what the chain does is not.",
        otherwise=f"Off by {worst:.2g}, or not one spring a snap.",
    )


@claim(WHERE, "all at F+ and all at F-, N Δ (F+ - F-)", "1e-9 of its size")
def trilinear_soft_device() -> Finding:
    """A soft device turns all springs over at once, at the peak, and back at the valley."""
    worst = 0.0
    for cells in LENGTHS:
        cycle = Chain((spring(),) * cells, actuator_stiffness=0.0).cycle()
        expected = cells * transformation() * (PEAK[1] - VALLEY[1])
        forces = {snap.direction: snap.drive for snap in cycle.snaps}
        worst = max(
            worst,
            abs(cycle.dissipated - expected) / expected,
            *(abs(snap.drive - forces[snap.direction]) for snap in cycle.snaps),
            abs(forces[+1] - PEAK[1]),
            abs(forces[-1] - VALLEY[1]),
        )
    return finding_of(
        worst <= _SAME,
        f"{to_unit(transformation() * (PEAK[1] - VALLEY[1]), 'mJ'):g} mJ a spring, N = "
        f"{_listed(LENGTHS)}",
        note="No spring feels another, so the chain is N times one spring.",
        otherwise=f"Off by {worst:.2g}.",
    )


@claim(WHERE, "snaps for N > 1 + k/κ", "N on both sides of it, and the energy lost")
def trilinear_spinodal() -> Finding:
    """The fall between the phases, one spring in it at most, decides whether few springs snap."""
    edge = fewest(GENTLE)
    below, above = math.floor(edge), math.floor(edge) + 1
    lost: dict[int, float] = {}
    falling = 0
    for cells in range(1, above + 3):
        path = (cycle := Chain((spring(GENTLE),) * cells).cycle()).path
        lost[cells] = cycle.dissipated
        inside = (path.travel > PEAK[0] + 1e-9) & (path.travel < GENTLE[0] - 1e-9)
        falling = max(falling, int(inside.sum(axis=1).max()))
        if cells <= below and not inside.any():
            falling = -1
    right = all(
        abs(energy - hysteresis(cells, GENTLE)) <= _SAME * hysteresis(above, GENTLE)
        for cells, energy in lost.items()
    )
    return finding_of(
        right and falling == 1,
        f"1 + k/κ = {edge:g}: {below} lose {to_unit(lost[below], 'mJ'):.3g} mJ, "
        f"{above} lose {to_unit(lost[above], 'mJ'):.3g} mJ; {falling} in the fall",
        note="The same number from both sides: where the chain is stiff enough to hold the "
        "spring that falls, and where the hysteresis above vanishes.",
    )


def _snap(chain: Chain, n: int, direction: int) -> Event:
    """The first snap beyond the branch with n springs in the second phase, begun without force."""
    cells = len(chain)
    at = length(PEAK[1] if direction > 0 else VALLEY[1], n, cells)
    middle = length(0.0, n, cells)
    path = chain.path((middle, at + 1e-3 * (at - middle)), start="1" * n + "0" * (cells - n))
    return path.events[0]


def _single(snap: Event) -> bool:
    """Whether one spring changes its phase in a snap."""
    return snap.kind is EventKind.SNAP and len(snap.arrivals) == 1


def _listed(numbers: tuple[int, ...]) -> str:
    return f"{', '.join(map(str, numbers[:-1]))} and {numbers[-1]}"


TRILINEAR_CLAIMS = (
    trilinear_branches,
    trilinear_hard_device,
    trilinear_soft_device,
    trilinear_spinodal,
)
