"""How travel, force and energy are called and scaled on paper, whatever they are in a chain."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from stepwell.base import Measure, Quantity, told_in
from stepwell.figures.common.words.wording import minus

if TYPE_CHECKING:
    from stepwell.mechanism import Chain

# Of a whole chain, of one cell, and of the force that both share.
_SYMBOLS = {
    Measure.TRAVEL: ("$u$", "$s$", "$F$"),
    Measure.VOLUME: ("$V$", "$v$", "$p$"),
    Measure.ANGLE: (r"$\Phi$", r"$\varphi$", "$T$"),
}


class Told(NamedTuple):
    """A quantity as it is drawn: how many of its unit make one in SI is its factor."""

    word: str
    symbol: str
    sign: str
    factor: float

    @property
    def label(self) -> str:
        """What an axis says."""
        return " ".join(part for part in (self.word, self.symbol, f"[{self.sign}]") if part)

    def value(self, number: float) -> str:
        """What it is, in an equation."""
        return f"{self.symbol} = {self.number(number)} {self.sign}"

    def number(self, number: float) -> str:
        """Three digits of it, or all before the point."""
        told = number * self.factor
        return minus(f"{told:.3g}" if abs(told) < 1000.0 else f"{told:.0f}")


def stroke(measure: Measure) -> Told:
    """What all cells of a chain give together."""
    return _told(measure.stroke, _SYMBOLS[measure][0], measure.travel_unit)


def travel(measure: Measure) -> Told:
    """What one cell gives."""
    return _told(measure.travel, _SYMBOLS[measure][1], measure.travel_unit)


def force(measure: Measure) -> Told:
    """What a cell resists with, and so the actuator."""
    return _told(measure.force, _SYMBOLS[measure][2], measure.force_unit)


def actuator(measure: Measure) -> Told:
    """The force of the actuator, by its name alone."""
    return force(measure)._replace(word=f"Actuator {measure.force}", symbol="")


def drive(chain: Chain) -> Told:
    """What the actuator prescribes."""
    if chain.actuator_stiffness == 0:
        return actuator(chain.measure)
    if math.isinf(chain.actuator_stiffness):
        return stroke(chain.measure)
    return stroke(chain.measure)._replace(word="Actuator", symbol="")


def _told(word: str, symbol: str, unit: str) -> Told:
    told, factor = told_in(unit)
    return Told(word.capitalize(), symbol, Quantity(word, told).sign, factor)
