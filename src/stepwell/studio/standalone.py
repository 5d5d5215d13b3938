"""A motion as one HTML file that plays anywhere, without a server."""

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


# By which name a frame plays by itself, and how large one is: taller where it is narrow.
_PLAYS = "plays"
_SIZE = "display:block;width:100%;height:clamp(30rem,47rem - 20vw,40rem);border:0"
# What would end or change a script that stands in HTML, wherever it is in a text of it.
_MARKS = re.compile(r"<(?=!--|/?script)", re.IGNORECASE)


def replay(
    result: Chain | Cycle | Program | Walk | Maze,
    *,
    title: str | None = None,
    margin: Margin | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> str:
    """A motion as one HTML page that plays anywhere: no server, and nothing loaded from elsewhere.

    It has a slider and the assumptions of its numbers; of a chain the mechanism, force, travel and
    energy; of a robot itself from above and from the side, its way and its legs. Long runs are
    thinned, so that the page stays below a megabyte.

    Args:
        result: a chain or its full cycle, a program, or a robot's walk or way through an arena.
        title: the chain's or the robot's own by default.
        margin: that of the chain, where it has been found already.
        progress: called with (done, total) while margins of a chain are searched.

    Raises:
        ValueError: none of these, or a run that was over before its first sample.
        StaticsError: the engine could not go on; its text says what to do.
    """
    if isinstance(result, Chain | Cycle | Program):
        motion = motion_of(result, margin, progress)
    else:
        motion = _run_of(result)
    view = with_(motion, header={**motion.header, "title": title or motion.header["title"]})
    return filled(view.header["title"], view.header["version"], _data(view))


def filled(title: str, version: str, data: str) -> str:
    """The page of a motion whose `data` is a view, packed, compressed and in base 64."""
    script, style = _MARKS.sub(r"\\x3C", _built("replay.js")), _built("replay.css")
    page = Template((files("stepwell.studio") / "standalone.html").read_text("utf-8"))
    return page.substitute(
        title=escape(title or "A motion"),
        version=escape(version),
        script=script,
        style=style,
        script_hash=_hash(script),
        style_hash=_hash(style),
        data=data,
    )


def embedded(page: str, title: str, *, plays: bool = False) -> str:
    """A page that is complete in itself as part of another one, kept apart from it.

    In a frame a replay is compact: no bar of its own, and all in view at once. A page around it
    that has a policy of its own must allow its inline script and styles, for frames inherit it.

    Args:
        page: HTML text, as of `replay`.
        title: what it shows, for screen readers.
        plays: whether it plays by itself while it is in view; never with reduced motion.

    Returns:
        An `iframe` element as wide as its surroundings: its scripts run, but reach neither them
        nor any address.
    """
    # A frame knows its own name, and nothing else of its surroundings.
    name = f' name="{_PLAYS}"' if plays else ""
    return (
        f'<iframe class="replay" title="{_plain(title)}" sandbox="allow-scripts" loading="lazy"'
        f'{name} style="{_SIZE}" srcdoc="{_plain(page)}"></iframe>'
    )


def _plain(text: str) -> str:
    """Text as a value of an attribute, the same in a page of any encoding."""
    return escape(text).encode("ascii", "xmlcharrefreplace").decode()


def _run_of(result: Walk | Maze) -> View:
    """Without MuJoCo there is no run, and this is none."""
    with suppress(ExtraError):
        from stepwell.simulation import Maze, Walk

        if isinstance(result, Walk | Maze):
            from stepwell.studio.scene import walked

            return walked(result)
    kind = type(result).__name__
    raise InputError(f"{kind}: a replay needs a Chain, a Program, or a robot's Walk or Maze.")


def _built(name: str) -> str:
    return (files("stepwell.studio") / "page" / name).read_text("utf-8").strip()


def _hash(text: str) -> str:
    """A hash by which the page's policy allows its own script and styles alone."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _data(view: View) -> str:
    return base64.b64encode(zlib.compress(packed("replay", 0, view), 9)).decode()
