"""`stepwell demo`: what springs can be told to do, in a minute."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import Force, free, local
from stepwell.cli.screen import (
    WRITING,
    at_terminal,
    has_display,
    progress,
    show_lines,
    show_text,
    show_title,
    show_verbatim,
)


def demo(
    out: Annotated[
        Path,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Write the page and the designs into this folder.",
            file_okay=False, callback=local),
    ] = Path("stepwell-demo"),
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Name the page and open no browser.")
    ] = False,
    force: Force = False,
) -> None:  # fmt: skip
    """Tell in seven steps what springs can be told to do.

    A leg is pulled, an anchor is moved, an order is wished for, a finger is put up, a robot walks
    and feels its way. What it makes goes into a folder, with one page on which all of it moves; the
    page opens in the browser where somebody sits at a screen. Robots need the extra `robot`.
    """
    from stepwell import reports

    free(out, "demo", force)
    left_out = [telling for telling in reports.STEPS if not telling.can_be_told]
    show_text(reports.OPENING)
    if left_out:
        titles = "; ".join(telling.title for telling in left_out)
        show_text(
            f"Left out, for want of packages that pip install 'stepwell[all]' brings: {titles}."
        )
    told: list[tuple[reports.Telling, reports.Step]] = []
    for telling in reports.STEPS:
        if telling in left_out:
            continue
        show_title(f"{len(told) + 1}  {telling.title}")
        with progress(telling.title) as tell:
            step = telling.make(tell)
        orders = (f"  {one.caption}  {one.sequence}" for one in step.shown if one.sequence)
        show_lines(*step.told, *orders)
        told.append((telling, step))
    with progress(WRITING) as tell:
        reports.write_story(told, out, left_out=left_out, progress=tell, force=force)
    page = out / "index.html"
    show_text("All of it, moving, on one page:")
    show_verbatim(str(page))
    if not no_open and has_display() and at_terminal():
        webbrowser.open(page.resolve().as_uri())
