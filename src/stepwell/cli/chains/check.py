"""`stepwell check`: one page, one verdict."""

from typing import Annotated

import typer

from stepwell.cli.options import (
    Data,
    Design,
    Force,
    Json,
    Out,
    calibrated_on,
    free,
    own,
    read_chain,
    tolerances as given,
)
from stepwell.cli.screen import answered, progress, report, usable


def check(
    design: Design,
    want: Annotated[
        str | None,
        typer.Option(
            metavar="SEQUENCE",
            help="The cycle that counts, as 00>10>11>01>00; by default the design's own program, "
            "or without one the cycle of the drawing.",
        ),
    ] = None,
    anchor: given.Anchor = given.ANCHOR_MM,
    stiffness_spread: given.StiffnessSpread = given.STIFFNESS_PERCENT,
    rest_length_spread: given.RestLengthSpread = 0.0,
    lever_tolerance: given.LeverTolerance = 0.0,
    friction: given.Friction = 0.0,
    travel_spread: given.TravelSpread = 0.0,
    data: Data = None,
    samples: given.Samples = None,
    seed: given.Seed = 0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say whether the real one will do it: works, fragile or won't.

    You get the verdict with its reason, the smallest single change that breaks it, the pull and
    the energy lost, what is out of the ordinary, and which one measurement would make it surer.
    Where it won't, the exit code is 3. With --out, a report and the result as JSON are written
    into a folder, together with the design.
    """
    from stepwell import files
    from stepwell.accounts import About, account
    from stepwell.design import check

    text, chain = read_chain(design)
    spread = given.tolerances(
        anchor,
        stiffness_spread,
        rest_length_spread,
        lever_tolerance,
        friction,
        travel_spread,
        chain.measure,
    )
    free(out, "check", force, design=text)
    calibrated = None
    if data is not None:
        text, chain, spread, calibrated = calibrated_on(data, text, chain, spread)
    wanted = want
    if want is None and files.loads(text, design).program is not None:
        wanted = own(text, design)
    with usable(design), progress("check") as tell:
        found = check(chain, wanted, spread, samples=samples, seed=seed, progress=tell)
    report(account(found, About(text, design, calibrated)), as_json, out, force)
    answered(found.verdict != "won't")
