"""`stepwell yield`: how many built mechanisms do what the drawing does."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import Design, Force, Json, Out, tolerances as given

if TYPE_CHECKING:
    from stepwell.design import Tolerances

_Wanted = Annotated[
    str | None,
    typer.Option(
        metavar="TARGET",
        help="The cycle that counts, as 00>10>11>01>00, or states that shall be in reach and no "
        "others, as 00,10,11; the cycle of the drawing by default.",
    ),
]
_Program = Annotated[
    bool,
    typer.Option(
        "--program", help="Count those that the design's own program brings where it should."
    ),
]
_Sensitivity = Annotated[
    bool, typer.Option("--sensitivity", help="Say which part's tolerance counts for how much.")
]


def yield_(
    design: Design,
    anchor: given.Anchor = given.ANCHOR_MM,
    stiffness_spread: given.StiffnessSpread = given.STIFFNESS_PERCENT,
    rest_length_spread: given.RestLengthSpread = 0.0,
    lever_tolerance: given.LeverTolerance = 0.0,
    friction: given.Friction = 0.0,
    wanted: _Wanted = None,
    sensitivity: _Sensitivity = False,
    program: _Program = False,
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
    from stepwell.cli.options import free
    from stepwell.cli.screen import progress, show_result, usable
    from stepwell.cli.text import yields as _yield_text
    from stepwell.design import yields

    spread = given.tolerances(
        anchor, stiffness_spread, rest_length_spread, lever_tolerance, friction
    )
    text = files.read(design)
    free(out, "yield", force, design=text)
    if program:
        if wanted or sensitivity:
            option = "--wanted" if wanted else "--sensitivity"
            raise typer.BadParameter("cannot stand with --program.", param_hint=option)
        record, names = _survival(text, design, spread, samples, seed, out, force)
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
        record, names = results.yield_record(found, design=text), ()
        if out is not None:
            with progress("writing") as tell:
                names = reports.write_yield(found, out, design=text, progress=tell, force=force)
    show_result(record, _yield_text.show, as_json, out, names)


def _survival(
    text: str,
    design: str,
    spread: "Tolerances",
    samples: int | None,
    seed: int,
    out: Path | None,
    force: bool,
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """How many mechanisms the design's own program brings where it should, and files written."""
    from stepwell import reports, results
    from stepwell.cli.options import own
    from stepwell.cli.screen import progress
    from stepwell.design import survival

    program = own(text, design)
    points, way = program.turning_points, (program.start, program.to)
    with progress("yield") as tell:
        found = survival(
            program.chain, points, way[1], spread, start=way[0], n=samples, seed=seed, progress=tell
        )
    names: tuple[str, ...] = ()
    if out is not None:
        names = reports.write_survival(found, out, design=text, force=force)
    return results.survival_record(found, design=text), names
