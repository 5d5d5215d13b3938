"""`stepwell figure`, `replay`, `studio` and `demo`: figures and pages."""

from __future__ import annotations

import webbrowser
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import stepwell as sw
from stepwell.cli import options, screen
from stepwell.cli.driving import program_in_file
from stepwell.cli.options import argument, flag, option

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    import stepwell.robot as values
    from stepwell.simulation import Maze, Walk


_USUAL = "180mm"  # two columns
_PAPER = "paper:"
_KINDS = ("pdf", "svg", "png")


class PageOptions(options.Group):
    """Size and layout of a figure."""

    width: str | None = option(
        "Width of the figure, such as 88mm, 3.5in or nature-single (a journal); `help` lists the "
        "journals. 180mm by default.",
        "LENGTH",
    )
    height: str | None = option("Height of the figure; by default set by the panels.", "LENGTH")
    columns: int | None = option(
        "Number of panels in a row, if the panels contain no /.", "N", min=1, max=26
    )
    letters: str = option("Style of the panel letters.", "A|a|(a)|none", default="A")

    def layout(self) -> dict[str, Any]:
        """Keyword arguments of `reports.figure`; lengths in mm."""
        with screen.usable("--width"):
            wide = _page_length(self.width or _USUAL)
        with screen.usable("--height"):
            high = None if self.height is None else _page_length(self.height)
        return {"width": wide, "height": high, "columns": self.columns, "letters": self.letters}


def _page_length(text: str) -> float:
    """A length of a page [mm]; a number alone is in mm, as in all options."""
    with suppress(ValueError):
        text = f"{float(text):.12g}mm"
    return sw.figures.length(text)


class SnapOptions(options.Group):
    """Parameters of the panel snap."""

    mass: float | None = option("Mass of each cell [g], for the panel snap.", "--mass G")
    damping: float | None = option("Damping of each cell [N s/m], for the panel snap.", "N_S/M")


class PanelOptions(options.Group):
    """The contents of a figure."""

    panels: str | None = option(
        "Panels, such as mechanism,force,landscape; / starts a new row; `help` lists all panels. "
        "By default panels suited to the design.",
        "NAMES",
    )
    partial: bool = options.flag("Skip missing designs instead of failing.", "--partial")


class FigureFile(options.Group):
    """The file of a figure."""

    out: Path | None = option(
        "Write this file (.pdf, .svg or .png).",
        "--out -o FILE",
        dir_okay=False,
        callback=options.local,
    )
    kind: str | None = option(
        "File format, if the file name has no ending; pdf by default.", "--format pdf|svg|png"
    )
    force: options.Force = False

    def place(self) -> Path:
        """The path of the file, with the ending of its format."""
        out, kind = self.out, self.kind
        if kind is not None and kind not in _KINDS:
            raise screen.wrong("--format", f"{kind!r}: must be {', '.join(_KINDS)}.")
        if out is None:
            return Path(f"figure.{kind or _KINDS[0]}")
        suffix = out.suffix.lower().removeprefix(".")
        if suffix in _KINDS:
            if kind not in (None, suffix):
                raise screen.wrong(
                    "--format", f"{kind} contradicts the ending of {out}: omit one of them."
                )
            return out
        if kind is None:
            raise screen.wrong(str(out), f"must end in .{', .'.join(_KINDS)}, or pass --format.")
        return out.with_name(f"{out.name}.{kind}")


