"""Largest deviation of all anchors, or all forces, at once that keeps the sequence."""

import math
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Advised, ByValue, Floats, InputError, bisected, to_unit
from stepwell.concave import Simple, SortedChain, certified, concave_disc, end_force_field
from stepwell.design.plane import Box, narrowed
from stepwell.design.switches import Switches, are_relays, switching_forces
from stepwell.mechanism import Chain

SIDES = (-1, 1)
# Steps towards the extreme point of a disc; each divides the error by ten or more.
_TURNS = 6
# Nodes over the length of a lever at the limit of the proof, and over a wide region.
_GRID = 64
_MOST_GRID = 1000
_HALVINGS = 12


def farthest(cell: Simple, side: int, d: Floats, radius: float | Floats, sign: int) -> Floats:
    """(m, 3) where an end force is largest (sign +1) or smallest (-1): F [N], and displacement [m].

    With n = (-tan θ, 1) and the unit vector u along the band, u·n = g/ℓ, so that

      ∇F·n = k ((1 - ℓ0/ℓ)/cos² θ + ℓ0 g²/ℓ³) > 0:

    a taut band has no extremum inside a disc, so it lies on the rim, where the slope points
    outwards. It is found by repeated steps along the slope; that no better one lies elsewhere on
    the rim is not proved. The side is -1 for F0, +1 for F1; differences d = q - p, (m, 2) [m], may
    deviate by one radius, or by (m,).
    """
    out = end_force_field(cell, side, d)
    reach = sign * np.broadcast_to(np.asarray(radius, float), len(d))[:, None]
    move = np.zeros_like(d)
    for _ in range(_TURNS):
        slope = out[:, 1:]
        move = reach * slope / np.linalg.norm(slope, axis=1, keepdims=True)
        out = end_force_field(cell, side, d + move)
    return np.column_stack([out[:, 0], move])


def extremes(
    cell: Simple, d: Floats, force: Floats, slope: Floats, radius: float
) -> tuple[Floats, Floats]:
    """How far F0 and F1 fall and rise within a radius of d, over that radius, (m, 2) each [N/m]."""
    if radius <= 0.0:
        steep = np.linalg.norm(slope, axis=2)
        return steep, steep

    def most(sign: int) -> Floats:
        ends = [farthest(cell, side, d, radius, sign)[:, 0] for side in SIDES]
        return np.abs(np.stack(ends, axis=1) - force) / radius

    return most(-1), most(+1)


class AnchorProof:
    """Largest displacement of an anchor with the cell still proved taut and concave.

    Distance to the edge of all proved anchors, located on a grid and bisected. It serves to choose;
    the choice is proved afterwards.
    """

    def __init__(self, cell: Simple, d: Box):
        """For a band and a lever, and differences q - p within a rectangle [m]."""
        self.most = 2.0 * cell.lever
        pitch = max(cell.lever / _GRID, max(d.right - d.left, d.top - d.bottom) / _MOST_GRID)
        x = np.arange(d.left - self.most, d.right + self.most + pitch, pitch)
        y = np.arange(d.bottom - self.most, d.top + self.most + pitch, pitch)
        grid = np.stack(np.meshgrid(x, y), axis=-1)

        yes = certified(cell, grid.reshape(-1, 2)).reshape(grid.shape[:2])
        edges: list[tuple[Floats, Floats]] = []
        for held, at in ((yes, grid), (yes.T, grid.swapaxes(0, 1))):
            leaves, enters = held[:-1] & ~held[1:], held[1:] & ~held[:-1]
            edges += [(at[:-1][leaves], at[1:][leaves]), (at[1:][enters], at[:-1][enters])]
        low, high = (np.concatenate(ends) for ends in zip(*edges, strict=True))
        held = np.ones(len(low), bool)
        low, _, _ = narrowed(partial(certified, cell), low, high, held, ~held, _HALVINGS)
        from scipy.spatial import KDTree

        self._edge = KDTree(low) if len(low) else None

    def radius(self, d: Floats) -> Floats:
        """For (m, 2) proved differences [m], at most two levers."""
        if self._edge is None:
            return np.full(len(d), self.most)
        return self._edge.query(d, distance_upper_bound=self.most)[0].clip(max=self.most)


