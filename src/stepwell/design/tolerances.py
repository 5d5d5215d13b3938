"""How far a built mechanism may be from its drawing."""

import math
from dataclasses import dataclass, fields

_UNITS = {"anchor": "m", "stiffness": "1", "rest_length": "1", "lever": "m", "friction": "N"}


@dataclass(frozen=True, slots=True)
class Tolerances:
    """How far the parts of a built mechanism may be from the drawing, each by itself.

    Args:
        anchor: every anchor p and q lies anywhere within this radius, evenly over the disc [m].
        stiffness: standard deviation of each band's k over its mean, normal, cut at four [1].
        rest_length: the same of ℓ0 [1].
        lever: every cell's lever is up to this much longer or shorter, evenly [m].
        friction: every cell's friction is up to this much more than drawn, evenly [N].

    Raises:
        ValueError: a value that is negative or not finite, or a spread of a quarter or more,
            which would allow bands of no stiffness.
    """

    anchor: float = 0.0
    stiffness: float = 0.0
    rest_length: float = 0.0
    lever: float = 0.0
    friction: float = 0.0

    def __post_init__(self):
        for field in fields(self):
            value = float(getattr(self, field.name))
            if not 0 <= value < math.inf:
                unit = _UNITS[field.name]
                raise ValueError(f"{field.name} = {value} [{unit}]: must be >= 0 and finite.")
            if _UNITS[field.name] == "1" and value >= 0.25:
                raise ValueError(
                    f"{field.name} = {value}: must be < 0.25; it is a fraction, so 5 % is 0.05."
                )
            object.__setattr__(self, field.name, value)

    def __repr__(self):
        return (
            f"Tolerances(anchors ±{self.anchor * 1e3:.4g} mm, stiffness {self.stiffness:.3g}, "
            f"rest length {self.rest_length:.3g}, levers ±{self.lever * 1e3:.4g} mm, friction "
            f"+{self.friction:.3g} N)"
        )