def figure(
    design: options.Design,
    shown: PanelOptions,
    measured: list[Path] | None = option(
        "Recording to plot behind the force, in a format of `stepwell lab read`. May be repeated "
        "up to four times.",
        "FILE",
    ),
    *,
    page: PageOptions,
    snap: SnapOptions,
    file: FigureFile,
) -> None:
    """Plot a figure of a design for a publication.

    Panels have their final size and letters. PDF and SVG contain their fonts and editable text; PNG
    has 600 dpi. In place of a design, paper:fig1 to paper:fig4 plot the quantities of the paper's
    figures, and the folder of a study plots its results: all, or those in --panels.

    Example: stepwell figure preset:paper-forward --width 88mm --out leg.pdf
    """
    panels = shown.panels
    if "help" in (panels, page.width):
        _list()
        return
    layout, out = page.layout(), file.place()
    options.free_file(out, file.force)
    if design.startswith(_PAPER):
        others = {"--panels": panels, "--width": page.width, "--measured": measured}
        for other in [name for name, value in others.items() if value]:
            raise screen.wrong(other, f"cannot be combined with {design}.")
        with screen.usable("DESIGN"), screen.progress("figure"):
            drawn = sw.reports.figure_of(design.removeprefix(_PAPER))
    elif Path(design).is_dir():
        drawn = _of_study(design, shown, layout)
    else:
        layout["measured"] = [sw.lab.read(one) for one in measured or ()]
        layout["mass"] = None if snap.mass is None else snap.mass * 1e-3
        drawn = _composed(design, panels, damping=snap.damping, **layout)
    with screen.progress(screen.WRITING):
        sw.figures.save(drawn, out, dpi=sw.figures.PRINT_DPI)
    size = [25.4 * float(inches) for inches in drawn.get_size_inches()]
    screen.show_verbatim(f"Wrote {out}")
    screen.show_lines(f"{size[0]:.0f} mm wide, {size[1]:.0f} mm high.")
    if size[1] > sw.reports.TALLEST:
        screen.warn(
            f"The figure is higher than a page ({sw.reports.TALLEST:g} mm): use fewer panels."
        )


def _of_study(folder: str, shown: PanelOptions, layout: Mapping[str, Any]) -> Figure:
    study = sw.studies.opened(folder)
    if not shown.partial:
        study.require_whole()
    columns = [name.strip() for name in (shown.panels or "").split(",") if name.strip()]
    with screen.usable("--panels"), screen.progress("figure"):
        drawn = partial(sw.figures.outcomes, study, columns=columns)
        return sw.figures.compose([drawn], **layout)


def _composed(design: str, panels: str | None, **how: Any) -> Figure:
    file = sw.files.load(design)
    program = program_in_file(file) if file.program else None
    with screen.usable("--panels"), screen.progress("figure"):
        return sw.reports.figure(file.subject, _rows(panels), program=program, **how)


def _rows(panels: str | None) -> list[str | list[str]]:
    """Names of panels, in rows if the text contains a /."""
    rows = [list(filter(None, map(str.strip, row.split(",")))) for row in (panels or "").split("/")]
    rows = list(filter(None, rows))
    if panels is not None and not rows:
        raise screen.wrong(
            "--panels", "contains no panel: give names of panels, which `--panels help` lists."
        )
    return [*rows] if len(rows) > 1 else [*rows[0]] if rows else []


def _list() -> None:
    rows = [
        (name, "robot" if one.of is sw.robot.Robot else "chain", one.shows)
        for name, one in sw.reports.PANELS.items()
    ]
    screen.show_table("Panels", ["panel", "for a", "content"], rows, left=range(3))
    journals = sw.figures.JOURNAL_WIDTHS.items()
    widths = [(name, f"{one.width:g}", one.source) for name, one in journals]
    screen.show_lines("")
    screen.show_table("Widths of journals", ["name", "width [mm]", "source"], widths, left=(0, 2))


def replay(
    design: str = argument(
        options.DESIGN_HELP, "DESIGN", autocompletion=options.designs, callback=options.by_name
    ),
    arena: options.Arena = None,
    cycles: float | None = option(
        "Number of drive cycles (robots only); 8 by default. In an arena until the robot reaches "
        "the goal or is stuck, at most 600 s.",
        "N",
        min=0.01,
    ),
    out: Path = option(
        "Write this file (.html).",
        "--out -o FILE",
        default=Path("replay.html"),
        callback=options.local,
    ),
    force: options.Force = False,
) -> None:
    """Write an animation of a design as one self-contained HTML page.

    The page works without a server or a network and can be sent by mail. It contains a slider, the
    mechanism, its curves with a common cursor, and the assumptions. It shows the program of a
    design, or else its full cycle. A robot is simulated and shown in top view and side view.

    Example: stepwell replay preset:paper-forward --out leg.html
    """
    if out.suffix.lower() not in (".html", ".htm"):
        raise screen.wrong(str(out), f"must end in .html, as in {out.stem}.html.")
    options.free_file(out, force)
    text, subject = options.read_design(design)
    if isinstance(subject, sw.Chain):
        for option, value in (("--arena", arena), ("--cycles", cycles)):
            if value is not None:
                raise screen.wrong(option, "is for a robot: this is a chain.")
        file = sw.files.loads(text, design)
        result = program_in_file(file) if file.program else subject
        with screen.progress("margin") as tell:
            content = sw.studio.replay(result, progress=tell)
    else:
        with screen.usable(design), screen.progress("walking") as tell:
            run = _run(subject, arena, cycles, tell)
        with screen.usable(design), screen.progress("page"):
            content = sw.studio.replay(run)
    sw.files.write_atomic(out, content)
    screen.show_lines(f"Wrote {out}")


