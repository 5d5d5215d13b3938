"""Which anchors make a cell whose order of motion is known from its end forces, proved."""

from stepwell.concave.certificate import Simple, certify
from stepwell.kernels import entry


@entry(1.5e-5, "d")
def certified_within(d, cell: Simple, reach: float, out):
    """Which differences d, (m, 2) [m], are proved concave and taut for all anchors within reach.

    `out` is (m,) bool; the anchors of `cell` are not looked at.
    """
    for i in range(len(d)):
        here = Simple(d[i, 0], d[i, 1], cell.stiffness, cell.rest, cell.lever, cell.sin_limit)
        out[i] = certify(here, reach)
