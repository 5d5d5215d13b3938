"""`stepwell lab band`: how stiff bands are, and which law they follow."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.lab.given import recordings
from stepwell.cli.options import Force, Json, Out, free, window as read_window
from stepwell.cli.screen import finish

_Folders = Annotated[
    list[Path],
    typer.Argument(metavar="FOLDER...", help="Tension tests of bands."),
]
_Window = Annotated[
    str,
    typer.Option("--window-mm", metavar="FROM:TO", help="Stroke between which bands are fitted."),
]
_Cycles = Annotated[
    str, typer.Option(metavar="FROM:TO", help="Cycles that are fitted, from 1; both included.")
]
_Drop = Annotated[
    list[int] | None,
    typer.Option(metavar="SAMPLE", help="A sample to leave out; may be given again."),
]
_PerSample = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        help="How many files in a row are of one sample, where names only count.",
    ),
]
_Gauge = Annotated[
    float | None,
    typer.Option(
        "--gauge-mm", metavar="LENGTH", help="Length of the band at stroke 0, if you know it."
    ),
]
_Law = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="The law to write, whatever cross-validation chooses."),
]


def band(
    folders: _Folders,
    window: _Window = "5:35",
    cycles: _Cycles = "5:9",
    drop: _Drop = None,
    cycles_per_sample: _PerSample = None,
    gauge: _Gauge = None,
    law: _Law = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say how stiff bands are, and write a `band` table for a design file.

    Stiffness with its uncertainty, its dependence on the window, the work lost in a cycle, and the
    force law that predicts a sample best. The defaults for window and cycles are the paper's.
    With --out, the table, the numbers and a figure are written into a folder.
    """
    from stepwell import lab
    from stepwell.cli.text import lab as texts
    from stepwell.reports import write_band

    free(out, "lab band", force)
    low, high = read_window(window)
    given = recordings(folders)
    test = lab.band_test(
        given,
        window=(low * 1e-3, high * 1e-3),
        cycles=read_window(cycles, whole=True),
        drop=drop or (),
        cycles_per_sample=cycles_per_sample,
    )
    try:
        choice = lab.choose_law(test, None if gauge is None else gauge * 1e-3)
        source = ", ".join(folder.name for folder in folders)
        table = lab.band_table(test, lab.stiffness(test), choice, law, source)
    except lab.LabError:
        raise
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    record = lab.band_record(test, choice, table) | {"data_sha256": lab.hashes(given)}
    finish(record, texts.band, as_json, out, force, partial(write_band, test, choice, record))