def _run(
    robot: values.Robot, arena: str | None, cycles: float | None, tell: screen.Shows | None
) -> Walk | Maze:
    place = None if arena is None else sw.files.load_arena(arena)
    if place is None or cycles is not None:
        return sw.simulation.walk(robot, cycles or 8.0, arena=place, progress=tell)
    return sw.simulation.maze(robot, place, progress=tell)


def studio(
    design: str | None = argument(
        f"{options.DESIGN_HELP} Without it, the page shows the gallery.",
        "[DESIGN]",
        default=None,
        autocompletion=options.designs,
        callback=options.by_name,
    ),
    port: int | None = option(
        "Port on this machine, 0 for any; 7473 by default, where the browser restores the last "
        "design, or any free port.",
        "N",
        min=0,
        max=65535,
        show_default=False,
    ),
    studies: Path | None = option(
        "Folder of the studies that the page lists and writes; by default a folder of the user.",
        "DIR",
        file_okay=False,
        show_default=False,
        callback=options.local,
    ),
    demo: bool = flag("Begin with a guided tour of two minutes.", "--demo"),
    no_open: bool = flag(options.NO_OPEN, "--no-open"),
) -> None:
    """Open an interactive page to edit a design in the browser.

    Mechanism, forces, sequence and margins follow while an anchor is dragged; all commands use the
    same engine. The page is accessible from this machine only, at the address that is printed.
    Ctrl-C ends it.

    Example: stepwell studio preset:paper-forward
    """
    tables = None
    if design is not None:
        text = sw.files.text_of(design)
        sw.files.loads(text, design)  # an error for an invalid design
        tables = sw.files.tables_in(text, design)

    def opened(address: str) -> None:
        address += "&demo=1" if demo else ""
        screen.show_verbatim(address)
        if not no_open:
            webbrowser.open(address)

    try:
        sw.studio.serve(tables, port=port, studies=studies, opened=opened)
    except KeyboardInterrupt:
        raise screen.Interrupted("The studio has ended; an open page keeps its design.") from None


def demo(
    out: Path = option(
        "Write the results into this folder.",
        "--out -o DIR",
        default=Path("stepwell-demo"),
        file_okay=False,
        callback=options.folder,
    ),
    no_open: bool = flag(options.NO_OPEN, "--no-open"),
    force: options.Force = False,
) -> None:
    """Run a seven-step demonstration, and write it as one HTML page.

    It cycles a two-cell chain, moves an anchor, designs for a target sequence, plans a program, and
    simulates a walking robot and one with antennas. Designs and page are written into a folder;
    the page opens in a browser if a display is available. Robots need the extra `robot`.

    Example: stepwell demo --no-open
    """
    options.check_output_folder(out, "demo", force)
    left_out = [planned for planned in sw.reports.STEPS if not planned.available]
    screen.show_text(sw.reports.OPENING)
    if left_out:
        titles = "; ".join(planned.title for planned in left_out)
        packages = f"packages that {sw.base.install('all')}{sw.base.IN_CLONE} brings"
        screen.show_text(f"Skipped, because they need {packages}: {titles}.")
    shown: list[tuple[sw.reports.PlannedStep, sw.reports.StoryStep]] = []
    for planned in [one for one in sw.reports.STEPS if one.available]:
        screen.show_title(f"{len(shown) + 1}  {planned.title}")
        with screen.progress(planned.title) as tell:
            step = planned.make(tell)
        orders = (f"  {one.caption}  {one.sequence}" for one in step.shown if one.sequence)
        screen.show_lines(*step.sentences, *orders)
        shown.append((planned, step))
    with screen.progress(screen.WRITING) as tell:
        sw.reports.write_story(shown, out, left_out=left_out, progress=tell, force=force)
    page = out / "index.html"
    screen.show_text("All steps, animated, on one page:")
    screen.show_verbatim(str(page))
    if not no_open and screen.has_display() and screen.at_terminal():
        webbrowser.open(page.resolve().as_uri())
