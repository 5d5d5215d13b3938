"""An animation as one self-contained HTML file."""

from __future__ import annotations

import base64
import hashlib
import re
import zlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace as with_
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING

from stepwell.base import ExtraError, InputError
from stepwell.mechanism import Chain
from stepwell.sequences import Cycle, Program
from stepwell.studio.ask import View
from stepwell.studio.message import packed
from stepwell.studio.motion import motion_of

if TYPE_CHECKING:
    from stepwell.design import Margin
    from stepwell.simulation import Maze, Walk


# The name of a frame that plays automatically, and the size of a frame: taller if narrow.
_PLAYS = "plays"
_SIZE = "display:block;width:100%;height:clamp(30rem,47rem - 20vw,40rem);border:0"
# Character sequences that would end or change a script inside HTML.
_MARKS = re.compile(r"<(?=!--|/?script)", re.IGNORECASE)


def replay(
    result: Chain | Cycle | Program | Walk | Maze,
    *,
    title: str | None = None,
    margin: Margin | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> str:
    """An animation as one self-contained HTML page, without a server or a network.

    It has a slider and the assumptions; for a chain the mechanism, force, travel and
    energy; for a robot top view, side view, path and legs. Long runs are
    thinned, so that the page stays below a megabyte.

    Args:
        result: a chain or its full cycle, a program, or a robot's walk or run through an arena.
        title: by default that of the chain or robot.
        margin: that of the chain, if it is known already.
        progress: called with (done, total) while margins of a chain are searched.

    Raises:
        ValueError: another type, or a run that ended before its first sample.
        StaticsError: the simulation failed; see its message.
    """
    if isinstance(result, Chain | Cycle | Program):
        motion = motion_of(result, margin, progress)
    else:
        motion = _view_of_run(result)
    view = with_(motion, header={**motion.header, "title": title or motion.header["title"]})
    return motion_page(view.header["title"], view.header["version"], _packed_base64(view))


def motion_page(title: str, version: str, data: str) -> str:
    """The page of a motion whose `data` is a view, packed, compressed and in base 64."""
    script, style = _MARKS.sub(r"\\x3C", _built_file("replay.js")), _built_file("replay.css")
    page = Template((files("stepwell.studio") / "standalone.html").read_text("utf-8"))
    return page.substitute(
        title=escape(title or "A motion"),
        version=escape(version),
        script=script,
        style=style,
        script_hash=_policy_hash(script),
        style_hash=_policy_hash(style),
        data=data,
    )


def as_iframe(page: str, title: str, *, plays: bool = False) -> str:
    """A self-contained page as an isolated part of another page.

    In a frame a replay is compact: no title bar and no scrolling. A page around it
    with its own policy must allow inline scripts and styles, for frames inherit it.

    Args:
        page: HTML text, as of `replay`.
        title: a description for screen readers.
        plays: whether it plays automatically while visible; never with reduced motion.

    Returns:
        An `iframe` element with the width of its parent: its scripts run, but without access to
        the parent or the network.
    """
    # A frame can read its own name, and nothing else of its parent.
    name = f' name="{_PLAYS}"' if plays else ""
    return (
        f'<iframe class="replay" title="{_attribute_text(title)}" sandbox="allow-scripts"'
        ' loading="lazy"'
        f'{name} style="{_SIZE}" srcdoc="{_attribute_text(page)}"></iframe>'
    )


def _attribute_text(text: str) -> str:
    """Text as the value of an attribute, in ASCII."""
    return escape(text).encode("ascii", "xmlcharrefreplace").decode()


def _view_of_run(result: Walk | Maze) -> View:
    """The view of a run; an error for another type or without MuJoCo."""
    with suppress(ExtraError):
        from stepwell.simulation import Maze, Walk

        if isinstance(result, Walk | Maze):
            from stepwell.studio.scene import walked

            return walked(result)
    kind = type(result).__name__
    raise InputError(f"{kind}: a replay needs a Chain, a Program, or a robot's Walk or Maze.")


def _built_file(name: str) -> str:
    return (files("stepwell.studio") / "page" / name).read_text("utf-8").strip()


def _policy_hash(text: str) -> str:
    """A hash by which the page's policy allows its own script and styles alone."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _packed_base64(view: View) -> str:
    return base64.b64encode(zlib.compress(packed("replay", 0, view), 9)).decode()
