"""`stepwell design`: where the bands have to go for a wanted motion."""

import math
from dataclasses import replace
from enum import StrEnum
from functools import partial
from typing import Annotated

import typer

from stepwell.cli.options import (
    Force,
    Json,
    NewDrive,
    Out,
    Range,
    free,
    span,
    stiffness_of,
    stock,
    tolerances as given,
    wish,
)
from stepwell.cli.screen import answered, finish, progress, usable

_Side = Annotated[
    Range | None,
    typer.Option(
        parser=span,
        metavar="FROM:TO",
        help="Where anchors q may be [mm]; for the paper's lever 0:20 and -15:15 by default, for "
        "others in proportion.",
    ),
]


class Objective(StrEnum):
    """What is made as large as possible."""

    YIELD = "yield"
    WORST = "worst"


def design(
    target: Annotated[
        str,
        typer.Argument(
            metavar="TARGET",
            help="A cycle as in '00>10>11>01>00', the states wanted in reach as in 00,10,11, or "
            "all:N for N cells with all their states.",
        ),
    ],
    x: _Side = None,
    y: _Side = None,
    holes: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            help="Anchors only in holes this far apart, from the lower left corner on [mm].",
            min=0.01,
        ),
    ] = None,
    bands: Annotated[
        list[str] | None,
        typer.Option(
            "--band",
            metavar="NAME|K:LENGTH[:SPREAD]",
            help="A band there is: paper, robot, antennas, or N/m, mm and %; may be given again.",
        ),
    ] = None,
    levers: Annotated[
        list[float] | None,
        typer.Option(
            "--lever",
            metavar="MM",
            help="A lever there is [mm]; may be given again. The paper's by default.",
        ),
    ] = None,
    mixed_levers: Annotated[
        bool, typer.Option("--mixed-levers", help="Cells may have different ones of these levers.")
    ] = False,
    objective: Annotated[
        Objective,
        typer.Option(
            help="Make the yield largest, or the distance by which all anchors may be off at once.",
        ),
    ] = Objective.YIELD,
    force_limit: Annotated[
        float | None, typer.Option(metavar="N", help="Largest force of the actuator [N].", min=0)
    ] = None,
    drive: NewDrive = None,
    anchor: given.Anchor = given.ANCHOR_MM,
    stiffness_spread: given.StiffnessSpread = given.STIFFNESS_PERCENT,
    rest_length_spread: given.RestLengthSpread = 0.0,
    lever_tolerance: given.LeverTolerance = 0.0,
    friction: given.Friction = 0.0,
    unusual: Annotated[
        bool,
        typer.Option("--unusual", help="Sizes far off the levers are meant, and no slip of unit."),
    ] = False,
    samples: given.Samples = None,
    seed: given.Seed = 0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find anchors for a wanted cycle, or for a wanted set of states.

    You get the anchors, checked by the engine, how many mechanisms built with these
    tolerances will do it, and which two cells go wrong first; or the certificate that nothing
    allowed does it. With --out, the design file, a figure of the forces that a cell can have,
    and the result as JSON are written into a folder.
    """
    from stepwell import reports, results
    from stepwell.cli.text import design as texts
    from stepwell.design import Impossible, design
    from stepwell.design.placement import PAPER_LEVER, usual_box

    wanted = wish(target)
    lengths = [lever / 1e3 for lever in levers or ()] or [PAPER_LEVER]
    spread = given.tolerances(
        anchor, stiffness_spread, rest_length_spread, lever_tolerance, friction
    )
    free(out, "design", force)
    try:
        with usable("TARGET", Impossible), progress("design") as tell:
            found = design(
                **wanted,
                within=replace(
                    usual_box(max(lengths)),
                    **({} if x is None else {"left": x.start / 1e3, "right": x.stop / 1e3}),
                    **({} if y is None else {"bottom": y.start / 1e3, "top": y.stop / 1e3}),
                ),
                holes=None if holes is None else holes / 1e3,
                bands=[stock(text) for text in bands or ["paper"]],
                lever=lengths,
                equal_levers=not mixed_levers,
                tolerances=spread,
                objective=objective.value,
                most_force=math.inf if force_limit is None else force_limit,
                actuator_stiffness=stiffness_of(drive),
                unusual=unusual,
                n=samples,
                seed=seed,
                progress=tell,
            )
    except Impossible as why:
        record, write = results.impossible_record(why), None
    else:
        record, write = results.design_record(found), partial(reports.write_design, found)
    finish(record, texts.design, as_json, out, force, write)
    answered(record["possible"])
