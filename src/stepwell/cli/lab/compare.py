"""`stepwell lab compare`: measured against model, a verdict for every series."""

import math
from functools import partial
from typing import Annotated

import typer

from stepwell.cli.lab.given import Baseline, Data, NoBaseline, recordings, subtracted
from stepwell.cli.options import Force, Json, Out, free
from stepwell.cli.screen import finish

_Designs = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[DESIGN]...",
        help="What was tested, or what file names leave open; the paper's cell by default.",
    ),
]
_AsDesigned = Annotated[
    bool,
    typer.Option("--as-designed", help="Take the design as it is, whatever file names say."),
]
_Bar = Annotated[
    float,
    typer.Option("--bar-mm", metavar="LENGTH", min=20, help="Bar of the rig; inf for none."),
]


def compare(
    data: Data,
    designs: _Designs = None,
    baseline: Baseline = None,
    no_baseline: NoBaseline = False,
    as_designed: _AsDesigned = False,
    bar: _Bar = 70.0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Compare unit cells and pairs on a test machine with their models.

    Friction is subtracted and repeats are averaged. A unit cell gets its class, its forces and its
    energy judged, a pair the order of its cells and its snaps.
    With --out, verdicts, curves and figures are written into a folder.
    """
    from stepwell import files, lab, reports
    from stepwell.cli.text import lab as texts

    free(out, "lab compare", force)
    given = recordings([data])
    designed = {design: files.read(design) for design in designs or ()}
    comparison = lab.compare(
        given,
        [files.loads(text, design) for design, text in designed.items()],
        baseline=subtracted(baseline, no_baseline),
        as_designed=as_designed,
        rig=lab.Rig(math.inf if math.isinf(bar) else bar * 1e-3),
    )
    record = lab.comparison_record(comparison) | {
        "designs_sha256": {design: files.digest(text) for design, text in designed.items()},
        "data_sha256": lab.hashes(given),
    }
    write = partial(reports.write_comparison, comparison, record)
    finish(record, texts.comparison, as_json, out, force, write)
