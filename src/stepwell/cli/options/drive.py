"""Which actuator drives a chain, as commands are told."""

import math
from typing import Annotated, Any

import typer


def drive(text: str) -> str | float:
    """stroke, force, or a stiffness in N/m."""
    from stepwell.mechanism import SOFTEST, STIFFEST

    if text in ("stroke", "force"):
        return text
    try:
        stiffness = float(text)
    except ValueError:
        stiffness = -1.0
    if not SOFTEST <= stiffness <= STIFFEST:
        raise typer.BadParameter(
            f"{text!r}: must be stroke, force, or the actuator's stiffness in N/m, {SOFTEST:g} to "
            f"{STIFFEST:g}."
        )
    return stiffness


def _option(default: str) -> Any:
    return typer.Option(
        "--drive",
        parser=drive,
        metavar="stroke|force|K",
        help=f"What the actuator prescribes, or its stiffness [N/m]; {default} by default.",
    )


Drive = Annotated[str | None, _option("as in the design")]
NewDrive = Annotated[str | None, _option("the stroke")]


def stiffness_of(drive: str | float | None) -> float:
    """The stiffness of such an actuator [N/m]; a prescribed stroke where none is named."""
    named = {None: math.inf, "stroke": math.inf, "force": 0.0}
    return named[drive] if drive is None or isinstance(drive, str) else drive
