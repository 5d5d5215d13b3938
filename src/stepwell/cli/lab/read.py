"""`stepwell lab read`: what recordings hold, and what is odd about them."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import Force, Json, Out, free
from stepwell.cli.screen import finish, progress

_Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE...",
        help="Recordings or folders of them: Bluehill raw data as text, or CSV with named columns.",
    ),
]


def read(files: _Files, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """Read recordings and say what they hold.

    A file that is broken, empty, binary or in an unknown unit gets one line, and stops no other.
    With --out, all samples are written into a folder as one tidy table with units.
    """
    from stepwell import lab
    from stepwell.base import __version__, versions
    from stepwell.cli.text import lab as texts
    from stepwell.reports import write_readings

    free(out, "lab read", force)
    with progress("reading") as tell:
        batch = lab.read_all(files, progress=tell)
    record = {
        "schema": "stepwell.lab.read/1",
        "stepwell": __version__,
        "versions": versions(),
        "data_sha256": lab.hashes(batch.recordings),
        "recordings": lab.summary(batch.recordings),
        "refused": [{"source": e.name, "problem": e.problem} for e in batch.refused],
        "ignored": list(batch.ignored),
    }
    write = partial(write_readings, batch.recordings, record) if batch.recordings else None
    finish(record, texts.readings, as_json, out, force, write)
    if not batch.recordings:
        raise typer.Exit(2)
