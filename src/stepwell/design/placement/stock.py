"""Bands that can be had."""

import math
from dataclasses import dataclass

from stepwell.base import ByValue, InputError, Vec2
from stepwell.mechanism import Band, Law, Linear

_HOOKE = Linear()


@dataclass(frozen=True, slots=True, eq=False)
class Stock(ByValue):
    """A kind of band from a catalogue.

    Args:
        stiffness: k [N/m], > 0.
        rest_length: ℓ0 [m], >= 0.
        spread: standard deviation of k from band to band over its mean [1]; None for the one
            in the tolerances.
        name: what the catalogue calls it.
        law: tension is `stiffness` times this shape of the extension, such as a measured Table.

    Raises:
        ValueError: a value out of its range.

    Source: the defaults are the paper's band, Kamp et al. 2024.
    """

    stiffness: float = 28.5
    rest_length: float = 0.010
    spread: float | None = None
    name: str = ""
    law: Law = _HOOKE

    @classmethod
    def of(cls, band: Band, spread: float | None = None, name: str = "") -> "Stock":
        """A band that there is, measured or of another design; its anchors are not looked at."""
        return cls(band.stiffness, band.rest_length, spread, name, band.law)

    def between(self, p: Vec2, q: Vec2) -> Band:
        """Such a band between two anchors [m]."""
        return Band(p, q, self.stiffness, self.rest_length, self.law)

    def __post_init__(self):
        if not 0 < self.stiffness < math.inf:
            raise InputError(f"stiffness = {self.stiffness} N/m: must be > 0 and finite.")
        if not 0 <= self.rest_length < math.inf:
            raise InputError(f"rest_length = {self.rest_length} m: must be >= 0 and finite.")
        if self.spread is not None and not 0 <= self.spread < 0.25:
            raise InputError(
                f"spread = {self.spread}: must be at least 0 and below 0.25; it is a fraction, so "
                f"5 % is 0.05."
            )

    def __repr__(self):
        name = f"{self.name!r}, " if self.name else ""
        spread = "" if self.spread is None else f", ±{self.spread * 100:.3g} %"
        law = "" if isinstance(self.law, Linear) else f", {type(self.law).__name__}"
        return (
            f"Stock({name}k={self.stiffness:.4g} N/m, ℓ0={self.rest_length * 1e3:.4g} mm"
            f"{spread}{law})"
        )


PAPER_BAND = Stock()
