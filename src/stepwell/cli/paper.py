"""`stepwell paper` and `stepwell validate`: what the paper and others claim, computed anew."""

from pathlib import Path
from typing import Annotated, Any

import typer

from stepwell.cli.options import Force, Json, Out
from stepwell.cli.screen import finish, progress, show_lines, show_table


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

    Every claim is computed anew; the verdict says where we agree, where not, and why. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the paper's figures are drawn from the model into a folder.
    """
    import stepwell.paper as claims

    with progress("claims") as tell:
        verdicts = claims.run(out, progress=tell, everything=everything, data=data, force=force)
    finish(
        claims.record(verdicts),
        _show,
        as_json,
        out,
        write=lambda *_, **__: claims.outputs(everything),
    )


def validate(as_json: Json = False) -> None:
    """Check results of others about chains of bistable elements.

    Closed forms, transition graphs and sequences that others have published are computed anew; the
    verdict says where we agree, where not, and why.
    """
    import stepwell.paper as claims

    with progress("claims") as tell:
        verdicts = claims.validate(tell)
    finish(claims.record(verdicts), _show_others, as_json)


def _show(record: dict[str, Any]) -> None:
    _tell(record, "What the paper claims, and what Stepwell computes")


def _show_others(record: dict[str, Any]) -> None:
    _tell(record, "What others found, and what Stepwell computes")


def _tell(record: dict[str, Any], title: str) -> None:
    claims = record["claims"]
    columns = ["claim", "where", "paper", "ours", "verdict"]
    rows = [[claim[key] for key in ("id", "where", "paper", "ours", "verdict")] for claim in claims]
    show_table(title, columns, rows, left=range(len(columns)))
    reasons = [f"{claim['id']}: {claim['reason']}" for claim in claims if claim["reason"]]
    if reasons:
        show_lines("", *reasons)
    agreed = sum(claim["verdict"] == "agrees" for claim in claims)
    show_lines("", f"{agreed} of {len(claims)} claims agree.")
