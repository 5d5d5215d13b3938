"""Options for the actuator of a chain and for its program."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Annotated, Any

import typer

import stepwell as sw
from stepwell.base import display_unit
from stepwell.cli.screen import progress, usable, wrong


def drive(text: str) -> str | float:
    """stroke, force, or a stiffness in N/m."""
    if text in ("stroke", "force"):
        return text
    stiffness = -1.0
    with suppress(ValueError):
        stiffness = float(text)
    if not sw.mechanism.SOFTEST <= stiffness <= sw.mechanism.STIFFEST:
        ends = f"{sw.mechanism.SOFTEST:g} to {sw.mechanism.STIFFEST:g}"
        must = f"must be stroke, force, or the actuator's stiffness in N/m, {ends}."
        raise typer.BadParameter(f"{text!r}: {must}")
    return stiffness


def _option(units: str, default: str) -> Any:
    return typer.Option(
        "--drive",
        parser=drive,
        metavar="DRIVE",
        help="Drive: stroke (displacement control), force (force control), or the stiffness of the "
        f"actuator [{units}]; {default} by default.",
    )


Drive = Annotated[str | None, _option("N/m, kPa/mL or N m/rad", "as in the design")]
NewDrive = Annotated[str | None, _option("N/m", "the stroke")]


def drive_of(drive: str | float | None, chain: sw.Chain) -> str | float | None:
    """The drive for `Chain.graph`: a stiffness in SI, or the text itself."""
    _, factor = display_unit(chain.measure.stiffness_unit)
    return drive / factor if isinstance(drive, float) else drive


def stiffness_of(drive: str | float | None) -> float:
    """Stiffness of the actuator [N/m]: 0 for force control, infinite for displacement control."""
    return drive if isinstance(drive, float) else 0.0 if drive == "force" else math.inf


From = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar="STATE",
        help="Start state, such as 10, inner cell first; all cells at 0 by default.",
    ),
]
Target = Annotated[
    str | None,
    typer.Option("--target", metavar="TARGET", help="Target: the state to end in, such as 01."),
]


def planned(
    chain: sw.Chain, start: str | None, target: str | None, robust: float | None = None
) -> sw.Program:
    """The shortest program; raises `Unreachable` if there is none."""
    if target is None:
        raise wrong("--from", "needs --target STATE, the state to end in.")
    last = chain.last_state
    digits = "characters 0 or 1" if set(last) == {"1"} else f"digits up to {last}"
    for option, state in (("--from", start), ("--target", target)):
        if state is not None and not _is_state(state, last):
            raise wrong(option, f"{state!r}: must be {len(chain)} {digits}, inner cell first.")
    with usable("--from", sw.Unreachable), progress("program") as tell:
        return chain.program(target, start=start, robust=robust, progress=tell)


def _is_state(state: str, last: str) -> bool:
    return len(state) == len(last) and all("0" <= a <= b for a, b in zip(state, last, strict=True))


def program_in_file(file: sw.files.DesignFile) -> sw.Program:
    """The program of a design file, on its chain."""
    chain = file.chain
    if file.program is None:
        problem = "has no table [program]: pass --target STATE to plan one."
        raise sw.files.DesignError(file.name, [problem])
    try:
        return file.program.on(chain)
    except ValueError as error:
        raise sw.files.DesignError(file.name, [f"program: {error}"]) from None
