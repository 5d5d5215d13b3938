"""`stepwell paper` and `stepwell validate`: what the paper and others claim, compared."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.accounts import account
from stepwell.cli.options import Force, Json, Out, free
from stepwell.cli.screen import progress, report


def paper(
    everything: Annotated[
        bool,
        typer.Option("--all", help="Also what takes many simulated runs: several minutes."),
    ] = False,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="The authors' recordings, for the claims that they decide.",
        ),
    ] = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Check what the paper claims.

    Every claim is computed; the verdict says where we agree, where not, and why. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the paper's figures are drawn from the model into a folder.
    """
    import stepwell.paper as claims

    free(out, "paper", force)
    with progress("claims") as tell:
        found = claims.run(tell, everything=everything, data=data)
    report(account(found), as_json, out, force, everything=everything)


def validate(as_json: Json = False) -> None:
    """Check results of others about chains of bistable elements.

    Closed forms, transition graphs and sequences that others have published are computed; the
    verdict says where we agree, where not, and why.
    """
    import stepwell.paper as claims

    with progress("claims") as tell:
        found = claims.validate(tell)
    report(account(found), as_json)
