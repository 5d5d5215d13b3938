"""What the numbers of a chain rest on, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from stepwell.base import Measure, amount, number

if TYPE_CHECKING:
    from stepwell.mechanism import Cell, Chain, Element
    from stepwell.robot import Antenna
    from stepwell.simulation import Walk

_RIGID = (
    "Levers and blocks are rigid, joints have no play, and each cell stops where its blocks touch."
)


def assumptions(chain: Chain) -> list[str]:
    """What the results of a chain rest on, a sentence each."""
    from stepwell.mechanism import Cell, Element, Linear

    words = chain.measure
    named = list(zip(chain.names, chain.cells, strict=True))
    levers = [(name, cell) for name, cell in named if isinstance(cell, Cell)]
    elements = [(name, cell) for name, cell in named if isinstance(cell, Element)]
    rubbed = [f"{n} {amount(c.friction, words.force_unit)}" for n, c in named if c.friction]

    def having(holds: Callable[[Cell], Any]) -> list[str]:
        return [name for name, cell in levers if holds(cell)]

    def told(of: list[str], none: str, some: str, every: str = "") -> str:
        if every and len(of) == len(levers):
            return every
        return some.format(_listed(of)) if of else none

    bands = [
        told(
            having(lambda cell: any(band.two_sided for band in cell.bands)),
            "Bands pull and never push: a slack band carries nothing.",
            "Bands of {} are two-sided springs that also push; the others pull only.",
            "Bands are two-sided springs, as in the paper: below rest length they push.",
        ),
        told(
            having(lambda cell: any(not isinstance(band.law, Linear) for band in cell.bands)),
            "Bands are linear: tension is stiffness times extension, without hysteresis.",
            "Bands of {} follow a nonlinear law; the others are linear.",
            "Bands follow a nonlinear law.",
        ),
    ]
    load = told(
        having(lambda cell: cell.load is not None),
        "No weight or other load acts on a cell.",
        "A load that depends on its travel acts on {}.",
    )
    return [
        f"Quasi-static: the {words.stroke} changes slowly, inertia plays no part between snaps.",
        *([_RIGID] if levers else []),
        *(_curves(elements, words) if elements else []),
        "After a snap the chain lands where overdamped flow at fixed drive leads it, "
        f"{_mobile(named, words)}; the energy released is lost.",
        actuator_words(chain),
        *(bands if levers else []),
        told(
            rubbed,
            "No friction between blocks." if levers else "No friction.",
            f"Coulomb friction against {words.travel}: {{}}.",
        ),
        *([load] if levers else []),
    ]


def simulation_assumptions(walk: Walk) -> list[str]:
    """What the numbers of a simulated walk assume, a sentence each."""
    robot, settings = walk.robot, walk.settings
    feelers = robot.antennas
    return [
        f"Simulated with inertia, contact and friction by MuJoCo, in steps of "
        f"{amount(settings.time_step, 's')}; nothing is random.",
        "The actuator's stroke over time is the only command; gaits follow from bands, weight and "
        "contact.",
        "Levers, links, blocks and floor are rigid, joints have no play; contacts and stops yield "
        f"with a time constant of {amount(settings.contact_time, 's')}.",
        f"Coulomb friction on a flat floor: coefficient {number(robot.floor.foot_friction)} under "
        f"the feet, {number(robot.support_friction)} under the supports.",
        *(
            [f"Antennas are rigid rods on springs, with friction {_frictions(feelers)} on walls."]
            if feelers
            else []
        ),
        "A manufactured robot differs from its nominal design in friction, bands and assembly.",
    ]


def _frictions(antennas: Iterable[Antenna]) -> str:
    return " and ".join(dict.fromkeys(number(one.friction) for one in antennas))


def _mobile(named: list[tuple[str, Cell | Element]], words: Measure) -> str:
    if len({cell.mobility for _, cell in named}) == 1:
        return f"every {words.travel} being equally mobile"
    others = [f"{name} {number(cell.mobility)}" for name, cell in named if cell.mobility != 1.0]
    rest = "" if len(others) == len(named) else ", all others 1"
    return f"every cell with its own mobility: {_listed(others)}{rest}"


def _curves(elements: list[tuple[str, Element]], words: Measure) -> list[str]:
    beyond = [name for name, element in elements if not all(element.stopped)]
    folded = [name for name, element in elements if len(element.laws) > 1]
    told = [
        f"The {words.force} of {_listed([name for name, _ in elements])} follows a curve over "
        f"{words.travel}, at any rate and whatever came before."
    ]
    if beyond:
        told.append(f"Past an end without a stop the curve of {_listed(beyond)} goes on straight.")
    if folded:
        told.append(
            f"Where the curve of {_listed(folded)} folds back, it jumps to the next stable stretch "
            f"along the curve."
        )
    return told


def actuator_words(chain: Chain) -> str:
    """What the actuator of a chain prescribes, in a sentence."""
    words, stiffness = chain.measure, chain.actuator_stiffness
    if math.isinf(stiffness):
        return f"The actuator is rigid: it prescribes the {words.stroke}."
    if stiffness == 0:
        return f"The actuator prescribes the {words.force}, not the {words.stroke}."
    return f"The actuator has a stiffness of {amount(stiffness, words.stiffness_unit)} in series."


def _listed(items: list[str]) -> str:
    return ", ".join(items[:12]) + (f" and {len(items) - 12} more" if len(items) > 12 else "")
