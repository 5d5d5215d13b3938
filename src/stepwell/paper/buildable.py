"""The paper's robots as they can be cut: parts of acrylic, friction of rails, a slow actuator."""

from dataclasses import dataclass, replace
from functools import cache

from stepwell import base, files
from stepwell.build import build
from stepwell.paper.walking import robot
from stepwell.robot import Robot

MATERIAL = "acrylic-3mm"
# Friction of the middle slider's rail [N]: estimated for sliding without lubricant, 0.08 to 0.16 N,
# and assumed for rollers.
DRY, ROLLERS = 0.15, 0.01
# Factors on the stiffness of the bands, 37.5 and 75 over 30 N/m: enough for rollers, and for dry
# rails.
FIRM, STIFF = 1.25, 2.5


@dataclass(frozen=True, slots=True, eq=False)
class Variant(base.ByValue):
    """A way to make the robots: idealised, or cut with a rail friction and with bands.

    Attributes:
        label: in tables.
        cut: whether masses, shapes and period are those of a build.
        rail_friction: of the middle slider [N].
        stiffer: factor on the stiffness of every band [1].
    """

    label: str
    cut: bool = True
    rail_friction: float = 0.0
    stiffer: float = 1.0


VARIANTS = {
    "idealised": Variant("idealised", cut=False),
    "rollers": Variant("cut, rollers", rail_friction=ROLLERS),
    "rollers-firm": Variant("cut, rollers, bands × 1.25", True, ROLLERS, FIRM),
    "dry": Variant("cut, dry rails", rail_friction=DRY),
    "dry-stiff": Variant("cut, dry rails, bands × 2.5", True, DRY, STIFF),
}


@cache
def buildable(name: str, variant: str | Variant = "rollers") -> Robot:
    """A shipped robot as it can be cut from 3 mm acrylic, with its parts.

    Args:
        name: "forward", "backward", "left", "right", "15", "antennas" or "explorer".
        variant: one of `VARIANTS`, or another one.

    Raises:
        ValueError: an unknown name or variant.
        ExtraError: the extra "build" is not installed.
    """
    if isinstance(variant, str):
        if variant not in VARIANTS:
            allowed = ", ".join(map(repr, VARIANTS))
            raise base.InputError(f"variant = {variant!r}: must be one of {allowed}.")
        variant = VARIANTS[variant]
    design = robot(name)
    if not variant.cut:
        return design
    bands = {
        one.path: one.values[0] * variant.stiffer
        for one in files.parameters(design)
        if one.path.endswith("band.stiffness_N_per_m")
    }
    made = build(files.vary(design, bands), MATERIAL).robot
    return replace(made, blocks=replace(made.blocks, rail_friction=variant.rail_friction))