_DIRECTIONS = 256
_HALVINGS_OF_RADIUS = 24
_FINE = 1e-12  # m

METHOD = (
    "the two neighbours in F0 or F1 that meet first, each displaced in the worst direction; the "
    f"critical force of a taut band is extreme on the rim of a disc: {_DIRECTIONS} directions are "
    "evaluated and one is refined (not proved to be the extreme); all cells are proved to stay "
    "taut and concave"
)


class RobustnessLimit(Advised):
    """Limit of the allowed deviation of the anchors."""

    ORDER = (
        "order",
        "larger displacements change the sequence: separate the forces of the two cells that meet",
    )
    PROOF = (
        "proof",
        "beyond it a cell may no longer be taut and concave, so the sequence is not proved: use "
        "chain.yields() with larger tolerances",
    )
    NONE = ("none", "no limit within twice the lever of a single cell, or down to zero forces")


METHOD_OF_RELAYS = (
    "the two neighbours in the order of the switching forces up, or down, that meet first, with "
    "all forces of one scaled up and of the other scaled down; exact and proved, since elements "
    "are independent under a prescribed force"
)


class Meeting(NamedTuple):
    """Two neighbours whose critical forces can become equal."""

    radius: float  # [m], or the fraction of all forces
    first: int  # the cell that moves first in the design
    second: int
    way: str  # "loading", decided by F0, or "unloading", by F1
    # Displacements of their anchors q [m]; none if their forces are scaled.
    moves: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class Robustness(ByValue):
    """Largest displacement of all anchors at once that keeps the sequence.

    For elements under a prescribed force, the largest relative deviation of all their forces.

    Attributes:
        chain: the design.
        radius: of each outer anchor q, with nominal inner anchors; if both ends of a band deviate,
            half of it for each [m]; NaN for elements.
        limit: the order of the cells, the proof, or no limit.
        meeting: the neighbours that meet first; None if none meet within the radius.
        cell: the cell whose proof ends first; None unless that is the limit.
        method: what is proved, and what is not.
        fraction: of all forces of every element, without friction; NaN for anchors.
    """

    chain: Chain = field(repr=False)
    radius: float
    limit: RobustnessLimit
    meeting: Meeting | None
    cell: int | None
    method: str = field(repr=False, default=METHOD)
    fraction: float = math.nan

    def __str__(self):
        names = self.chain.names
        text = f"all anchors may deviate by {to_unit(self.radius, 'mm'):.4g} mm at once"
        if not math.isnan(self.fraction):
            percent = f"{self.fraction * 100:.4g} %"
            text = f"all {self.chain.measure.force}s may deviate by {percent} at once"
        if self.meeting is not None:
            first, second = names[self.meeting.first], names[self.meeting.second]
            text += f"; then the order of {first} and {second} in {self.meeting.way} is reversed"
        if self.cell is not None:
            text += f"; with more, the band of {names[self.cell]} may go slack or fold back"
        return text

    def __repr__(self):
        return f"Robustness({self})"


def robustness(chain: Chain) -> Robustness:
    """The largest displacement of all anchors at once, in any directions, for the same sequence.

    All else as for `Chain.robustness`.
    """
    if len(chain.elements) == len(chain) and are_relays(chain):
        return _of_relays(chain)
    forces = SortedChain.of(chain)
    if forces is None:
        raise InputError(
            "robustness needs cells proved taut and concave, with one full travel and a rigid "
            "actuator, or elements without folds under a prescribed force, and this chain is "
            "neither: use chain.margin(), one parameter at a time, or chain.yields(tolerances)."
        )
    proofs = [_proved_radius(cell) for cell in forces.cells]
    first = int(np.argmin(proofs))
    most = proofs[first]
    meetings = [
        meeting
        for end, order in enumerate((forces.loading, forces.unloading))
        for a, b in pairwise(order)
        if (meeting := _meeting(forces.cells, end, a, b, most)) is not None
    ]
    if meetings:
        meeting = min(meetings, key=lambda m: m.radius)
        return Robustness(chain, meeting.radius, RobustnessLimit.ORDER, meeting, None)
    if most < 2.0 * forces.cells[first].lever:
        return Robustness(chain, most, RobustnessLimit.PROOF, None, first)
    return Robustness(chain, most, RobustnessLimit.NONE, None, None)


