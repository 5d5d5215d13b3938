"""Two concave cells: what one full cycle of a rigid actuator does to them, in closed form."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.concave.cell import Simple, full_travel, travel_at, with_d
from stepwell.concave.certificate import certify
from stepwell.concave.ends import end_forces
from stepwell.kernels import entry, kernel

Floats = NDArray[np.float64]
Out = NDArray[Any]


class Pair(NamedTuple):
    """What two concave cells do when a rigid actuator loads and unloads them once."""

    first_loading: int  # 0 inner, 1 outer
    first_unloading: int
    snap_loading: float  # stroke [m], NaN where none
    snap_unloading: float
    holds: bool  # False: a cell is pushed through its whole travel in a snap; ask the engine


@kernel
def pair(inner: Simple, outer: Simple) -> Pair:
    """The full cycle of two certified cells under a rigid actuator.

    From the rules (a cell at 0 stays while F0 >= λ, one at 1 while F1 <= λ, one in transit has
    F = λ, two in transit with falling forces are unstable):
    - loading: the smaller F0 (cell i) leaves 0 first, and its force only falls, so the other
      (j) stays; i arrives with λ = F1_i. Then λ rises with nothing moving to F0_j, and j moves
      with λ = F_j(s) falling from there. i holds its stop while F1_i <= F_j(s): for ever if
      F1_j >= F1_i, else up to F_j(s*) = F1_i, at the stroke S_i + s*. There i comes off its
      stop, two cells are in transit, and the chain snaps: j runs to its stop, i gives back
      S_j - s*, then finishes alone, since F1_j < F1_i <= λ keeps j where it is.
    - unloading: the same picture upside down. The larger F1 (i) leaves 1 first and arrives at
      0; j follows from S_j with λ = F_j(s) rising from F1_j; i holds while F0_i >= F_j(s): up
      to F_j(s*) = F0_i if F0_j > F0_i, at the stroke s*.
    A cell that would have to give back more than its whole travel reaches its other stop in
    the snap, which adds a vertex; only unequal levers or limits allow it (`holds` is False).
    Equal forces, which no rule decides, go to the inner cell first.
    """
    inner_0, inner_1 = end_forces(inner)
    outer_0, outer_1 = end_forces(outer)
    full_inner = full_travel(inner)
    full_outer = full_travel(outer)
    snap_loading, snap_unloading = np.nan, np.nan
    holds = True
    if inner_0 <= outer_0:
        first_loading = 0
        if outer_1 < inner_1:
            travel = travel_at(outer, inner_1)
            snap_loading = full_inner + travel
            holds = full_outer - travel < full_inner
    else:
        first_loading = 1
        if inner_1 < outer_1:
            travel = travel_at(inner, outer_1)
            snap_loading = full_outer + travel
            holds = full_inner - travel < full_outer
    if inner_1 >= outer_1:
        first_unloading = 0
        if outer_0 > inner_0:
            snap_unloading = travel_at(outer, inner_0)
            holds = holds and snap_unloading < full_inner
    else:
        first_unloading = 1
        if inner_0 > outer_0:
            snap_unloading = travel_at(inner, outer_0)
            holds = holds and snap_unloading < full_outer
    return Pair(first_loading, first_unloading, snap_loading, snap_unloading, holds)


@entry(8e-5, "x", "y")
def sweep(
    x: Floats,
    y: Floats,
    p: tuple[float, float],
    fixed: Simple,
    moving: Simple,
    cell: int,
    pathway: Out,
    snap_loading: Out,
    snap_unloading: Out,
    margin: Out,
    monostable: Out,
) -> None:
    """Fill the (y, x) arrays; designs that are not certified keep what was in them.

    Args:
        x, y: (nx,), (ny,) anchor q of the moving cell [m].
        p: its anchor p [m].
        fixed, moving: both cells; the anchors of `moving` are not looked at.
        cell: 0 where the moving cell is the inner one, 1 where it is the outer one.
        pathway: (ny, nx) int, 2 * (first cell to load) + (first cell to unload).
        snap_loading, snap_unloading: (ny, nx) strokes [m].
        margin: (ny, nx) in units of the fixed cell's k r.
        monostable: (ny, nx) bool.
    """
    fixed_0, fixed_1 = end_forces(fixed)
    scale = fixed.stiffness * fixed.lever
    for row in range(len(y)):
        dy = y[row] - p[1]
        for column in range(len(x)):
            dx = x[column] - p[0]
            here = with_d(moving, dx, dy)
            if not certify(here, 0.0):
                continue
            result = pair(fixed, here) if cell == 1 else pair(here, fixed)
            if not result.holds:
                continue
            force_0, force_1 = end_forces(here)
            pathway[row, column] = 2 * result.first_loading + result.first_unloading
            snap_loading[row, column] = result.snap_loading
            snap_unloading[row, column] = result.snap_unloading
            margin[row, column] = min(abs(force_0 - fixed_0), abs(force_1 - fixed_1)) / scale
            monostable[row, column] = force_0 <= 0.0 or force_1 >= 0.0


@entry(4e-5, "d")
def decide(d: Floats, fixed: Simple, moving: Simple, cell: int, out: Out) -> None:
    """The same for a list of differences d = q - p, (m, 2) [m]: only the pathway, as in `sweep`."""
    for i in range(len(d)):
        here = with_d(moving, d[i, 0], d[i, 1])
        if certify(here, 0.0):
            result = pair(fixed, here) if cell == 1 else pair(here, fixed)
            if result.holds:
                out[i] = 2 * result.first_loading + result.first_unloading
