"""Panels of whole designs: gallery, thumbnails, files, texts, figures, replays."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path as Place
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import accounts, files, statics
from stepwell.base import InputError
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.sequences import Program
from stepwell.studio import gallery
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import LONGEST_MESSAGE
from stepwell.studio.panels.motion import program_of
from stepwell.studio.panels.robots import asked_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.sequences import Cycle
    from stepwell.simulation import Maze, Walk


def answer_gallery(_design: PageDesign, ask: Ask) -> View:
    """Names, titles, groups and motions, in the order of the page.

    A design has the header of its `motion`, whose arrays have its name and a slash before theirs.
    """
    ask.close()
    motions = gallery.motions()
    designs = [
        {**one, "motion": motions[one["name"]].header if one["name"] in motions else None}
        for one in gallery.listed()
    ]
    blocks = {
        f"{name}/{block}": values
        for name, motion in motions.items()
        for block, values in motion.blocks.items()
    }
    return View({"designs": designs}, blocks)


# Most designs that a browser keeps.
_MOST_KEPT = 10


def answer_thumbnails(_design: PageDesign, ask: Ask) -> View:
    """The motions of the page's own `designs`, and finally their number.

    A design that cannot be computed has no motion.
    """
    own = ask.parts("designs", _MOST_KEPT)
    ask.close()
    for one in own:
        name, tables = one.text("name", 100), one.table("design")
        one.close()
        with suppress(InputError, statics.StaticsError):
            ask.show(gallery.moving(name, tables))
    return View({"count": len(own)})


def answer_open(_design: PageDesign, ask: Ask) -> View:
    """The tables of the design and its title; file names in the text are never opened.

    Raises:
        InputError: the design is invalid or has more cells than the page shows.
    """
    given = [key for key in ("preset", "toml", "tables") if ask.has(key)]
    if len(given) != 1:
        names = "preset, a name of the gallery, toml, a file's text, or tables"
        raise InputError(f"ask: must have {names}.")
    if given == ["tables"]:
        tables = ask.table("tables")
    elif given == ["preset"]:
        tables = files.tables_in(files.preset_text(ask.text("preset", 200)), "preset")
    else:
        tables = files.tables_in(ask.text("toml", LONGEST_MESSAGE), "design")
    ask.close()
    gallery.opened(tables)
    return View({"design": tables, "title": tables.get("title", "")})


_LONGEST = 88


def script(design: Chain | Robot, toml: str) -> str:
    """Python code that creates exactly this design and prints its result.

    Robots, and chains with elements, are read from the text of their design file.
    """
    kind, does = ("robot", "predict") if isinstance(design, Robot) else ("chain", "cycle")
    if isinstance(design, Robot) or design.elements:
        made = f"from stepwell.files import loads\n\n{kind} = loads({_block(toml)}).{kind}"
    else:
        made = f"import stepwell as sw\n\nchain = {_made(design, 0)}"
        made = f"from math import inf\n\n{made}" if "=inf" in made else made
    return f"{made}\nprint({kind}.{does}())\n"


def _block(text: str) -> str:
    if "'''" in text or "\\" in text:
        return repr(text)
    return f"'''\n{text}'''"


def _made(value: Any, depth: int) -> str:
    if isinstance(value, tuple) and value and is_dataclass(value[0]):
        inner = [_made(one, depth + 1) for one in value]
        return _call("(", inner, ",)" if len(value) == 1 else ")", depth)
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    parts = [
        f"{field.name}={_made(getattr(value, field.name), depth + 1)}"
        for field in fields(value)
        if field.init
        and not field.name.startswith("_")
        and (field.default is MISSING or getattr(value, field.name) != field.default)
        and field.default_factory is MISSING
    ]
    return _call(f"sw.{type(value).__name__}(", parts, ")", depth)


def _call(start: str, parts: list[str], end: str, depth: int) -> str:
    line = f"{start}{', '.join(parts)}{end}"
    if len(line) + 4 * depth <= _LONGEST and "\n" not in line:
        return line
    pad = "    " * (depth + 1)
    end = end.lstrip(",")
    return f"{start}\n" + "".join(f"{pad}{part},\n" for part in parts) + "    " * depth + end


def answer_text(design: PageDesign, ask: Ask) -> View:
    """The design as TOML and as Python code."""
    ask.close()
    subject, program = design.read.subject, design.read.program
    toml = files.dumps(subject, program=program)
    return View({"toml": toml, "python": script(subject, toml)})


_DPI, _KINDS = 600, ("svg", "png", "pdf")


def answer_export(design: PageDesign, ask: Ask) -> View:
    """The bytes of a file: `what` is a figure, the samples or the result, `kind` its type.

    All show the full cycle: a figure as svg, png or pdf; the samples as csv, with all columns of
    `stepwell run --out`; the result as json, the record of `stepwell run --json`.
    """
    what, kind = ask.text("what", 20), ask.text("kind", 4)
    ask.close()
    cycle = design.chain.cycle()
    kinds = {"samples": ("csv",), "result": ("json",)}.get(what, _KINDS)
    if kind not in kinds:
        raise InputError(f"ask.kind = {kind!r}: must be {', '.join(kinds)}.")
    with TemporaryDirectory() as folder:
        file = Place(folder) / f"out.{kind}"
        if what == "samples":
            cycle.path.to_csv(file)
        elif what == "result":
            record = accounts.account(cycle).record
            file.write_text(json.dumps(record, indent=2, allow_nan=False) + "\n", "utf-8")
        else:
            from stepwell.figures import save

            save(_drawn(what, cycle), file, dpi=_DPI)
        data = np.frombuffer(file.read_bytes(), np.uint8)
    return View({"suffix": kind}, {"file": data})


def _drawn(what: str, cycle: Cycle) -> Figure:
    from stepwell import figures

    if what == "mechanism":
        return figures.mechanism(cycle.chain, cycle)
    of = {"overview": "overview", "force": "force_stroke", "travel": "travel_stroke"}
    if what in of:
        return getattr(figures, of[what])(cycle)
    raise InputError(
        f"ask.what = {what!r}: must be overview, mechanism, force, travel, samples or result."
    )


def answer_replay(design: PageDesign, ask: Ask) -> View:
    """The file of a replay: of a run if the request has `cycles` or `limit_s`, else of a chain.

    A run is as in panels `walk` and `maze`. A chain follows its `turning_points_mm`,
    else the program of the design, else its full cycle.
    """
    from stepwell.studio.standalone import replay

    title = ask.text("title", 10_000) if ask.has("title") else None
    page = replay(_result(design, ask), title=title, progress=ask.report)
    return View({"suffix": "html"}, {"file": np.frombuffer(page.encode(), np.uint8)})


def _result(design: PageDesign, ask: Ask) -> Chain | Program | Walk | Maze:
    in_maze = ask.has("limit_s")
    if in_maze or ask.has("cycles"):
        return asked_run(design, ask, in_maze=in_maze)()
    result, written = design.chain, design.program
    if ask.has("turning_points_mm"):
        result = program_of(result, ask)
    elif written is not None:
        result = written.on(result)
    ask.close()
    return result
