"""The HTML page of the demonstration, and its folder with the design files."""

import os
import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files as resources
from string import Template

from stepwell.base import IN_CLONE, __version__, install, notify, write_atomic
from stepwell.files import staged_folder
from stepwell.reports.story.steps import OPENING, PlannedStep, Progress, StoryPiece, StoryStep

Steps = Sequence[tuple[PlannedStep, StoryStep]]


def write_story(
    steps: Steps,
    folder: str | os.PathLike[str],
    *,
    left_out: Sequence[PlannedStep] = (),
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a demonstration into a folder: index.html with its animations, and the design files.

    Args:
        steps: the computed steps, in order.
        folder: created if missing; files of an earlier demonstration are replaced.
        left_out: steps with missing packages.
        progress: called with (done, total) files.
        force: overwrite all other existing files too.

    Returns:
        The names of the files.

    Raises:
        OverwriteError: an existing file is not from a demonstration; nothing has changed.
        OSError: the folder cannot be written.
    """
    contents = {"index.html": _page(steps, left_out)}
    for _, step in steps:
        contents |= step.files
    with staged_folder(folder, "demo", force=force) as draft:
        for done, (name, text) in enumerate(contents.items(), 1):
            write_atomic(draft / name, text)
            notify(progress, done, len(contents))
    return tuple(sorted(contents))


def _page(steps: Steps, left_out: Sequence[PlannedStep]) -> str:
    page = Template((resources("stepwell.reports.story") / "story.html").read_text("utf-8"))
    numbered = enumerate(steps, 1)
    return page.substitute(
        version=escape(__version__),
        opening=escape(OPENING),
        steps="\n".join(_step(number, planned, step) for number, (planned, step) in numbered),
        left_out=_left_out(left_out),
        files=" ".join(
            f"<code>{escape(name)}</code>" for _, step in steps for name in sorted(step.files)
        ),
    )


def _step(number: int, planned: PlannedStep, step: StoryStep) -> str:
    text = "\n".join(f"<p>{escape(line)}</p>" for line in step.sentences)
    shown = "\n".join(map(_figure, step.shown))
    changed = _changed(step.changed) if step.changed else ""
    commands = "\n".join(map(_command, step.commands))
    return (
        f'<section id="step-{number}"><h2><span class="number">{number}</span> '
        f"{escape(planned.title)}</h2>\n{text}\n"
        f'<div class="shown{" pair" * (len(step.shown) > 1)}">\n{shown}\n</div>\n'
        f'<div class="own">{changed}<div><h3>Commands</h3>'
        f'<pre class="commands">{commands}</pre></div></div>\n</section>'
    )


def _command(line: str) -> str:
    """A command line, wrapped only at spaces on a narrow page."""
    words = re.sub(r"(?<= )-\S+", r"<span>\g<0></span>", escape(line))
    return f"<code>{words}</code>"


def _figure(shown: StoryPiece) -> str:
    states = shown.sequence.replace(">", "\N{ZERO WIDTH SPACE}→")
    order = f' <code class="order">{escape(states)}</code>' if states else ""
    kind = "" if shown.moves else ' class="still"'
    caption = f"<figcaption>{escape(shown.caption)}{order}</figcaption>"
    return f"<figure{kind}>{caption}{shown.html}</figure>"


def _changed(lines: Sequence[str]) -> str:
    """Lines of a design file; removed and added lines have a sign and a colour."""
    tags = {"-": "del", "+": "ins"}
    marked = (
        f"<{tag}>{escape(line)}</{tag}>" if (tag := tags.get(line[:1])) else escape(line)
        for line in lines
    )
    return (
        "<div><h3>In the design file</h3>"
        f'<pre class="changed"><code>{chr(10).join(marked)}</code></pre></div>'
    )


def _left_out(planned_steps: Sequence[PlannedStep]) -> str:
    if not planned_steps:
        return ""
    titles = "".join(f"<li>{escape(planned.title)}</li>" for planned in planned_steps)
    return (
        '<section id="left-out"><h2>Skipped steps</h2><p>These steps need packages that are not '
        f"installed. Install them with <code>{install('all')}</code>{IN_CLONE}.</p><ul>{titles}"
        "</ul></section>"
    )
