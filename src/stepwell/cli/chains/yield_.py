"""`stepwell yield`: how many built mechanisms do what the drawing does."""

from functools import partial
from typing import Annotated

import typer

from stepwell.cli.options import Design, Force, Json, Out, free, own, tolerances as given
from stepwell.cli.screen import finish, progress, usable


def yield_(
    design: Design,
    anchor: given.Anchor = given.ANCHOR_MM,
    stiffness_spread: given.StiffnessSpread = given.STIFFNESS_PERCENT,
    rest_length_spread: given.RestLengthSpread = 0.0,
    lever_tolerance: given.LeverTolerance = 0.0,
    friction: given.Friction = 0.0,
    wanted: Annotated[
        str | None,
        typer.Option(
            metavar="TARGET",
            help="The cycle that counts, as 00>10>11>01>00, or states that shall be in reach and "
            "no others, as 00,10,11; the cycle of the drawing by default.",
        ),
    ] = None,
    sensitivity: Annotated[
        bool, typer.Option("--sensitivity", help="Say which part's tolerance counts for how much.")
    ] = False,
    program: Annotated[
        bool,
        typer.Option(
            "--program", help="Count those that the design's own program brings where it should."
        ),
    ] = False,
    samples: given.Samples = None,
    seed: given.Seed = 0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say how many mechanisms, built with these tolerances, do what the design does.

    Mechanisms are made at random and judged one by one; you get the share with its 95 %
    interval, what the others do, and the two cells that go wrong first. With --out, figures,
    outcomes as CSV and the result as JSON are written into a folder, together with the design.
    """
    from stepwell import files, reports, results
    from stepwell.cli.text import design as texts
    from stepwell.design import survival, yields

    spread = given.tolerances(
        anchor, stiffness_spread, rest_length_spread, lever_tolerance, friction
    )
    text = files.read(design)
    free(out, "yield", force, design=text)
    if program and (wanted or sensitivity):
        option = "--wanted" if wanted else "--sensitivity"
        raise typer.BadParameter("cannot stand with --program.", param_hint=option)
    if program:
        played = own(text, design)
        points, start, ends = played.turning_points, played.start, played.to
        with progress("yield") as tell:
            kept = survival(
                played.chain, points, ends, spread, start=start, n=samples, seed=seed, progress=tell
            )
        record = results.survival_record(kept, design=text)
        write = partial(reports.write_survival, kept, design=text)
    else:
        states = wanted.split(",") if wanted and "," in wanted else None
        with usable(design), progress("yield") as tell:
            found = yields(
                files.loads_chain(text, design),
                spread,
                n=samples,
                seed=seed,
                wanted=states or wanted,
                sensitivity=sensitivity,
                progress=tell,
            )
        record = results.yield_record(found, design=text)
        write = partial(reports.write_yield, found, design=text)
    finish(record, texts.yields, as_json, out, force, write)
