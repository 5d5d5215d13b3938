"""The page of a replay: its data, its script and its styles in one file."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Callable
from dataclasses import replace as with_
from html import escape
from importlib.resources import files
from string import Template

from stepwell.base import InputError
from stepwell.mechanism import Chain
from stepwell.sequences import Program
from stepwell.studio.panels import motion_of
from stepwell.studio.wire import View, packed

# What would end or change a script that stands in HTML, wherever it is in a text of it.
_MARKS = re.compile(r"<(?=!--|/?script)", re.IGNORECASE)


def replay(
    result: Chain | Program,
    *,
    title: str | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> str:
    """A motion as one HTML page that plays anywhere: no server, and nothing loaded from elsewhere.

    Args:
        result: a chain, which goes through its full cycle, or a program.
        title: the chain's own by default.
        progress: called with (done, total) while margins are searched.

    Returns:
        HTML text with a slider, the mechanism, force, travel and energy, and what they rest on.

    Raises:
        ValueError: neither a chain nor a program.
        StaticsError: the engine could not go on; its text says what to do.
    """
    if not isinstance(result, Chain | Program):
        raise InputError(f"{type(result).__name__}: a replay needs a Chain or a Program.")
    found = motion_of(result, progress)
    view = with_(found, header={**found.header, "title": title or found.header["title"]})
    script = _MARKS.sub(r"\\x3C", _built("replay.js"))
    style = _built("replay.css")
    page = Template((files("stepwell.studio.replay") / "page.html").read_text("utf-8"))
    return page.substitute(
        title=escape(view.header["title"] or "A chain"),
        version=escape(view.header["version"]),
        script=script,
        style=style,
        script_hash=_hash(script),
        style_hash=_hash(style),
        data=_data(view),
    )


def embedded(page: str, title: str) -> str:
    """A page that is complete in itself as part of another one, kept apart from it.

    Args:
        page: HTML text, as of `replay`.
        title: what it shows, for those who do not see it.

    Returns:
        An `iframe` element: its scripts run, but reach neither what is around it nor any address.
    """
    return (
        f'<iframe class="replay" title="{escape(title)}" sandbox="allow-scripts" loading="lazy" '
        f'srcdoc="{escape(page)}"></iframe>'
    )


def _built(name: str) -> str:
    return (files("stepwell.studio") / "page" / name).read_text("utf-8").strip()


def _hash(text: str) -> str:
    """By which the page's policy knows its own script and styles, and lets no other in."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _data(view: View) -> str:
    """The view as it would come over the socket, in letters that mean nothing to HTML."""
    return base64.b64encode(packed("replay", 0, view)).decode()
