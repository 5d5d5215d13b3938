"""The plainest bistable element: two straight rising branches with a falling one between them."""

from stepwell.base import InputError, Vec2, check
from stepwell.mechanism import Element


def trilinear(
    peak: Vec2 = (0.004, 1.0),
    valley: Vec2 = (0.012, -1.0),
    first: float = 250.0,
    last: float = 250.0,
    past: float = 0.5,
    name: str = "trilinear",
) -> Element:
    """A force that rises straight to a peak, falls straight to a valley and rises straight again.

    The energy has two parabolic wells with a straight-sided spinodal region between them. A well
    is one of rest where its branch crosses zero force; it need not.

    Args:
        peak: travel [m] and force [N] where the first branch ends.
        valley: travel [m] and force [N] where the last branch begins: further on, and lower.
        first: stiffness of the first branch [N/m], > 0.
        last: stiffness of the last branch [N/m], > 0.
        past: how far both branches go on past the force of the other corner, as a part of the
            drop from peak to valley [1], >= 0.
        name: what messages and figures call the element.

    Raises:
        ValueError: a valley that is not further on than the peak and lower, or a value out of its
            range.

    Source: Puglisi & Truskinovsky 2000, J. Mech. Phys. Solids 48:1, whose bistable springs these
    are; the branches may differ in stiffness here.
    """
    top, bottom = check.vector("peak", peak, "m, N"), check.vector("valley", valley, "m, N")
    first, last = check.positive("first", first, "N/m"), check.positive("last", last, "N/m")
    past = check.not_negative("past", past, "of the drop")
    drop = top[1] - bottom[1]
    if bottom[0] <= top[0] or drop <= 0:
        raise InputError(
            f"valley at {bottom[0] * 1e3:.6g} mm, {bottom[1]:.6g} N after a peak at "
            f"{top[0] * 1e3:.6g} mm, {top[1]:.6g} N: must be at a larger travel and a smaller "
            f"force, else nothing snaps."
        )
    reach = (1 + past) * drop
    travel = (top[0] - reach / first, top[0], bottom[0], bottom[0] + reach / last)
    return Element.from_points(
        travel, (top[1] - reach, top[1], bottom[1], bottom[1] + reach), name
    )
