"""On what the names in a record of a chain depend."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

from stepwell.base import Measure, told_in
from stepwell.mechanism import Chain


class Shape(NamedTuple):
    """A kind of chain: in all chains of a shape the same names are in a record.

    Args:
        measure: what travel and force are.
        force_driven: whether the actuator prescribes the force.
        levers: whether it has cells with levers and bands.
        elements: whether it has elements.
        folds: whether the curve of an element folds back.
    """

    measure: Measure = Measure.TRAVEL
    force_driven: bool = False
    levers: bool = True
    elements: bool = False
    folds: bool = False

    @property
    def drive(self) -> str:
        """The unit of the drive in records."""
        measure = self.measure
        return told_in(measure.force_unit if self.force_driven else measure.travel_unit)[0]

    @classmethod
    def of(cls, chain: Chain) -> Shape:
        """The shape of a chain."""
        elements = chain.elements
        return cls(
            chain.measure,
            chain.actuator_stiffness == 0,
            len(elements) < len(chain),
            bool(elements),
            any(len(element.laws) > 1 for element in elements),
        )


def shapes() -> Iterable[Shape]:
    """All shapes that there are; levers give travel and force alone."""
    for measure, force_driven in product(Measure, (False, True)):
        kinds = [(False, True, False), (False, True, True)]
        if measure is Measure.TRAVEL:
            kinds += [(True, False, False), (True, True, False), (True, True, True)]
        for levers, elements, folds in kinds:
            yield Shape(measure, force_driven, levers, elements, folds)
