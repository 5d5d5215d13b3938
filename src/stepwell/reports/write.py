"""A folder of a result: its record, its page, its figures and its data, all of them or nothing."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.accounts import About, Account, Drawn, Image, account, page
from stepwell.base import InputError, StepwellError, have, of_kind, write_atomic
from stepwell.files import dumps, staged_folder
from stepwell.studio.replay import embedded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Folder = str | os.PathLike[str]
Progress = Callable[[int, int], None]
Content = str | Callable[[Path], object]
Draw = Callable[..., "Figure"]

# The width of figures that fill a phone [mm].
PHONE = 85.0


@dataclass(frozen=True)
class Contents:
    """What a folder has besides report.html.

    Args:
        command: whose results these are.
        record: the name of the record's file.
        files: text by the name of its file, or a function that writes a file.
        draws: what draws each figure, by its name: on the page, and as .png and .svg in the folder.
        on_page: what draws each figure that is on the page alone.
        motion: makes the replay as a page; raises StepwellError where there is none.
        film: called with the draft folder and `progress`, to add a video to it.
    """

    command: str
    record: str
    files: Mapping[str, Content] = field(default_factory=dict)
    draws: Mapping[str, Draw] = field(default_factory=dict)
    on_page: Mapping[str, Draw] = field(default_factory=dict)
    motion: Callable[[], str] | None = None
    film: Callable[[Path, Progress | None], None] | None = None


# Which file knows the contents of a class.
_CONTENTS = {
    "AsBuilt": "measured",
    "Atlas": "studies",
    "BandFit": "measured",
    "Batch": "measured",
    "Calibration": "measured",
    "Check": "designs",
    "Comparison": "measured",
    "Design": "designs",
    "MapView": "chains",
    "Maze": "robots",
    "Prediction": "robots",
    "Program": "chains",
    "Reprogramming": "designs",
    "Run": "chains",
    "Status": "studies",
    "Survival": "designs",
    "Sweep": "robots",
    "Verdicts": "paper",
    "Walk": "robots",
    "Yield": "designs",
}


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
        result: a result of which there is an account, such as a `Check`; or the account.
        folder: made if missing; what the same command wrote there before is replaced. Figures are
            a .png and a .svg.
        about: the design file and the recordings that it was computed from; a file is written for
            the design by default.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.
        options: of the kind of result, such as `video` of a walk.

    Returns:
        The names of the files.

    Raises:
        ValueError: of such a value there is no folder.
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written; nothing has changed.
    """
    found = result if isinstance(result, Account) else account(result, about)
    file = of_kind(_CONTENTS, found.value)
    if file is None:
        raise InputError(f"{type(found.value).__name__}: must be one of {', '.join(_CONTENTS)}.")
    contents = import_module(f"stepwell.reports.{file}").contents(found, **options)
    return _written(found, contents, folder, progress, force)


def _written(
    found: Account, contents: Contents, folder: Folder, progress: Progress | None, force: bool
) -> tuple[str, ...]:
    # A page needs no figures: where they cannot be drawn, it stands without them.
    draws = {**contents.draws, **contents.on_page} if have("figures") else {}
    drawn = {name: draw() for name, draw in draws.items()}
    pictures = {name: _drawn(figure, draws[name]) for name, figure in drawn.items()}
    files: dict[str, Content] = {
        **contents.files,
        contents.record: json.dumps(found.record, indent=2, allow_nan=False) + "\n",
        "report.html": page(found, pictures, _motion(found, contents)),
    }
    for name in contents.draws:
        from stepwell import figures

        files |= {f"{name}{end}": partial(figures.save, drawn[name]) for end in (".png", ".svg")}
    with staged_folder(folder, contents.command, found.record, force=force) as draft:
        for done, (name, content) in enumerate(files.items(), 1):
            if isinstance(content, str):
                write_atomic(draft / name, content)
            else:
                content(draft / name)
            if progress is not None:
                progress(done, len(files))
        if contents.film is not None:
            contents.film(draft, progress)
        return tuple(sorted(file.name for file in draft.iterdir()))


def _motion(found: Account, contents: Contents) -> str:
    if contents.motion is None:
        return ""
    try:
        return embedded(contents.motion(), found.title)
    except StepwellError:
        return ""


def _drawn(figure: Figure, draw: Draw) -> Drawn:
    """A figure on a page; one that is wider than a phone is drawn for phones too."""
    if 25.4 * figure.get_size_inches()[0] <= PHONE + 1.0:
        return Drawn(image_of(figure))
    return Drawn(image_of(figure), image_of(narrow(draw)))


def narrow(draw: Draw) -> Figure:
    """A figure as it fills a phone."""
    from stepwell import figures

    return figures.compose([draw], width=PHONE)


def image_of(drawn: Figure) -> Image:
    """A figure as an address that holds all of it."""
    from stepwell.figures import svg

    # An image, not inline markup: two SVGs on one page would share their ids.
    data = base64.b64encode(svg(drawn).encode()).decode()
    width, height = (round(96 * inches) for inches in drawn.get_size_inches())
    return Image(f"data:image/svg+xml;base64,{data}", width, height)


def design_text(found: Account) -> str:
    """The text of the design file that a result was computed from."""
    design = found.about.design
    assert design is not None, "a folder is of a design"
    return design if isinstance(design, str) else dumps(design)
