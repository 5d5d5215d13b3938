"""The page of the story, and the folder that holds it beside the design files."""

import os
import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files as resources
from string import Template

from stepwell.base import __version__, notify, write_atomic
from stepwell.files import staged_folder
from stepwell.reports.story.steps import OPENING, Progress, StoryPiece, StoryStep, Telling

AxisQuantity = Sequence[tuple[Telling, StoryStep]]


def write_story(
    told: AxisQuantity,
    folder: str | os.PathLike[str],
    *,
    left_out: Sequence[Telling] = (),
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a story into a folder: index.html with all that moves, and the design files.

    Args:
        told: the steps that were made, in their order.
        folder: made if missing; what an earlier story wrote there is replaced.
        left_out: steps for which something is not installed.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files.

    Raises:
        OverwriteError: a file there is not one that a story wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    contents = {"index.html": _page(told, left_out)}
    for _, step in told:
        contents |= step.files
    with staged_folder(folder, "demo", force=force) as draft:
        for done, (name, text) in enumerate(contents.items(), 1):
            write_atomic(draft / name, text)
            notify(progress, done, len(contents))
    return tuple(sorted(contents))


def _page(told: AxisQuantity, left_out: Sequence[Telling]) -> str:
    page = Template((resources("stepwell.reports.story") / "story.html").read_text("utf-8"))
    numbered = enumerate(told, 1)
    return page.substitute(
        version=escape(__version__),
        opening=escape(OPENING),
        steps="\n".join(_step(number, telling, step) for number, (telling, step) in numbered),
        left_out=_left_out(left_out),
        files=" ".join(
            f"<code>{escape(name)}</code>" for _, step in told for name in sorted(step.files)
        ),
    )


def _step(number: int, telling: Telling, step: StoryStep) -> str:
    told = "\n".join(f"<p>{escape(line)}</p>" for line in step.told)
    shown = "\n".join(map(_figure, step.shown))
    changed = _changed(step.changed) if step.changed else ""
    commands = "\n".join(map(_command, step.commands))
    return (
        f'<section id="step-{number}"><h2><span class="number">{number}</span> '
        f"{escape(telling.title)}</h2>\n{told}\n"
        f'<div class="shown{" pair" * (len(step.shown) > 1)}">\n{shown}\n</div>\n'
        f'<div class="own">{changed}<div><h3>Do it yourself</h3>'
        f'<pre class="commands">{commands}</pre></div></div>\n</section>'
    )


def _command(line: str) -> str:
    """A line to be typed; on a narrow page it is folded at spaces alone."""
    words = re.sub(r"(?<= )-\S+", r"<span>\g<0></span>", escape(line))
    return f"<code>{words}</code>"


def _figure(shown: StoryPiece) -> str:
    states = shown.sequence.replace(">", "\N{ZERO WIDTH SPACE}→")
    order = f' <code class="order">{escape(states)}</code>' if states else ""
    kind = "" if shown.moves else ' class="still"'
    caption = f"<figcaption>{escape(shown.caption)}{order}</figcaption>"
    return f"<figure{kind}>{caption}{shown.html}</figure>"


def _changed(lines: Sequence[str]) -> str:
    """Lines of a design file; what goes and what comes are told apart by a sign and a colour."""
    tags = {"-": "del", "+": "ins"}
    marked = (
        f"<{tag}>{escape(line)}</{tag}>" if (tag := tags.get(line[:1])) else escape(line)
        for line in lines
    )
    return (
        "<div><h3>In the design file</h3>"
        f'<pre class="changed"><code>{chr(10).join(marked)}</code></pre></div>'
    )


def _left_out(tellings: Sequence[Telling]) -> str:
    if not tellings:
        return ""
    titles = "".join(f"<li>{escape(telling.title)}</li>" for telling in tellings)
    return (
        '<section id="left-out"><h2>What is missing here</h2><p>These steps need packages that are '
        f"not installed. <code>pip install 'stepwell[all]'</code> brings them.</p><ul>{titles}</ul>"
        "</section>"
    )
