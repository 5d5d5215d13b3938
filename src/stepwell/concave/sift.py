"""Which pieces of the anchor plane can hold given end forces: bounds that throw the others out."""

from stepwell.concave.certificate import Simple
from stepwell.concave.ends import end_force, steepest
from stepwell.kernels import entry


@entry(1e-5, "d", "side")
def sift(cell: Simple, d, radius: float, side, force, up, held, inside):
    """Look at discs around the differences d = q - p, (m, 2) [m], `radius` [m] wide.

    Args:
        cell: whose end forces they are; its own anchors are not looked at.
        d: middles of the discs.
        radius: of every disc.
        side, force, up: (c,) conditions: F0 (side -1) or F1 (side +1) is above (up +1) or below
            (up -1) a force [N].
        held: (m,) bool out: False where a bound on the slope proves that no anchor in the disc
            meets all conditions.
        inside: (m,) bool out: whether the middle of the disc meets them all.
    """
    for i in range(len(d)):
        held[i], inside[i] = True, True
        for k in range(len(side)):
            value, _, _ = end_force(cell, side[k], d[i, 0], d[i, 1])
            lack = up[k] * (force[k] - value)
            if lack >= 0.0:
                inside[i] = False
                if lack > radius * steepest(cell, side[k], d[i, 0], d[i, 1], radius):
                    held[i] = False
                    break
