"""The one actuator: a position command that goes out and comes back."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, check


class Profile(StrEnum):
    """How the command runs from 0 to the amplitude and back."""

    TRIANGLE = "triangle"
    SINE = "sine"
    TRAPEZOID = "trapezoid"


# A trapezoid rests at each end for this share of the period.
REST = 0.125


@dataclass(frozen=True, slots=True, eq=False)
class Drive(ByValue):
    """The position command that all legs share.

    Args:
        amplitude: the stroke it goes out to [m], > 0.
        period: of one cycle out and back [s], > 0.
        profile: constant speed (triangle), a sine, or a constant speed with a rest of an eighth
            of the period at both ends (trapezoid).
        stiffness: of the actuator that follows it [N/m], > 0.

    Raises:
        ValueError: a value out of range.

    Source: Kamp et al. 2024, for 0 to 40 to 0 mm; period and stiffness are assumed.
    """

    amplitude: float = 0.040
    period: float = 2.0
    profile: Profile = Profile.TRIANGLE
    stiffness: float = 2000.0

    def __post_init__(self):
        check.fields(self, check.positive, amplitude="m", period="s", stiffness="N/m")
        check.fields(self, check.one_of, profile=Profile)

    def stroke(self, time: ArrayLike) -> Floats:
        """The commanded stroke [m] at times [s] of any shape; 0 before time 0.

        Args:
            time: from the start of the first cycle [s].

        Returns:
            Strokes of the same shape, 0 .. `amplitude`.
        """
        time = np.asarray(time, float)
        phase = np.where(time > 0, time / self.period % 1.0, 0.0)
        out = 1.0 - np.abs(2.0 * phase - 1.0)
        if self.profile is Profile.SINE:
            out = (1.0 - np.cos(2.0 * np.pi * phase)) / 2.0
        elif self.profile is Profile.TRAPEZOID:
            out = np.clip((out - REST) / (1.0 - 2.0 * REST), 0.0, 1.0)
        return self.amplitude * out
