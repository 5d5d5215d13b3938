"""A pre-shaped curved beam, clamped at both ends, that snaps through when its middle is pushed."""

import math

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import Floats, check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element

# Symmetric modes past the first, o = 3, 5 … of shape 1 - cos 2πoX, and the sum of o⁻⁴ over those
# beyond them, an integral by the midpoint rule.
_MODES = np.arange(3.0, 402.0, 2.0)
_BEYOND = 1 / (6 * (_MODES[-1] + 1) ** 3)
# Compression of the mode with a node in the middle, over that of the first: more is not carried.
_MOST = 4.0
_HALVINGS = 60
# How far past 0 and twice the height the law is taken, in heights; there the beam is stiff.
_PAST = 0.1


@kept
def curved_beam(
    span: float = 0.080,
    height: float = 0.005,
    thickness: float = 0.0008,
    width: float = 0.005,
    modulus: float = 1.7e9,
    beams: int = 2,
    name: str = "curved beam",
) -> Element:
    """Cosine-shaped beams side by side, joined in their middle, which cannot turn.

    Small slopes (height and thickness well below the span), a material that stays linear, ends
    that do not give, and no stress as made. The antisymmetric mode is held back, as two beams
    joined in the middle do. The beam rests as made at travel 0, and again at nearly twice the
    height if Q = height/thickness > 2.31. On the way strain comes to 3.4 π² t h/l².

    Args:
        span: l [m] between the clamps, > 0.
        height: h [m] of the apex as made, > 0.
        thickness: t [m] in the plane of bending, > 0.
        width: b [m] across that plane, > 0.
        modulus: Young's modulus E [Pa], > 0; the default is printed polyamide 12.
        beams: how many side by side, >= 1; one alone needs a guide that keeps its middle upright.
        name: what messages and figures call the element.

    Raises:
        ValueError: a value out of its range.

    Source: Qiu, Lang & Slocum 2004, J. Microelectromech. Syst. 13:137, with all symmetric modes
    summed up. Their peak of 740 E I h/l³ at 0.16 h and valley of -370 E I h/l³ at 1.92 h (one
    beam, I = b t³/12) are about those of Q = 9 here; for ever larger Q they come to 759 and -384.
    """
    span = check.positive("span", span, "m")
    height = check.positive("height", height, "m")
    thickness = check.positive("thickness", thickness, "m")
    width = check.positive("width", width, "m")
    modulus = check.positive("modulus", modulus, "Pa")
    beams = check.whole("beams", beams, 1)
    unit = beams * modulus * (width * thickness**3 / 12) * height / span**3
    q = height / thickness
    return Element.from_law(
        lambda travel: unit * beam_force(travel / height, q),
        -_PAST * height,
        (2 + _PAST) * height,
        name,
        kinks=tuple(height * kink for kink in beam_kinks(q)),
    )


def beam_force(depth: ArrayLike, q: float) -> Floats:
    """Force over E I h/l³ [1] of one beam whose middle was pushed by depths Δ = d/h of any shape.

    The shape is w/h = a (1 - cos 2πX)/2 + Σ over the other modes, a = 1 as made. With ζ the
    compression over 4π² E I/l² and φ = 1 - (1 - ζ) a, equilibrium is F = 2π⁴ φ,
    Δ = 1 - a + φ s and ζ = ¾ Q² (1 - a² - φ² s'), where s(ζ) = Σ 1/(o² (o² - ζ)) over o = 3, 5 …
    At ζ = 4 the mode 1 - cos 4πX, with a node in the middle, takes up what is too long.
    """
    depth = np.asarray(depth, float)
    # The energy at a given depth, least over the shapes, is concave in ζ: its slope, the excess of
    # what the length asks for, falls through zero once.
    low = -q * q * (1 + np.abs(1 - depth)) ** 2
    high = np.full(depth.shape, _MOST)
    for _ in range(_HALVINGS):
        zeta = (low + high) / 2
        more = _excess(depth, zeta, q) > 0
        low, high = np.where(more, zeta, low), np.where(more, high, zeta)
    zeta = np.where(_excess(depth, np.full(depth.shape, _MOST), q) > 0, _MOST, (low + high) / 2)
    return 2 * math.pi**4 * (1 - (1 - zeta) * _first_mode(depth, zeta))


def beam_kinks(q: float) -> tuple[float, ...]:
    """Depths Δ between which the mode with a node in the middle is there: two, or none.

    They are where ζ = 4 solves the equations of `beam_force` without that mode.
    """
    s, slope = (float(sum_) for sum_ in _sums(np.asarray(_MOST)))
    # (1 + 9 s') a² + 6 s' a + s' - 1 + 16/(3 Q²) = 0, with φ = 1 + 3 a.
    root = 9 * slope**2 - (1 + 9 * slope) * (slope - 1 + 16 / (3 * q * q))
    if root <= 0:
        return ()
    ends = ((-3 * slope + sign * math.sqrt(root)) / (1 + 9 * slope) for sign in (1, -1))
    first, last = (1 - a + (1 + 3 * a) * s for a in ends)
    return first, last


def _first_mode(depth: Floats, zeta: Floats) -> Floats:
    s, _ = _sums(zeta)
    return (1 + s - depth) / (1 + (1 - zeta) * s)


def _excess(depth: Floats, zeta: Floats, q: float) -> Floats:
    a = _first_mode(depth, zeta)
    _, slope = _sums(zeta)
    return 0.75 * q * q * (1 - a * a - (1 - (1 - zeta) * a) ** 2 * slope) - zeta


def _sums(zeta: Floats) -> tuple[Floats, Floats]:
    """The sum s of 1/(o² (o² - ζ)) over the modes past the first, with its slope by ζ."""
    square = _MODES**2
    gap = square - zeta[..., None]
    return (1 / (square * gap)).sum(-1) + _BEYOND, (1 / (square * gap**2)).sum(-1)
