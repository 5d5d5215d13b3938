"""`stepwell paper`: what the paper claims, computed anew."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import Force, Json, Out

_All = Annotated[
    bool,
    typer.Option("--all", help="Also what takes many simulated runs: several minutes."),
]

_Data = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="The authors' recordings, for the claims that they decide.",
    ),
]


def paper(
    everything: _All = False,
    data: _Data = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Check what the paper claims.

    Every claim is computed anew; the verdict says where we agree, where not, and why. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the paper's figures are drawn from the model into a folder.
    """
    import stepwell.paper as claims
    from stepwell.cli.screen import progress, show_result
    from stepwell.cli.text import paper as _paper_text

    with progress("claims") as tell:
        verdicts = claims.run(out, progress=tell, everything=everything, data=data, force=force)
    names = () if out is None else claims.outputs(everything)
    record = claims.record(verdicts)
    show_result(record, _paper_text.show, as_json, out, names)
