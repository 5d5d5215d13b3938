"""The transition map's inner loops: many designs of a pair, each in closed form."""

from stepwell.concave.certificate import Simple, certify, end_forces, pair
from stepwell.kernels import entry


@entry(8e-5, "x", "y")
def sweep(x, y, p, fixed, moving, cell, pathway, snap_loading, snap_unloading, margin, monostable):
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
            here = Simple(dx, dy, moving.stiffness, moving.rest, moving.lever, moving.sin_limit)
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
def decide(d, fixed, moving, cell, out):
    """The same for a list of differences d = q - p, (m, 2) [m]: only the pathway, as in `sweep`."""
    for i in range(len(d)):
        here = Simple(
            d[i, 0], d[i, 1], moving.stiffness, moving.rest, moving.lever, moving.sin_limit
        )
        if certify(here, 0.0):
            result = pair(fixed, here) if cell == 1 else pair(here, fixed)
            if result.holds:
                out[i] = 2 * result.first_loading + result.first_unloading