def _of_relays(chain: Chain) -> Robustness:
    """The relative deviation of all forces at which the first two neighbours meet.

    Neighbours are sufficient: cells further apart meet at no smaller deviation than the nearest two
    between them, as a mean of fractions is no smaller than the smallest.
    """
    switches = Switches.of(chain.last_state)
    forces = switching_forces(chain)
    rub = np.array([chain.cells[cell].friction for cell in switches.cell.tolist()])
    order = switches.motion(forces[None]).order[0]
    meetings: list[Meeting] = []
    for end, way in enumerate(("loading", "unloading")):
        # If a cell skips a phase, this is the force that held it.
        held = switches.decisive(forces[None])[0, :, end]
        own = np.abs(held + (2 * end - 1) * rub)
        for a, b in pairwise(order[end].tolist()):
            first, second = int(switches.cell[a]), int(switches.cell[b])
            if first != second and own[a] + own[b] > 0.0:
                fraction = float(abs(held[b] - held[a]) / (own[a] + own[b]))
                meetings.append(Meeting(fraction, first, second, way, ()))
    nearest = min(meetings, key=lambda one: one.radius, default=None)
    fraction = math.inf if nearest is None else nearest.radius
    # At 100 % a force vanishes.
    limit = RobustnessLimit.NONE if fraction >= 1.0 else RobustnessLimit.ORDER
    meeting = nearest if fraction < 1.0 else None
    method = METHOD_OF_RELAYS
    return Robustness(chain, math.nan, limit, meeting, None, method, min(fraction, 1.0))


def _proved_radius(cell: Simple) -> float:
    """Largest displacement of the anchor with the cell proved concave, at most two levers."""
    most = 2.0 * cell.lever
    if concave_disc(cell, most):
        return most
    return bisected(partial(concave_disc, cell), 0.0, most, _HALVINGS_OF_RADIUS)[0]


def _meeting(
    cells: tuple[Simple, ...], end: int, first: int, second: int, most: float
) -> Meeting | None:
    """Where the critical forces of two cells meet; `first` is the one that moves first."""
    # Loading goes up in F0, unloading down in F1.
    up = 1 if end == 0 else -1

    def gap(radius: float) -> float:
        ahead = extreme(cells[first], SIDES[end], radius, up)[0]
        behind = extreme(cells[second], SIDES[end], radius, -up)[0]
        return up * (behind - ahead)

    way = ("loading", "unloading")[end]
    if gap(0.0) <= 0.0:
        return Meeting(0.0, first, second, way, ((0.0, 0.0), (0.0, 0.0)))
    if gap(most) > 0.0:
        return None
    from scipy.optimize import brentq  # pyright: ignore[reportMissingTypeStubs]

    radius = float(brentq(gap, 0.0, most, xtol=_FINE))  # pyright: ignore[reportArgumentType]
    _, *ahead = extreme(cells[first], SIDES[end], radius, up)
    _, *behind = extreme(cells[second], SIDES[end], radius, -up)
    return Meeting(radius, first, second, way, ((ahead[0], ahead[1]), (behind[0], behind[1])))


def extreme(cell: Simple, side: int, radius: float, sign: int) -> tuple[float, float, float]:
    """The largest (sign +1) or smallest end force [N] with the anchor in a radius, and where."""
    d = np.array([[cell.dx, cell.dy]])
    followed = farthest(cell, side, d, radius, sign)
    angle = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False)
    rim = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    out = end_force_field(cell, side, d + rim)
    best = int(np.argmax(sign * out[:, 0]))
    every = np.vstack([followed, [out[best, 0], *rim[best]]])
    force, x, y = every[np.argmax(sign * every[:, 0])].tolist()
    return force, x, y
