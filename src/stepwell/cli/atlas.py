"""`stepwell atlas`: transition graphs in a space of designs, their fractions and their yields."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

import stepwell as sw
from stepwell.accounts import account
from stepwell.cli import options as opts, tolerances as parts
from stepwell.cli.options import Display, Group, Output, designs
from stepwell.cli.screen import progress, show_lines, subcommands, usable, warn, wrong
from stepwell.cli.sweep import Effort, going_on, read_axes

commands = subcommands("Compute and search the transition graphs of a space of designs.")

_Store = Annotated[
    Path | None,
    typer.Argument(
        metavar="STORE",
        help="Path of a store of `stepwell atlas build`; by default the atlas of three cells in "
        "Stepwell.",
    ),
]
# The paper's map for every cell, and one band up to two.
_SPACE = {"q.x": (0.0, 0.020), "q.y": (-0.015, 0.015), "stiffness": (28.5, 57.0)}


class SpaceOptions(Group):
    """The space of designs, and its sampling."""

    design: str | None = opts.argument(
        "Design to vary; equal cells of the paper by default.",
        "DESIGN",
        default=None,
        autocompletion=designs,
        callback=opts.by_name,
    )
    cells: int = opts.option(
        "Number of the paper's cells, if no design is given.", "N", default=2, min=1, max=6
    )
    vary: list[str] | None = opts.option(
        "Parameter to vary, such as outer.q.x=0:20, in the units of `stepwell map`. May be "
        "repeated. By default anchors and stiffness of the paper's cells.",
        "--vary NAME=FROM:TO",
    )
    designs: float = opts.option(
        "Number of designs, such as 1e8.", "N", default=1e6, min=1, show_default="1e6"
    )
    seed: parts.Seed = 0

    def read(self) -> tuple[sw.Chain, tuple[sw.studies.Axis, ...]]:
        """The chain, and the axes along which it is varied."""
        if not math.isfinite(self.designs) or self.designs > 1e12:
            raise wrong("--designs", f"{self.designs}: must be at most 1e12.")
        if self.design is None:
            band = sw.Band(p=(-0.010, 0.0), q=(0.010, 0.0), stiffness=28.5, rest_length=0.010)
            subject = sw.Chain([sw.Cell(band)] * self.cells)
        else:
            _, subject = opts.read_design(self.design)
            if not isinstance(subject, sw.Chain):
                raise wrong("DESIGN", "is a robot: must be a chain.")
            if not self.vary:
                raise wrong("--vary", "is needed with a design.")
        if self.vary:
            with usable("--vary"):
                return subject, read_axes(self.vary, subject, drawn=True)
        return subject, tuple(
            sw.studies.Axis(f"{cell}.{part}", *ends)
            for cell in range(1, self.cells + 1)
            for part, ends in _SPACE.items()
        )


@opts.command(commands)
def build(
    *,
    out: Path = opts.option(
        "Write the results into this folder, a Zarr store.",
        "--out -o DIR",
        default=...,
        callback=opts.folder,
    ),
    space: SpaceOptions,
    drive: str = opts.option(
        "Drive: stroke (displacement control) or force (force control).", "DRIVE", default="stroke"
    ),
    effort: Effort,
    display: Display,
) -> None:
    """Compute the transition graphs of designs sampled uniformly from a space, in closed form.

    The space is that of --vary. By default it is, for every cell, the anchor q (x 0 to 20 mm, y -15
    to 15 mm, as in the paper's map) and the stiffness (28.5 to 57 N/m, one to two bands). Counts
    are written to a store in blocks; to resume after an interruption, run the same command again.

    Example: stepwell atlas build --out two --designs 1e5
    """
    if drive not in sw.studies.DRIVES:
        raise wrong("--drive", f"{drive!r}: must be stroke or force.")
    subject, axes = space.read()
    with usable("--vary"), going_on(out, effort.scheduler) as tell:
        how = {"drive": drive, "seed": space.seed, "progress": tell, **vars(effort)}
        study = sw.studies.atlas(subject, axes, int(space.designs), out, **how).study
    _show(study, _charted(study, parts.BandTolerances()), display)


@opts.command(commands)
def show(store: _Store = None, *, within: parts.BandTolerances, output: Output) -> None:
    """List the transition graphs of a store, with fractions, yields and proofs.

    Example: stepwell atlas show
    """
    output.check_output_folder("atlas show")
    study = _opened(store)
    _show(study, _charted(study, within), output)


@opts.command(commands)
def find(
    query: str = opts.argument(
        'Behaviour, such as "counts to two by hand and not remembers", or a sequence such as '
        "00>10>11>01>00.",
        "QUERY",
    ),
    store: _Store = None,
    least: str = opts.option("Minimum guaranteed yield [%].", "--yield PERCENT", default="0"),
    out: Path | None = opts.option(
        "Write this file (.toml): the first result as a design file.",
        "--out -o FILE",
        dir_okay=False,
        callback=opts.local,
    ),
    *,
    within: parts.BandTolerances,
    display: Display,
) -> None:
    """Search the transition graphs of a store by behaviour, highest yield first.

    Example: stepwell atlas find '00>10>11>01>00' --yield 90
    """
    if out is not None and out.suffix != ".toml":
        raise wrong("--out", f"{out}: must end in .toml.")
    yields = _percent(least)
    study = _opened(store)
    with usable("QUERY"):
        sw.studies.understood(query)
    chart = _charted(study, within, checks=0)
    graph_classes = sw.studies.find(chart, query, yields)
    if out is not None and graph_classes:
        sw.files.save(graph_classes[0].chain, out)
    display.report(account(chart, graph_classes=graph_classes, query=query))
    if out is not None and graph_classes and not display.as_json:
        show_lines("", f"Written into {out}: {graph_classes[0].name}.")


def _opened(store: Path | None) -> sw.studies.Study:
    study = sw.studies.opened(store or sw.studies.THREE)
    if gaps := study.gaps():
        warn(
            f"{study.folder}: {sw.studies.gaps_text(gaps, study.count)}. "
            "The results below are for the other designs."
        )
    return study


def _percent(text: str) -> float:
    try:
        fraction = float(text.strip().removesuffix("%")) / 100
    except ValueError:
        fraction = math.nan
    if not 0 <= fraction <= 1:
        raise wrong("--yield", f"{text!r}: must be from 0 to 100 %.")
    return fraction


def _charted(
    study: sw.studies.Study, within: parts.BandTolerances, checks: int = 100
) -> sw.studies.Atlas:
    with usable("STORE"), progress("graph classes") as tell:
        return sw.studies.charted(
            study, tolerances=within.tolerances(), checks=checks, progress=tell
        )


def _show(study: sw.studies.Study, chart: sw.studies.Atlas, display: Display) -> None:
    # The text has no neighbours: the studio shows them.
    near = sw.studies.class_boundaries(study, chart) if display.as_json else ()
    display.report(account(chart, class_boundaries=near))
