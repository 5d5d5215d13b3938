"""`stepwell paper`: what the paper claims, computed anew."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli._options import Json, Out

_All = Annotated[
    bool,
    typer.Option("--all", help="Also what takes many simulated runs: several minutes."),
]

_Data = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="The authors' recordings, for the claims that they decide.",
        show_default=False,
    ),
]


def paper(
    everything: _All = False, data: _Data = None, out: Out = None, as_json: Json = False
) -> None:
    """Check what the paper claims.

    Every claim is computed anew; the verdict says where we agree, where not, and why. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the paper's figures are drawn from the model into a folder.
    """
    import stepwell.paper as claims
    from stepwell.cli import _paper_text
    from stepwell.cli._progress import progress
    from stepwell.cli._show import show_json, show_written
    from stepwell.files import staged_folder

    names: tuple[str, ...] = ()
    with staged_folder(out) if out is not None else nullcontext() as draft:
        with progress("claims") as tell:
            verdicts = claims.run(draft, progress=tell, everything=everything, data=data)
        if draft is not None:
            names = _names(draft)
    record = claims.record(verdicts)
    if as_json:
        show_json(record, out, names)
    else:
        _paper_text.show(record)
        show_written(out, names)


def _names(folder: Path) -> tuple[str, ...]:
    return tuple(sorted(str(f.relative_to(folder)) for f in folder.rglob("*") if f.is_file()))
