"""How far a built mechanism may be from its drawing, as commands are told."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.base import ONE_BY_ONE, QUICKLY, USUAL_ANCHOR, USUAL_STIFFNESS, Measure, told_in
from stepwell.cli.screen import usable

if TYPE_CHECKING:
    from stepwell.design import Tolerances

ANCHOR_MM, STIFFNESS_PERCENT = USUAL_ANCHOR * 1e3, USUAL_STIFFNESS * 1e2

Anchor = Annotated[
    float,
    typer.Option(
        "--anchor", metavar="MM", help="Every anchor lies within this radius [mm].", min=0
    ),
]
StiffnessSpread = Annotated[
    float,
    typer.Option(
        metavar="PERCENT",
        help="Standard deviation of a band's stiffness, or of all forces of an element alike [%].",
        min=0,
        max=24.9,
    ),
]
RestLengthSpread = Annotated[
    float,
    typer.Option(
        metavar="PERCENT", help="Standard deviation of a band's rest length [%].", min=0, max=24.9
    ),
]
LeverTolerance = Annotated[
    float,
    typer.Option(metavar="MM", help="Every cell's lever is off by up to this [mm].", min=0),
]
Friction = Annotated[
    float,
    typer.Option(
        metavar="N",
        help="Every cell has up to this more friction [N; kPa or mN m where forces are].",
        min=0,
    ),
]
TravelSpread = Annotated[
    float,
    typer.Option(
        metavar="PERCENT",
        help="Standard deviation of all travels of an element alike [%].",
        min=0,
        max=24.9,
    ),
]
Samples = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help=f"How many mechanisms are made at random; {QUICKLY}, or {ONE_BY_ONE} "
        "where each is followed by the engine.",
        min=1,
    ),
]
Seed = Annotated[int, typer.Option(help="Which ones: the same seed, the same mechanisms.", min=0)]


def tolerances(
    anchor: float,
    stiffness: float,
    rest_length: float,
    lever: float,
    friction: float,
    travel: float = 0.0,
    measure: Measure = Measure.TRAVEL,
) -> Tolerances:
    """The tolerances of these options: mm, %, %, mm, a force as people are told it, %."""
    from stepwell.design import Tolerances

    _, factor = told_in(measure.force_unit)
    with usable("tolerances"):
        return Tolerances(
            anchor / 1e3,
            stiffness / 1e2,
            rest_length / 1e2,
            lever / 1e3,
            friction / factor,
            travel / 1e2,
        )
