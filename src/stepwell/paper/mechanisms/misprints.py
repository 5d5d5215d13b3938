"""Claims that cannot be meant as they are printed."""

import math

from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.mechanisms.designs import pair_cycle, six_cells
from stepwell.sequences import Pathway

_FORCE_OF_FIG_1D = 0.967  # F0/(k r) of q = (10, 0)


@claim("Eq. 5", "-2 sin θc", "exact")
def eq_5_sign() -> Finding:
    """The stroke of two cells is r (sin θ of one + sin θ of the other) and a constant."""
    cells = pair_cycle(Pathway.CLOCKWISE).chain.levers
    r, limit = cells[0].lever, cells[0].limit
    moved = r * 2 * math.sin(-limit)
    printed, ours = (moved + sign * 2 * r * math.sin(limit) for sign in (-1, 1))
    return judged(
        abs(printed) < 1e-12 * r,
        f"+2 sin θc: u = {abs(ours) * 1e3:.0f} mm there",
        otherwise=f"The paper starts at θ = -θc with u = 0. There the printed sign gives "
        f"u = {printed * 1e3:.0f} mm, a plus gives {abs(ours) * 1e3:.0f} mm.",
    )


@claim("anchors of the unit cells", "cm", "0.001 in F0/(kr)")
def anchor_unit() -> Finding:
    """The unit printed with p and with some q."""
    cell = six_cells()["(10, 0)"]
    band, scale = cell.bands[0], cell.bands[0].stiffness * cell.lever
    (px, py), (qx, qy) = band.p, band.q
    in_cm = cell.with_anchors(p=(10 * px, 10 * py), q=(10 * qx, 10 * qy))
    as_mm, as_cm = cell.force_0 / scale, in_cm.force_0 / scale
    return judged(
        abs(as_cm - _FORCE_OF_FIG_1D) <= 0.001,
        "mm",
        otherwise=f"Read as mm the numbers give F0/(kr) = {as_mm:.3f} for q = (10, 0), as in "
        f"Fig. 1D; read as cm they give {as_cm:.1f}.",
    )


CLAIMS = (eq_5_sign, anchor_unit)
