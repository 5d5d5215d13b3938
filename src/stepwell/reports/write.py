"""Write the folder of a result: record, page, figures and data, all of them or none."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import stepwell as sw
from stepwell import base, studio
from stepwell.accounts import About, Account, FigurePair, Image, account, page
from stepwell.files import dumps, staged_folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Boundary

Folder = str | os.PathLike[str]
Progress = Callable[[int, int], None]
Content = str | bytes | Callable[[Path], object]
Draw = Callable[..., "Figure"]

FIGURES = (".svg", ".png", ".pdf")
# Functions that export a graph for other programs, by suffix of the file.
EXPORTS = {".graphml": "to_graphml", ".dot": "to_dot", ".json": "to_json"}
# Width of figures for a phone [mm].
PHONE = 85.0


@dataclass(frozen=True)
class Contents:
    """Contents of a folder other than report.html: texts, and writing or drawing functions."""

    command: str
    record: str  # The name of the record's file.
    files: Mapping[str, Content] = field(default_factory=dict)
    draws: Mapping[str, Draw] = field(default_factory=dict)  # On the page, and .png and .svg.
    on_page: Mapping[str, Draw] = field(default_factory=dict)
    motion: Callable[[], str] | None = None  # Raises StepwellError without an animation.
    names: Iterable[str] | None = None  # Of possible files; those of OUTPUTS by default.
    film: Callable[[Path, Progress | None], None] | None = None  # Adds a video to a folder.


def write(
    result: Any,
    folder: Folder,
    about: About | None = None,
    *,
    progress: Progress | None = None,
    force: bool = False,
    **options: Any,
) -> tuple[str, ...]:
    """Write a result into a folder: report.html, its record, its figures and its data.

    Args:
        result: a result with an account, such as a `Check`; or the account.
        folder: created if missing; earlier files of the same command are replaced. Figures are .png
            and .svg.
        about: the design file and the recordings of the result; by default the design is written
            to a new file.
        progress: called with (done, total) files.
        force: overwrite all other existing files too.
        options: options of the type of result, such as `video` for a walk.

    Returns:
        The names of the files.

    Raises:
        ValueError: a type of result without a folder.
        OverwriteError: an existing file is not from this function; nothing has changed.
        OSError: the folder cannot be written; nothing has changed.
    """
    from stepwell.reports.contents import CONTENTS

    report = result if isinstance(result, Account) else account(result, about)
    contents_of = base.of_kind(CONTENTS, report.value)
    if contents_of is None:
        raise base.InputError(
            f"{type(report.value).__name__}: must be one of {', '.join(CONTENTS)}. Write the whole "
            "result that contains it, such as the `Run` of a `Cycle`; a graph with `write_graph`."
        )
    return _written(report, contents_of(report.value, report, **options), folder, progress, force)


def _written(
    account: Account, contents: Contents, folder: Folder, progress: Progress | None, force: bool
) -> tuple[str, ...]:
    # Without the extra figures, the page has no figures.
    draws = {**contents.draws, **contents.on_page} if base.have("figures") else {}
    drawn = {name: draw() for name, draw in draws.items()}
    pictures = {name: _drawn(figure, draws[name]) for name, figure in drawn.items()}
    files: dict[str, Content] = {
        **contents.files,
        contents.record: json.dumps(account.record, indent=2, allow_nan=False) + "\n",
        "report.html": page(account, pictures, _motion(account, contents)),
    }
    for name in contents.draws:
        files |= {f"{name}{end}": partial(sw.figures.save, drawn[name]) for end in (".png", ".svg")}
    names, record = contents.names, account.record
    with staged_folder(folder, contents.command, record, names=names, force=force) as draft:
        for done, (name, content) in enumerate(files.items(), 1):
            (draft / name).parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, str):
                base.write_atomic(draft / name, content)
            elif isinstance(content, bytes):
                (draft / name).write_bytes(content)
            else:
                content(draft / name)
            base.notify(progress, done, len(files))
        if contents.film is not None:
            contents.film(draft, progress)
        every = sorted(file for file in draft.rglob("*") if file.is_file())
        return tuple(file.relative_to(draft).as_posix() for file in every)


def _motion(account: Account, contents: Contents) -> str:
    if contents.motion is None:
        return ""
    try:
        return studio.as_iframe(contents.motion(), account.title)
    except base.StepwellError:
        return ""


def _drawn(figure: Figure, draw: Draw) -> FigurePair:
    """A figure on a page; a figure wider than a phone has a second version for phones."""
    if 25.4 * figure.get_size_inches()[0] <= PHONE + 1.0:
        return FigurePair(image_of(figure))
    return FigurePair(image_of(figure), image_of(sw.figures.compose([draw], width=PHONE)))


def image_of(drawn: Figure) -> Image:
    """A figure as a data URL."""
    # An image instead of inline markup, because two SVGs on one page would share their ids.
    data = base64.b64encode(sw.figures.svg(drawn).encode()).decode()
    width, height = (round(96 * inches) for inches in drawn.get_size_inches())
    return Image(f"data:image/svg+xml;base64,{data}", width, height)


def design_text(account: Account) -> str:
    """The text of the design file of a result."""
    design = account.about.design
    assert design is not None, "a folder is of a design"
    return design if isinstance(design, str) else dumps(design)


def boundary_rows(boundaries: Iterable[Boundary]) -> str:
    """The curves of a map as CSV with columns curve, kind and both parameters, a row per point."""
    head, rows = ["curve", "kind"], list[tuple[str, ...]]()
    for number, boundary in enumerate(boundaries):
        units = [base.display_unit(unit) for unit in boundary.units]
        named = zip(boundary.parameters, units, strict=True)
        keys = (base.Quantity(name, "" if unit == "1" else unit).key for name, (unit, _) in named)
        head, (across, up) = ["curve", "kind", *keys], (factor for _, factor in units)
        kind = boundary.kind.name.lower()
        rows += [
            (str(number), kind, f"{x * across:.9g}", f"{y * up:.9g}")
            for x, y in boundary.points.tolist()
        ]
    return base.csv_text(head, rows)


def checked_suffix(file: str | os.PathLike[str]) -> str:
    """Suffix of a file for a transition graph, checked.

    Raises:
        ValueError: an unknown suffix.
        ExtraError: the suffix of a figure, and Matplotlib is not installed.
    """
    suffix = Path(file).suffix.lower()
    if suffix not in (*FIGURES, *EXPORTS):
        raise base.InputError(
            f"{os.fspath(file)}: must end in {', '.join(FIGURES)} for a figure, or in "
            f"{', '.join(EXPORTS)} for other programs."
        )
    if suffix in FIGURES:
        base.need("figures")
    return suffix


def write_graph(graph: sw.TransitionGraph, file: str | os.PathLike[str]) -> None:
    """Write a transition graph to a file, completely or not at all.

    Args:
        graph: a transition graph; a figure has at most 64 states with all cells at a stop.
        file: .svg, .png or .pdf for a figure; .graphml, .dot or .json for other programs.

    Raises:
        ValueError: another suffix, or too many states for a figure.
        OSError: the folder is missing or cannot be written.
    """
    suffix = checked_suffix(file)
    if suffix in FIGURES:
        sw.figures.save(sw.figures.transition_graph(graph), file)
    else:
        base.write_atomic(file, getattr(sw.sequences, EXPORTS[suffix])(graph))
