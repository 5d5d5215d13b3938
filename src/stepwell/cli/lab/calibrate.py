"""`stepwell lab calibrate`: one model of rubber and rig for all unit cells."""

from functools import partial
from typing import Annotated

import typer

from stepwell.cli.lab.given import Baseline, Data, NoBaseline, recordings, subtracted
from stepwell.cli.options import Force, Json, Out, free
from stepwell.cli.screen import finish, progress

_Law = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="linear or cubic; by default the one that predicts better."),
]


def calibrate(
    data: Data,
    law: _Law = None,
    baseline: Baseline = None,
    no_baseline: NoBaseline = False,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit one physical model to all unit cells at once.

    Stiffness, rest length, loss on the way back and friction, with the error of each geometry
    predicted from the others, and the band as a table for a design file.
    With --out, the table, the numbers and a figure are written into a folder.
    """
    from stepwell import lab
    from stepwell.base import __version__, versions
    from stepwell.cli.text import lab as texts
    from stepwell.reports import write_calibration

    free(out, "lab calibrate", force)
    given = recordings([data])
    found = lab.sort_series(given, baseline=subtracted(baseline, no_baseline))
    samples = lab.prepare(found.series)
    with progress("fits") as tell:
        calibration = lab.calibrate(samples, law, progress=tell)
    record = {
        "schema": "stepwell.lab.calibrate/1",
        "stepwell": __version__,
        "versions": versions(),
        "data_sha256": lab.hashes(given),
        **lab.fit_record(calibration),
        "told": [
            line
            for one in found.series
            for line in (f"{one.name}: {told}" for told in one.told)
            if len(one.chain) == 1
        ]
        + [f"{one.name}: left out, a pair" for one in found.series if len(one.chain) > 1]
        + list(found.told),
        "table": lab.calibrated_table(calibration, data.name),
    }
    write = partial(write_calibration, calibration, record)
    finish(record, texts.calibration, as_json, out, force, write)
