"""Library of bistable elements: springs, trusses, beams, origami folds, rubber."""

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial, wraps
from typing import Any, ParamSpec

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Measure, ReadOnly, Vec2, check, to_unit
from stepwell.mechanism.element import Element

__all__ = [
    "LIBRARY",
    "LibraryEntry",
    "balloon",
    "curved_beam",
    "dome",
    "kresling",
    "trilinear",
    "von_mises_truss",
]

P = ParamSpec("P")
Pair = tuple[float, float]

# Cached elements; a curve is a few kilobytes, and the least recently used one is dropped.
_MOST = 256


def kept(make: Callable[P, Element]) -> Callable[P, Element]:
    """The same function, which makes an element of the same arguments once.

    Fitting a law with cubics takes up to 0.1 s, and a page asks for all elements of its design
    again after every change of one number. Elements cannot be changed, so they can be shared.
    """
    # 1, 1.0 and True are the same key but not the same argument.
    known = lru_cache(_MOST, typed=True)(make)

    @wraps(make)
    def element(*args: P.args, **kwargs: P.kwargs) -> Element:
        try:
            return known(*args, **kwargs)
        except TypeError:  # a list has no hash, and the function itself reports a wrong argument
            return make(*args, **kwargs)

    return element


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

    Raises:
        ValueError: a valley that is not further on and lower, or a value out of its range.

    Source: Puglisi & Truskinovsky 2000, J. Mech. Phys. Solids 48:1, whose bistable springs these
    are; the branches may differ in stiffness here.
    """
    top, bottom = check.vector("peak", peak, "m, N"), check.vector("valley", valley, "m, N")
    first, last = check.positive("first", first, "N/m"), check.positive("last", last, "N/m")
    drop = top[1] - bottom[1]
    if bottom[0] <= top[0] or drop <= 0:
        raise InputError(
            f"valley at {to_unit(bottom[0], 'mm'):.6g} mm, {bottom[1]:.6g} N after a peak at "
            f"{to_unit(top[0], 'mm'):.6g} mm, {top[1]:.6g} N: must be at a larger travel and a "
            f"smaller force, or the element cannot snap."
        )
    # As far as the force of the other corner; without stops, both ends continue straight.
    travel = (top[0] - drop / first, top[0], bottom[0], bottom[0] + drop / last)
    return Element.from_points(travel, (bottom[1], top[1], bottom[1], top[1]), name, unusual=True)


@kept
def von_mises_truss(
    half_width: float = 0.030,
    height: float = 0.012,
    stiffness: float = 2000.0,
    name: str = "von Mises truss",
) -> Element:
    """Two equal springs from fixed pivots to an apex, which rests on either side of their line.

    Exact at any height: only the springs' lengths change, and they neither bend nor buckle. The
    apex moves on the axis of symmetry. Travel is 0 at rest above and twice the height at rest
    below; the force vanishes at both, and half-way. A quarter of the height past either the force
    continues straight.

    Args:
        half_width: w [m], from the axis to a pivot, > 0.
        height: h [m] of the apex at rest above the pivots, > 0.
        stiffness: k [N/m] of one spring along itself, EA/L of a bar, > 0.

    Raises:
        ValueError: a value out of its range.

    Source: von Mises 1923, Z. angew. Math. Mech. 3:406.
    """
    half_width = check.positive("half_width", half_width, "m")
    height = check.positive("height", height, "m")
    stiffness = check.positive("stiffness", stiffness, "N/m")
    low, high = -height / 4, 2 * height + height / 4
    law = partial(truss_force, half_width=half_width, height=height, stiffness=stiffness)
    return Element.from_law(law, low, high, name)


def truss_force(travel: Floats, half_width: float, height: float, stiffness: float) -> Floats:
    """F = 2 k y (L0/L - 1) [N] at travels [m] of any shape, with y = h - s and L² = w² + y²."""
    y = height - travel
    return 2 * stiffness * y * (np.hypot(half_width, height) / np.hypot(half_width, y) - 1)


# Symmetric modes past the first, o = 3, 5 … of shape 1 - cos 2πoX, and the sum of o⁻⁴ over those
# beyond them, an integral by the midpoint rule.
_MODES = np.arange(3.0, 402.0, 2.0)
_BEYOND = 1 / (6 * (_MODES[-1] + 1) ** 3)
# Compression of the mode with a node in the middle, over that of the first: more is not carried.
_MOST_COMPRESSED = 4.0
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
    kinks = tuple(height * kink for kink in beam_kinks(q))
    low, high = -_PAST * height, (2 + _PAST) * height
    return Element.from_law(
        lambda travel: unit * beam_force(travel / height, q), low, high, name, kinks=kinks
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
    low, most = -q * q * (1 + np.abs(1 - depth)) ** 2, np.full(depth.shape, _MOST_COMPRESSED)
    high = most
    for _ in range(_HALVINGS):
        zeta = (low + high) / 2
        more = _excess(depth, zeta, q) > 0
        low, high = np.where(more, zeta, low), np.where(more, high, zeta)
    zeta = np.where(_excess(depth, most, q) > 0, most, (low + high) / 2)
    return 2 * math.pi**4 * (1 - (1 - zeta) * _first_mode(depth, zeta))


def beam_kinks(q: float) -> tuple[float, ...]:
    """Depths Δ between which the mode with a node in the middle is there: two, or none.

    They are where ζ = 4 solves the equations of `beam_force` without that mode.
    """
    s, slope = (float(sum_) for sum_ in _sums(np.asarray(_MOST_COMPRESSED)))
    # (1 + 9 s') a² + 6 s' a + s' - 1 + 16/(3 Q²) = 0, with φ = 1 + 3 a.
    root = 9 * slope**2 - (1 + 9 * slope) * (slope - 1 + 16 / (3 * q * q))
    if root <= 0:
        return ()
    ends = ((-3 * slope + sign * math.sqrt(root)) / (1 + 9 * slope) for sign in (1, -1))
    return tuple(1 - a + (1 + 3 * a) * s for a in ends)


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


# Displacement [mm] and force [gf] while pressed, read off the raw recording at the steps where the
# curve bends; ThereminGoat, force-curves, "AEBoards Raed HE White (60g Dome) 1", 2025-09-20. Its
# author asks for attribution only. The recording has steps of 0.005 mm and 0.1 gf.
_PRESSED = """
0.185 0.0, 0.250 4.7, 0.300 9.6, 0.350 15.0, 0.400 21.1, 0.450 26.8, 0.500 31.4, 0.600 38.4,
0.700 44.2, 0.800 47.5, 0.900 50.3, 1.000 52.5, 1.100 54.3, 1.205 55.8, 1.300 56.6, 1.425 57.0,
1.600 56.5, 1.800 55.4, 2.015 53.8, 2.200 52.5, 2.400 50.8, 2.605 49.3, 2.800 48.3, 3.000 47.6,
3.200 47.3, 3.400 47.7, 3.600 47.9, 3.800 48.6, 3.870 49.3, 3.900 52.2, 3.945 58.6, 4.005 69.9,
4.045 89.2, 4.085 110.2, 4.120 131.3, 4.150 148.2, 4.185 167.9, 4.215 183.7, 4.235 195.8
"""
_GRAM_FORCE = 9.80665e-3


@kept
def dome(count: int = 1, name: str = "rubber dome") -> Element:
    """A rubber dome of a keyboard switch, from a table of measured numbers.

    It has one place of rest, at travel 0, and is not bistable, but snaps under a force: the force
    rises to 0.559 N at 1.2 mm, falls to 0.464 N at 3.0 mm, and rises steeply from 3.7 mm on, where
    the dome lies on its base. Only the half while pressed is here, of one specimen in its switch,
    whose stem rubs; on the way back the recorded force is smaller. `Element.from_table` makes an
    element of your own table.

    Args:
        count: domes side by side, >= 1; their forces add up.

    Raises:
        ValueError: a count that is not a whole number, 1 or more.

    Source: ThereminGoat 2025, force-curves, recording "AEBoards Raed HE White (60g Dome) 1".
    """
    count = check.whole("count", count, 1)
    travel, force = np.array([point.split() for point in _PRESSED.split(",")], float).T
    travel, force = (travel - travel[0]) * 1e-3, count * force * _GRAM_FORCE
    return Element.from_table(travel, force, name, stops=(True, False), unusual=True)


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
    pressure continues straight, where a real balloon is slack.

    Args:
        radius: R [m], unstretched, > 0.
        thickness: t [m] of the unstretched wall, > 0 and at most a tenth of the radius.
        c1: first Mooney-Rivlin modulus [Pa], > 0; the shear modulus is 2 (c1 + c2).
        c2: second Mooney-Rivlin modulus [Pa], >= 0.
        stretch: largest radius over R [1], > 1.

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
            f"thickness = {to_unit(thickness, 'mm'):.6g} mm: must be at most "
            f"{to_unit(0.1 * radius, 'mm'):.6g} mm, a tenth of the radius: the wall is taken for a "
            "membrane."
        )
    if stretch <= 1:
        raise InputError(f"stretch = {stretch}: must be > 1, the largest radius over the first.")
    unstretched = 4 / 3 * math.pi * radius**3

    def pressure(volume: Floats) -> Floats:
        return balloon_pressure(np.cbrt(1 + volume / unstretched), thickness / radius, c1, c2)

    most, ends = unstretched * (stretch**3 - 1), (False, True)
    return Element.from_law(pressure, 0.0, most, name, stops=ends, measure=Measure.VOLUME)


def balloon_pressure(stretch: Floats, slenderness: float, c1: float, c2: float) -> Floats:
    """P = 4 t/R (1/λ - 1/λ⁷)(c1 + c2 λ²) [Pa] at stretches λ of any shape, with t/R unstretched."""
    return 4 * slenderness * (1 / stretch - stretch**-7.0) * (c1 + c2 * stretch**2)


# Halvings of the half turn in which the twist lies: down to the last digit.
_HALVINGS_OF_FOLD = 55


@kept
def kresling(
    sides: int = 6,
    radius: float = 0.030,
    folded: float = 0.015,
    deployed: float = 0.040,
    mountain: float = 3000.0,
    valley: float = 3000.0,
    name: str = "Kresling fold",
) -> Element:
    """One storey of a Kresling cylinder, pulled along its axis while one end turns freely.

    The truss model: the creases are springs along themselves, creases turn and panels bend for
    nothing, the end polygons are rigid. The twist is the one of least energy at each height.
    Travel counts from the folded height, where the panels lie on each other: a stop.

    Args:
        sides: n of the end polygons, >= 4.
        radius: R [m] of the circle through a polygon's corners, > 0.
        folded: height [m] at rest folded, >= 0; 0 where the fold lies flat.
        deployed: height [m] at rest deployed, > `folded`.
        mountain: stiffness [N/m] of each of the n short (mountain) creases, > 0.
        valley: stiffness [N/m] of each of the n long (valley) creases, > 0.

    Raises:
        ValueError: heights too far apart for the radius, where a mountain crease would lean the
            other way, or a value out of its range.

    Source: Yasuda & Yang 2015, Phys. Rev. Lett. 114:185502 (the truss model); Bhovad, Kaufmann &
    Li 2019, arXiv 1906.04091 (two such folds in series). A flat fold of angle ratio λ has
    deployed = 2 R √(cos x cos π/n) with x = π/n + (π - 2π/n)(1 - λ).
    """
    sides = check.whole("sides", sides, 4)
    radius = check.positive("radius", radius, "m")
    folded = check.not_negative("folded", folded, "m")
    deployed = check.positive("deployed", deployed, "m")
    mountain = check.positive("mountain", mountain, "N/m")
    valley = check.positive("valley", valley, "N/m")
    rest = crease_lengths(sides, radius, folded, deployed)
    upright = math.sqrt(rest[1] ** 2 - _chord(math.tau / sides, radius) ** 2)
    most = min(deployed + _PAST * (deployed - folded), upright) - folded

    def force(travel: Floats) -> Floats:
        return fold_force(folded + travel, sides, radius, rest, (mountain, valley))

    return Element.from_law(force, 0.0, most, name, stops=(True, False))


def crease_lengths(sides: int, radius: float, folded: float, deployed: float) -> Pair:
    """Mountain and valley crease [m] that are at rest at both heights [m].

    With x the twist of the mountain crease and π/n more, their squares differ by
    4 R² sin x sin π/n and sum up to 2 h² + 4 R² (1 - cos x cos π/n): the places of rest are x and
    π - x, and h1² - h0² = 4 R² cos x cos π/n. Other heights raise ValueError.
    """
    half = math.pi / sides
    if deployed <= folded:
        raise InputError(
            f"deployed = {to_unit(deployed, 'mm'):.6g} mm: must be more than folded = "
            f"{to_unit(folded, 'mm'):.6g} mm."
        )
    cosine = (deployed**2 - folded**2) / (4 * radius**2 * math.cos(half))
    if cosine > math.cos(half):
        most = math.hypot(folded, 2 * radius * math.cos(half))
        raise InputError(
            f"deployed = {to_unit(deployed, 'mm'):.6g} mm: must be at most "
            f"{to_unit(most, 'mm'):.6g} mm for this radius and folded height; there the mountain "
            "creases stand upright."
        )
    turn = math.acos(cosine)
    mountain, valley = (_chord(turn + more, radius) for more in (-half, half))
    return math.hypot(deployed, mountain), math.hypot(deployed, valley)


def fold_force(height: Floats, sides: int, radius: float, rest: Pair, stiffness: Pair) -> Floats:
    """Axial force [N] at heights [m] of any shape, at the twist of least energy.

    `rest` [m] and `stiffness` [N/m] are of a mountain and a valley crease. Heights go from the
    folded to that where the mountain creases stand upright.
    """
    half = math.pi / sides

    def tension(turn: Floats) -> tuple[Floats, Floats]:
        """Tension over length [N/m] of both creases."""
        lengths = (np.hypot(height, _chord(turn + more, radius)) for more in (-half, half))
        ways = zip(stiffness, rest, lengths, strict=True)
        mountain, valley = (k * (1 - r / now) for k, r, now in ways)
        return mountain, valley

    # The torque vanishes once between these twists: at the first the mountain crease has no lever
    # and the valley crease is too short, at the last it is the other way around.
    low, high = np.full(np.shape(height), half), np.full(np.shape(height), math.pi - half)
    for _ in range(_HALVINGS_OF_FOLD):
        turn = (low + high) / 2
        mountain, valley = tension(turn)
        past = mountain * np.sin(turn - half) + valley * np.sin(turn + half) > 0
        low, high = np.where(past, low, turn), np.where(past, turn, high)
    mountain, valley = tension((low + high) / 2)
    return sides * height * (mountain + valley)


def _chord(angle: Floats | float, radius: float) -> Floats:
    return 2 * radius * np.sin(np.asarray(angle) / 2)


@dataclass(frozen=True, slots=True, eq=False)
class LibraryEntry(ByValue):
    """One element of the library.

    Args:
        make: the function; called without arguments, it gives something to build.
        what, assumes: description of the element and assumptions of its law, a line each.
        source: author and year.
    """

    make: Callable[..., Element]
    what: str
    assumes: str
    source: str

    @property
    def defaults(self) -> Mapping[str, Any]:
        """The arguments of `make` in SI, but for its name: what they are where none is given."""
        parameters = inspect.signature(self.make).parameters.values()
        return {one.name: one.default for one in parameters if one.name != "name"}


LIBRARY: Mapping[str, LibraryEntry] = ReadOnly(
    {
        "trilinear": LibraryEntry(
            trilinear,
            "two rising branches with a falling one between them",
            "all three straight",
            "Puglisi & Truskinovsky 2000",
        ),
        "von-mises-truss": LibraryEntry(
            von_mises_truss,
            "two inclined springs whose apex is pushed through",
            "springs that stay straight, an apex on the axis of symmetry",
            "von Mises 1923",
        ),
        "curved-beam": LibraryEntry(
            curved_beam,
            "cosine-shaped beams, clamped at both ends and joined in the middle",
            "small slopes, a linear material, rigid clamps, no turning of the middle",
            "Qiu, Lang & Slocum 2004",
        ),
        "balloon": LibraryEntry(
            balloon,
            "a spherical rubber balloon, pressure against volume",
            "a thin Mooney-Rivlin membrane that stays a sphere, without loss",
            "Rivlin & Saunders 1951",
        ),
        "kresling": LibraryEntry(
            kresling,
            "a paper cylinder that twists as it shortens, one end free to turn",
            "creases that are springs along themselves and turn for nothing, rigid ends",
            "Yasuda & Yang 2015",
        ),
        "dome": LibraryEntry(
            dome,
            "a rubber dome of a keyboard switch, from a measured table",
            "one specimen, the half while pressed, friction of its stem within the force",
            "ThereminGoat 2025",
        ),
    }
)
