"""The paper's robots as they can be cut: masses of parts, friction of rails, a slow actuator."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from stepwell import base, files
from stepwell.paper.walking import robot
from stepwell.robot import FROM_PARTS, Robot

# Of a layout in 3 mm acrylic, swept without overlap through every pose: masses with their pins and
# screws, and the centre of mass of the body's parts.
MASSES = {
    "body.mass_g": 174.0,
    "body.centre_mm[0]": 26.0,
    "body.centre_mm[2]": 8.1,
    "blocks.mass_g": 23.2,
    "blocks.carriage_g": 19.5,
    "foot.mass_g": 5.5,
}
OUTER = 6.8e-3  # mass of the outermost block [kg]
# Of an actuator with 40 mm of stroke and a 50:1 gear, which moves at 21 to 24 mm/s under load [s].
PERIOD = 3.8
# Friction of the middle slider's rail [N]: estimated for sliding without lubricant, 0.08 to 0.16 N,
# and assumed for rollers.
DRY, ROLLERS = 0.15, 0.01
# Bands of at least this stiffness step over the friction of dry rails [N/m].
STIFF = 75.0


@dataclass(frozen=True, slots=True, eq=False)
class Variant(base.ByValue):
    """A way to make the robots: idealised, or cut with a rail friction and with bands.

    Attributes:
        label: in tables.
        cut: whether masses and period are those of parts and of a hobby actuator.
        rail_friction: of the middle slider [N].
        stiffer: factor on the stiffness of every band [1].
    """

    label: str
    cut: bool = True
    rail_friction: float = 0.0
    stiffer: float = 1.0


PAPER = 30.0  # stiffness of the bands of the paper's robots [N/m]
VARIANTS = {
    "idealised": Variant("idealised", cut=False),
    "rollers": Variant("cut, rollers", rail_friction=ROLLERS),
    "dry": Variant("cut, dry rails", rail_friction=DRY),
    "dry-stiff": Variant("cut, dry rails, stiffer bands", True, DRY, STIFF / PAPER),
}


def buildable(name: str, variant: str | Variant = "rollers") -> Robot:
    """A shipped robot as it can be cut from 3 mm acrylic.

    Args:
        name: "forward", "backward", "left", "right", "15", "antennas" or "explorer".
        variant: one of `VARIANTS`, or another one.

    Raises:
        ValueError: an unknown name or variant.
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
    changes: Mapping[str, float] = {**MASSES, "drive.period_s": PERIOD, **bands}
    design = files.vary(design, changes)
    blocks = replace(design.blocks, outer=OUTER, rail_friction=variant.rail_friction)
    from_parts = dict.fromkeys(("blocks.outer_g", *MASSES), FROM_PARTS)
    return replace(design, blocks=blocks, sources={**design.sources, **from_parts})
