"""The Kresling fold: a paper cylinder that twists as it shortens, with two lengths at rest."""

import math

import numpy as np

from stepwell.base import Floats, InputError, check
from stepwell.elements.kept import kept
from stepwell.mechanism import Element

# Halvings of the half turn in which the twist lies: down to the last digit.
_HALVINGS = 55
# How far past the deployed height the law is taken, as a part of the way; there the fold is stiff.
_PAST = 0.1


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
        name: what messages and figures call the element.

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
    return Element.from_law(
        lambda travel: fold_force(folded + travel, sides, radius, rest, (mountain, valley)),
        0.0,
        min(deployed + _PAST * (deployed - folded), upright) - folded,
        name,
        stops=(True, False),
    )


def crease_lengths(
    sides: int, radius: float, folded: float, deployed: float
) -> tuple[float, float]:
    """Mountain and valley crease [m] that are at rest at both heights [m].

    With x the twist of the mountain crease and π/n more, their squares differ by
    4 R² sin x sin π/n and sum up to 2 h² + 4 R² (1 - cos x cos π/n): the places of rest are x and
    π - x, and h1² - h0² = 4 R² cos x cos π/n.

    Raises:
        ValueError: heights that no such fold has.
    """
    half = math.pi / sides
    if deployed <= folded:
        raise InputError(
            f"deployed = {deployed * 1e3:.6g} mm: must be more than folded = {folded * 1e3:.6g} mm."
        )
    cosine = (deployed**2 - folded**2) / (4 * radius**2 * math.cos(half))
    if cosine > math.cos(half):
        most = math.hypot(folded, 2 * radius * math.cos(half))
        raise InputError(
            f"deployed = {deployed * 1e3:.6g} mm: must be at most {most * 1e3:.6g} mm for this "
            f"radius and folded height; there the mountain creases stand upright."
        )
    turn = math.acos(cosine)
    return (
        math.hypot(deployed, _chord(turn - half, radius)),
        math.hypot(deployed, _chord(turn + half, radius)),
    )


def fold_force(
    height: Floats,
    sides: int,
    radius: float,
    rest: tuple[float, float],
    stiffness: tuple[float, float],
) -> Floats:
    """Axial force [N] at heights [m] of any shape, at the twist of least energy.

    Args:
        height: from the folded to that where the mountain creases stand upright.
        sides: n of the end polygons.
        radius: R [m] of their corners.
        rest: length [m] of a mountain and a valley crease at rest.
        stiffness: of a mountain and a valley crease [N/m].
    """
    half = math.pi / sides

    def tension(turn: Floats) -> tuple[Floats, Floats]:
        """Tension over length [N/m] of both creases."""
        lengths = (
            np.hypot(height, _chord(turn - half, radius)),
            np.hypot(height, _chord(turn + half, radius)),
        )
        mountain, valley = (
            k * (1 - r / now) for k, r, now in zip(stiffness, rest, lengths, strict=True)
        )
        return mountain, valley

    # The torque vanishes once between these twists: at the first the mountain crease has no lever
    # and the valley crease is too short, at the last it is the other way around.
    low, high = np.full(np.shape(height), half), np.full(np.shape(height), math.pi - half)
    for _ in range(_HALVINGS):
        turn = (low + high) / 2
        mountain, valley = tension(turn)
        past = mountain * np.sin(turn - half) + valley * np.sin(turn + half) > 0
        low, high = np.where(past, low, turn), np.where(past, turn, high)
    mountain, valley = tension((low + high) / 2)
    return sides * height * (mountain + valley)


def _chord(angle: Floats | float, radius: float) -> Floats:
    return 2 * radius * np.sin(np.asarray(angle) / 2)
