"""`stepwell figure`, `replay`, `studio` and `demo`: what others are shown."""

from __future__ import annotations

import webbrowser
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


# About the height of a page [mm], and the width of two columns.
_TALLEST, _USUAL = 247.0, "180mm"
_PAPER = "paper:"
_KINDS = ("pdf", "svg", "png")


class PageOptions(options.Group):
    """The page that a figure is for."""

    width: str | None = option(
        "Of the page, in mm, cm, in or pt, as 88mm; or a journal's, as nature-single; "
        "help lists them; 180mm by default.",
        "LENGTH",
    )
    height: str | None = option("Of the page; what the panels want by default.", "LENGTH")
    columns: int | None = option("Panels in a row, where no / says so.", "N", min=1, max=26)
    letters: str = option("How panels are lettered.", "A|a|(a)|none", default="A")

    def layout(self) -> dict[str, Any]:
        """The same as `reports.figure` takes it; lengths in mm."""
        with screen.usable("--width"):
            wide = sw.figures.length(self.width or _USUAL)
        with screen.usable("--height"):
            high = None if self.height is None else sw.figures.length(self.height)
        return {"width": wide, "height": high, "columns": self.columns, "letters": self.letters}


class SnapOptions(options.Group):
    """What the panel of a snap needs to know of the cells."""

    mass: float | None = option("Outside each cell [g], for the panel snap.", "--mass G")
    damping: float | None = option("Of each cell [N s/m], for the panel snap.", "N_S/M")


class FigureFile(options.Group):
    """The file of a figure."""

    out: Path | None = option(
        "The file to write.", "--out -o FILE", dir_okay=False, callback=options.local
    )
    kind: str | None = option(
        "Of the file, if its name does not say; pdf by default.", "--format pdf|svg|png"
    )
    force: options.ForceFile = False

    def place(self) -> Path:
        """The file to write, whose name and format agree."""
        out, kind = self.out, self.kind
        if kind is not None and kind not in _KINDS:
            raise screen.wrong("--format", f"{kind!r}: must be {', '.join(_KINDS)}.")
        if out is None:
            return Path(f"figure.{kind or _KINDS[0]}")
        suffix = out.suffix.lower().removeprefix(".")
        if suffix in _KINDS:
            if kind not in (None, suffix):
                raise screen.wrong("--format", f"{kind} is not what {out} is called.")
            return out
        if kind is None:
            raise screen.wrong(str(out), f"must end in .{', .'.join(_KINDS)}, or pass --format.")
        return out.with_name(f"{out.name}.{kind}")


def figure(
    design: options.Design,
    panels: str | None = option(
        "What to show, as mechanism,force,landscape; a / begins a new row; help lists "
        "all. By default what suits the design.",
        "NAMES",
    ),
    measured: list[Path] | None = option(
        "A recording to draw behind the force, as `stepwell lab read` reads it; may be "
        "given up to four times.",
        "FILE",
    ),
    *,
    page: PageOptions,
    snap: SnapOptions,
    file: FigureFile,
) -> None:
    """Plot a figure for a paper.

    Panels of a design, drawn at the size they have on paper, with letters. In PDF and SVG fonts are
    in the file and text stays text; PNG has 600 dpi. paper:fig1 to paper:fig4 in place of the
    design are the quantities of the paper's figures.

    Example: stepwell figure preset:paper-forward --width 88mm --out leg.pdf
    """
    if "help" in (panels, page.width):
        _list()
        return
    layout, out = page.layout(), file.place()
    options.free_file(out, file.force)
    if design.startswith(_PAPER):
        others = {"--panels": panels, "--width": page.width, "--measured": measured}
        for other in [name for name, value in others.items() if value]:
            raise screen.wrong(other, f"cannot stand with {design}.")
        with screen.usable("DESIGN"):
            drawn = sw.reports.figure_of(design.removeprefix(_PAPER))
    else:
        layout["measured"] = [sw.lab.read(one) for one in measured or ()]
        layout["mass"] = None if snap.mass is None else snap.mass * 1e-3
        drawn = _composed(design, panels, damping=snap.damping, **layout)
    sw.figures.save(drawn, out, dpi=sw.figures.PRINT_DPI, text=True)
    size = [25.4 * float(inches) for inches in drawn.get_size_inches()]
    screen.show_verbatim(f"Wrote {out}")
    screen.show_lines(f"{size[0]:.0f} mm wide, {size[1]:.0f} mm high.")
    if size[1] > _TALLEST:
        screen.warn(f"That is higher than a page, about {_TALLEST:g} mm: take fewer panels.")


