"""A spherical rubber balloon: pressure against the volume that was blown in."""

import math

import numpy as np

from stepwell.base import Floats, InputError, Measure, check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element


@kept
def balloon(
    radius: float = 0.020,
    thickness: float = 0.0002,
    c1: float = 150e3,
    c2: float = 20e3,
    stretch: float = 5.0,
    name: str = "balloon",
) -> Element:
    """A thin sphere of Mooney-Rivlin rubber: its pressure rises, falls and rises again.

    It stays a sphere, its wall a membrane of rubber that keeps its volume. For c2/c1 > 0.2145
    pressure only rises, and nothing snaps; for c2 = 0 it never rises again (neo-Hookean). At its
    largest stretch the balloon is stopped, in place of the stiffening of rubber, which this law
    does not know. Volume counts from the unstretched sphere, the only place of rest; below it the
    pressure goes on straight, where a real balloon hangs slack.

    Args:
        radius: R [m], unstretched, > 0.
        thickness: t [m] of the unstretched wall, > 0 and at most a tenth of the radius.
        c1: first Mooney-Rivlin modulus [Pa], > 0; the shear modulus is 2 (c1 + c2).
        c2: second Mooney-Rivlin modulus [Pa], >= 0.
        stretch: largest radius over R [1], > 1.
        name: what messages and figures call the element.

    Raises:
        ValueError: a value out of its range.

    Source: Rivlin & Saunders 1951, Phil. Trans. R. Soc. A 243:251 (the law of rubber); Müller &
    Strehlow 2004, Rubber and Rubber Balloons (the sphere). The moduli of the default are of the
    size of latex; measure your own.
    """
    radius = check.positive("radius", radius, "m")
    thickness = check.positive("thickness", thickness, "m")
    c1 = check.positive("c1", c1, "Pa")
    c2 = check.not_negative("c2", c2, "Pa")
    stretch = check.positive("stretch", stretch, "of the radius")
    if thickness > radius / 10:
        raise InputError(
            f"thickness = {thickness * 1e3:.6g} mm: must be at most {radius * 1e2:.6g} mm, a tenth "
            f"of the radius: the wall is taken for a membrane."
        )
    if stretch <= 1:
        raise InputError(f"stretch = {stretch}: must be > 1, the largest radius over the first.")
    unstretched = 4 / 3 * math.pi * radius**3
    return Element.from_law(
        lambda volume: balloon_pressure(
            np.cbrt(1 + volume / unstretched), thickness / radius, c1, c2
        ),
        0.0,
        unstretched * (stretch**3 - 1),
        name,
        stops=(False, True),
        measure=Measure.VOLUME,
    )


def balloon_pressure(stretch: Floats, slenderness: float, c1: float, c2: float) -> Floats:
    """P = 4 t/R (1/λ - 1/λ⁷)(c1 + c2 λ²) [Pa] at stretches λ of any shape, with t/R unstretched."""
    return 4 * slenderness * (1 / stretch - stretch**-7.0) * (c1 + c2 * stretch**2)
