"""What a refusal of a design rests on: all that was excluded, for a proof with enclosures."""

from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Ints
from stepwell.design.plane import Box
from stepwell.design.requirements import Requirement
from stepwell.design.synthesis.candidates import Rule
from stepwell.design.synthesis.region import Region
from stepwell.mechanism import Cell, Element

Cells = tuple[Cell, ...]
# Two orders of cells, 0 the innermost: in ascending F0, and in ascending F1.
RisingOrders = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True, eq=False)
class StateEvidence(ByValue):
    """No two orders of concave cells make a set of states reachable.

    Attributes:
        states: the target states.
        cells: a cell of each kind, and the rectangle of its q - p [m]; empty if the reason holds
            for cells of any kind.
    """

    states: frozenset[str]
    cells: tuple[tuple[Cell, Box], ...]


@dataclass(frozen=True, eq=False)
class HoleEvidence(ByValue):
    """No choice of holes has its critical forces in the target orders.

    Attributes:
        orders: the orders that give the target.
        tables: for each set of bands and levers, and for each cell of the chain, all cells that it
            can be; those whose band goes slack are left out.
        whole: whether a target is reached by these orders only.
        actuator_stiffness: of the chain [N/m].
        states: the target states, in place of a sequence; None for a sequence.
    """

    orders: tuple[RisingOrders, ...]
    tables: tuple[tuple[Cells, ...], ...]
    whole: bool
    actuator_stiffness: float
    states: frozenset[str] | None = None


@dataclass(frozen=True, eq=False)
class RequirementEvidence(ByValue):
    """No two orders meet some requirements.

    Attributes:
        conflict: the smallest requirements that contradict each other.
        number: of cells of the chain.
        cells: as for `StateEvidence`; empty if the requirements name orders only.
    """

    conflict: tuple[Requirement, ...]
    number: int
    cells: tuple[tuple[Cell, Box], ...]


@dataclass(frozen=True, eq=False)
class ScaleEvidence(ByValue):
    """No scales of elements have their switching forces in the target orders.

    Attributes:
        programs: elements of a chain, and the two orders (2, T) of their switches, each.
        force_scale: least and largest factor of an element's own scale.
        most_force: no switching force is larger [N].
    """

    programs: tuple[tuple[tuple[Element, ...], Ints], ...]
    force_scale: tuple[float, float]
    most_force: float


Evidence = StateEvidence | HoleEvidence | ScaleEvidence | RequirementEvidence


def rectangles(rules: list[Rule], regions: tuple[Region, ...]) -> tuple[tuple[Cell, Box], ...]:
    """Each kind of cell, and the rectangle of q - p of its places [m]."""
    cells: list[tuple[Cell, Box]] = []
    for rule in rules:
        for k, region in ((k, one) for k in range(len(rule.kinds)) for one in set(regions)):
            box = region.bounds
            corners = np.array([[box.left, box.bottom], [box.right, box.top]])
            x, y = np.sort(rule.differences(corners), axis=0).T.tolist()
            middle = (corners[0] + corners[1]) / 2
            cell = rule.cell((float(middle[0]), float(middle[1])), k)
            cells.append((cell, Box(x[0], x[1], y[0], y[1])))
    return tuple(cells)
