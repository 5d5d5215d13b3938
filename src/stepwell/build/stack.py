"""Heights of the layers of a build, and standard lengths of pins and screws."""

from typing import NamedTuple

from stepwell.build.build_file import BuildFile

# Nominal lengths [mm]: dowel pins by ISO 8734, button head screws by ISO 7380-1 (extract).
PIN_LENGTHS = (4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 35, 40, 45, 50, 55, 60)
SCREW_LENGTHS = (6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60)


class Stack(NamedTuple):
    """z of the lower faces of all layers [m], from the lowest sheet upwards.

    `stop` is the layer of arc slots under the blocks; None if no cell has one.
    """

    thickness: float
    shim: float
    stop: float | None
    bottom: float
    middle: float
    top: float
    roof: float  # upper face of the top plates
    bands: float  # lower face of the first band

    @property
    def floor(self) -> float:
        """Lower face of the lowest sheet [m]."""
        return self.bottom if self.stop is None else self.stop

    def layer(self, base: float) -> int:
        """Number of the layer with this lower face, from 0 at the bottom."""
        bases = [one for one in (self.stop, self.bottom, self.middle, self.top) if one is not None]
        return bases.index(base)


def stack_of(build_file: BuildFile, *, slots: bool) -> Stack:
    """The heights for a build file, with a layer of arc slots or without."""
    thick, shim = build_file.sheet.thickness, build_file.lever.shim
    step = thick + shim
    bottom = step if slots else 0.0
    top = bottom + 2.0 * step
    roof = top + thick
    floor = 0.0
    screw = build_file.screw
    ends = max(
        roof + screw.nut,
        floor + screw_length(roof - floor + screw.nut),
        bottom + pin_length(roof - bottom),
    )
    return Stack(
        thickness=thick,
        shim=shim,
        stop=floor if slots else None,
        bottom=bottom,
        middle=bottom + step,
        top=top,
        roof=roof,
        bands=ends + build_file.hook.clearance,
    )


def pin_length(least: float) -> float:
    """The shortest standard length of a pin [m] not below `least` [m]; else `least` itself."""
    return next((mm * 1e-3 for mm in PIN_LENGTHS if mm * 1e-3 >= least - 1e-9), least)


def pin_length_below(most: float) -> float:
    """The longest standard length of a pin [m] up to `most` [m]; else `most` itself."""
    return max((mm * 1e-3 for mm in PIN_LENGTHS if mm * 1e-3 <= most + 1e-9), default=most)


def screw_length(least: float) -> float:
    """The shortest standard length of a screw [m] not below `least` [m]; else `least` itself."""
    return next((mm * 1e-3 for mm in SCREW_LENGTHS if mm * 1e-3 >= least - 1e-9), least)