def _composed(design: str, panels: str | None, **how: Any) -> Figure:
    file = sw.files.load(design)
    program = program_in_file(file) if file.program else None
    with screen.usable("--panels"):
        return sw.reports.figure(file.subject, _rows(panels), program=program, **how)


def _rows(panels: str | None) -> list[str | list[str]]:
    """Names of panels, in rows where a / stands between them."""
    rows = [list(filter(None, map(str.strip, row.split(",")))) for row in (panels or "").split("/")]
    rows = list(filter(None, rows))
    if panels is not None and not rows:
        raise screen.wrong("--panels", "names no panel; help lists them.")
    return [*rows] if len(rows) > 1 else [*rows[0]] if rows else []


def _list() -> None:
    rows = [
        (name, "robot" if one.of is sw.robot.Robot else "chain", one.shows)
        for name, one in sw.reports.PANELS.items()
    ]
    screen.show_table("Panels", ["panel", "of a", "what it shows"], rows, left=range(3))
    journals = sw.figures.JOURNAL_WIDTHS.items()
    widths = [(name, f"{one.width:g}", one.source) for name, one in journals]
    screen.show_lines("")
    screen.show_table("Widths of journals", ["name", "width [mm]", "source"], widths, left=(0, 2))


def replay(
    design: str = argument(
        "A design file (TOML) of a chain or a robot, or preset:NAME.",
        "DESIGN",
        autocompletion=options.designs,
    ),
    arena: options.Arena = None,
    cycles: float | None = option(
        "How often a robot's actuator goes out and back: 8 times by default, in an arena "
        "until the robot reaches the goal or gets nowhere, for 600 s at most.",
        min=0.01,
    ),
    out: Path = option(
        "The file to write.",
        "--out -o FILE.html",
        default=Path("replay.html"),
        callback=options.local,
    ),
    force: options.ForceFile = False,
) -> None:
    """Write a design in motion as one HTML page that plays anywhere.

    It works without a server and without a network, so it can be mailed: a slider, the mechanism,
    its curves with one cursor, and what the numbers rest on. A design with a program is shown as
    it is programmed, any other in its full cycle. A robot is simulated, and seen from above and
    from the side.

    Example: stepwell replay preset:paper-forward --out leg.html
    """
    if out.suffix.lower() not in (".html", ".htm"):
        raise screen.wrong(str(out), f"must end in .html, as in {out.stem}.html.")
    options.free_file(out, force)
    text, found = options.read_design(design)
    if isinstance(found, sw.Chain):
        for option, value in (("--arena", arena), ("--cycles", cycles)):
            if value is not None:
                raise screen.wrong(option, "is for a robot: this is a chain.")
        file = sw.files.loads(text, design)
        result = program_in_file(file) if file.program else found
        with screen.progress("margin") as tell:
            content = sw.studio.replay(result, progress=tell)
    else:
        with screen.usable(design), screen.progress("walking") as tell:
            run = _run(found, arena, cycles, tell)
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
        "What the page shows first: a design file (TOML), or preset:NAME; the gallery by default.",
        "[DESIGN]",
        default=None,
        autocompletion=options.designs,
    ),
    port: int | None = option(
        "The port on this machine, 0 for any; by default 7473, where the browser finds "
        "the last design again, or any free one.",
        min=0,
        max=65535,
        show_default=False,
    ),
    studies: Path | None = option(
        "Where the page finds and keeps studies; by default a folder of your own data.",
        "FOLDER",
        file_okay=False,
        show_default=False,
        callback=options.local,
    ),
    demo: bool = flag("Begin with a guided tour of two minutes.", "--demo"),
    no_open: bool = flag("Print the page's address and open no browser.", "--no-open"),
) -> None:
    """Open a page on which a design is dragged and everything follows.

    Mechanism, force, sequence and margins, all from the same engine as the other commands. Only
    this machine can reach it, with the address that is printed. Ctrl-C ends it.

    Example: stepwell studio preset:paper-forward
    """
    tables = None
    if design is not None:
        text = sw.files.text_of(design)
        sw.files.loads(text, design)  # which refuses what cannot be
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
        "Write the page and the designs into this folder.",
        "--out -o DIR",
        default=Path("stepwell-demo"),
        file_okay=False,
        callback=options.local,
    ),
    no_open: bool = flag("Name the page and open no browser.", "--no-open"),
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
        packages = "packages that pip install 'stepwell[all]' brings"
        screen.show_text(f"Left out, for want of {packages}: {titles}.")
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
    screen.show_text("All of it, moving, on one page:")
    screen.show_verbatim(str(page))
    if not no_open and screen.has_display() and screen.at_terminal():
        webbrowser.open(page.resolve().as_uri())
