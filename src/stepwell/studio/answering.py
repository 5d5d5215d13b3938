"""Panels by type of message, and the answer to a message as bytes."""

import json
import sys
from importlib import import_module

from stepwell.base import StepwellError
from stepwell.crash import reported
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import Message, Refusal, packed, problems_of, refusal_message

# For every type of message the file in `panels` with the function `answer_<type>`.
FILES = {
    "atlas": ("atlas",),
    "designs": ("export", "gallery", "open", "replay", "text", "thumbnails"),
    "maps": ("border", "jump", "map", "map_followed", "parameters"),
    "motion": ("cells", "evaluate", "graph", "margin", "program"),
    "recordings": ("measured",),
    "robots": ("arena", "arenas", "maze", "predict", "robot", "robot_numbers", "walk"),
    "studies": (
        *("studies", "study", "study_begin", "study_csv"),
        *("study_design", "study_estimate", "study_stop"),
    ),
    "targets": ("wish", "yield"),
}
_PANELS = {kind: file for file, kinds in FILES.items() for kind in kinds}
# Panels in a separate process: `ask.report` reports progress, and the page can cancel them.
LONG = {
    *("atlas", "export", "map_followed", "margin", "maze", "measured", "predict", "replay"),
    *("study", "study_csv", "study_design", "study_estimate", "thumbnails", "walk", "wish"),
    "yield",
}
_BROKEN = (
    "The studio failed on this. Its terminal names a file to report it with; go back to the last "
    "good state and on from there."
)


def types() -> tuple[str, ...]:
    """The type of every panel, in order."""
    return tuple(sorted(_PANELS))


def answer(kind: str, design: PageDesign, ask: Ask) -> View:
    """The answer of a panel; its file is imported at the first request."""
    panels = import_module(f"stepwell.studio.panels.{_PANELS[kind]}")
    return getattr(panels, f"answer_{kind}")(design, ask)


def answered(message: Message, ask: Ask | None = None) -> bytes:
    """The answer of a panel to a message, or all problems of the message.

    `ask` has functions that report progress; without it there are none.
    """
    design = PageDesign(message.design, message.leg)
    ask = ask or Ask(message.ask, studies=message.studies)
    try:
        return packed(message.type, message.seq, answer(message.type, design, ask))
    except StepwellError as error:
        return refusal_message(message.type, message.seq, problems_of(error))
    except Exception as error:  # a bug must not end the session
        asked = {"type": message.type, "ask": dict(message.ask), "design": message.design}
        report_error(error, json.dumps(asked, default=str))
        return refusal_message(message.type, message.seq, [Refusal("", _BROKEN)])


def report_error(error: Exception, asked: str = "") -> None:
    """Write one line about an unexpected error, and a report with the request."""
    if sys.stderr is not None:
        sys.stderr.write(f"{reported(error, ['studio'], asked)}\n")
