"""The plainest bistable element: two straight rising branches with a falling one between them."""

from stepwell.base import InputError, Vec2, check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element


@kept
def trilinear(
    peak: Vec2 = (0.004, 1.0),
    valley: Vec2 = (0.012, -1.0),
    first: float = 250.0,
    last: float = 250.0,
    name: str = "trilinear",
) -> Element:
    """A force that rises straight to a peak, falls straight to a valley and rises straight again.

    The energy has two parabolic wells and a parabolic spinodal region between them. The outer
    branches go on for ever; each has a place of rest where it crosses zero force, if it does.

    Args:
        peak: travel [m] and force [N] where the first branch ends.
        valley: travel [m] and force [N] where the last branch begins: further on, and lower.
        first: stiffness of the first branch [N/m], > 0.
        last: stiffness of the last branch [N/m], > 0.
        name: what messages and figures call the element.

    Raises:
        ValueError: a valley that is not further on than the peak and lower, or a value out of its
            range.

    Source: Puglisi & Truskinovsky 2000, J. Mech. Phys. Solids 48:1, whose bistable springs these
    are; the branches may differ in stiffness here.
    """
    top, bottom = check.vector("peak", peak, "m, N"), check.vector("valley", valley, "m, N")
    first, last = check.positive("first", first, "N/m"), check.positive("last", last, "N/m")
    drop = top[1] - bottom[1]
    if bottom[0] <= top[0] or drop <= 0:
        raise InputError(
            f"valley at {bottom[0] * 1e3:.6g} mm, {bottom[1]:.6g} N after a peak at "
            f"{top[0] * 1e3:.6g} mm, {top[1]:.6g} N: must be at a larger travel and a smaller "
            f"force, else nothing snaps."
        )
    # As far as the force of the other corner; without stops, both ends go on straight.
    travel = (top[0] - drop / first, top[0], bottom[0], bottom[0] + drop / last)
    return Element.from_points(travel, (bottom[1], top[1], bottom[1], top[1]), name)
