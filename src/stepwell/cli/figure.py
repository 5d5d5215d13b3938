"""`stepwell figure`: panels for a paper, at the width of its columns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import Design, ForceFile, free_file, local, own
from stepwell.cli.screen import show_lines, show_table, show_verbatim, usable, warn

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.lab import Recording

# A page has about this height [mm].
_TALLEST = 247.0
# Two columns of a page.
_USUAL = "180mm"
_PAPER = "paper:"
_KINDS = ("pdf", "svg", "png")


def figure(
    design: Design,
    panels: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="What to show, as mechanism,force,landscape; a / begins a new row; help lists "
            "all. By default what suits the design.",
        ),
    ] = None,
    width: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Of the page, in mm, cm, in or pt, as 88mm; or a journal's, as nature-single; "
            "help lists them; 180mm by default.",
        ),
    ] = None,
    height: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Of the page; what the panels want by default."),
    ] = None,
    columns: Annotated[
        int | None,
        typer.Option(metavar="N", help="Panels in a row, where no / says so.", min=1, max=26),
    ] = None,
    letters: Annotated[
        str, typer.Option(metavar="A|a|(a)|none", help="How panels are lettered.")
    ] = "A",
    measured: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="A recording to draw behind the force, as `stepwell lab read` reads it; may be "
            "given up to four times.",
        ),
    ] = None,
    mass: Annotated[
        float | None,
        typer.Option("--mass", metavar="G", help="Outside each cell [g], for the panel snap."),
    ] = None,
    damping: Annotated[
        float | None,
        typer.Option(metavar="N_S/M", help="Of each cell [N s/m], for the panel snap."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="FILE", help="The file to write.", dir_okay=False, callback=local
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="pdf|svg|png",
            help="Of the file, if its name does not say; pdf by default.",
        ),
    ] = None,
    force: ForceFile = False,
) -> None:
    """Compose a figure for a paper.

    Panels of a design, drawn at the size they have on paper, with letters. In PDF and SVG fonts are
    in the file and text stays text; PNG has 600 dpi. paper:fig1 to paper:fig4 in place of the
    design are the quantities of the paper's figures.
    """
    from stepwell import figures

    if "help" in (panels, width):
        _list()
        return
    with usable("--width"):
        wide = figures.length(width or _USUAL)
    with usable("--height"):
        high = None if height is None else figures.length(height)
    file = _file(out, kind)
    free_file(file, force)
    if design.startswith(_PAPER):
        drawn = _of_the_paper(
            design, {"--panels": panels, "--width": width, "--measured": measured}
        )
    else:
        drawn = _composed(
            design,
            panels,
            measured=[_recording(one) for one in measured or ()],
            mass=None if mass is None else mass * 1e-3,
            damping=damping,
            width=wide,
            height=high,
            columns=columns,
            letters=letters,
        )
    figures.save(drawn, file, dpi=figures.PRINT_DPI, text=True)
    size = [25.4 * float(inches) for inches in drawn.get_size_inches()]
    show_verbatim(f"Wrote {file}")
    show_lines(f"{size[0]:.0f} mm wide, {size[1]:.0f} mm high.")
    if size[1] > _TALLEST:
        warn(f"That is higher than a page, about {_TALLEST:g} mm: take fewer panels.")


def _of_the_paper(name: str, others: Mapping[str, object]) -> Figure:
    """A figure of the paper, which has its own panels."""
    from stepwell.reports import figure_of

    for option, value in others.items():
        if value:
            raise typer.BadParameter(f"cannot stand with {name}.", param_hint=option)
    with usable("DESIGN"):
        return figure_of(name.removeprefix(_PAPER))


def _composed(design: str, panels: str | None, **how: Any) -> Figure:
    """A figure of a design."""
    from stepwell import files, reports
    from stepwell.robot import Robot

    text = files.text_of(design)
    read = files.loads(text, design).subject
    written = files.loads(text, design).program if not isinstance(read, Robot) else None
    program = None if written is None else own(text, design)
    with usable("--panels"):
        return reports.figure(read, _rows(panels), program=program, **how)


def _rows(panels: str | None) -> list[str | list[str]]:
    """Names of panels, in rows where a / stands between them."""
    rows = [
        [name.strip() for name in row.split(",") if name.strip()]
        for row in (panels or "").split("/")
    ]
    rows = [row for row in rows if row]
    if panels is not None and not rows:
        raise typer.BadParameter("names no panel; help lists them.", param_hint="--panels")
    return [*rows] if len(rows) > 1 else [*rows[0]] if rows else []


def _recording(file: Path) -> Recording:
    from stepwell.lab import read

    return read(file)


def _file(out: Path | None, kind: str | None) -> Path:
    """The file to write, whose name and format agree."""
    if kind is not None and kind not in _KINDS:
        known = ", ".join(_KINDS)
        raise typer.BadParameter(f"{kind!r}: must be {known}.", param_hint="--format")
    if out is None:
        return Path(f"figure.{kind or _KINDS[0]}")
    suffix = out.suffix.lower().removeprefix(".")
    if suffix in _KINDS:
        if kind not in (None, suffix):
            message = f"{kind} is not what {out} is called."
            raise typer.BadParameter(message, param_hint="--format")
        return out
    if kind is None:
        message = f"must end in .{', .'.join(_KINDS)}, or pass --format."
        raise typer.BadParameter(message, param_hint=str(out))
    return out.with_name(f"{out.name}.{kind}")


def _list() -> None:
    """All panels, and the widths of journals."""
    from stepwell import figures, reports
    from stepwell.robot import Robot

    rows = [
        (name, "robot" if one.of is Robot else "chain", one.shows)
        for name, one in reports.PANELS.items()
    ]
    show_table("Panels", ["panel", "of a", "what it shows"], rows, left=range(3))
    widths = [(name, f"{one.width:g}", one.source) for name, one in figures.JOURNAL_WIDTHS.items()]
    show_lines("")
    show_table("Widths of journals", ["name", "width [mm]", "source"], widths, left=(0, 2))
