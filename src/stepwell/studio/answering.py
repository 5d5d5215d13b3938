"""The answer to a message as bytes, whatever comes of it."""

from __future__ import annotations

import json
import sys

from stepwell.base import StepwellError
from stepwell.crash import reported
from stepwell.studio.panels import answer
from stepwell.studio.wire import Ask, Design, Message, Problem, packed, problems_of, refused

_BROKEN = (
    "The studio failed on this. Its terminal names a file to report it with; go back to the last "
    "good state and on from there."
)


def answered(message: Message, ask: Ask | None = None) -> bytes:
    """What the panel of a message answers, or everything that is wrong with the message.

    Args:
        message: of the page.
        ask: what it asks for, where somebody is told how far it is.
    """
    design = Design(message.design, message.leg)
    ask = ask or Ask(message.ask, studies=message.studies)
    try:
        return packed(message.type, message.seq, answer(message.type, design, ask))
    except StepwellError as error:
        return refused(message.type, message.seq, problems_of(error))
    except Exception as error:  # a fault of ours must not cost the user's session
        asked = {"type": message.type, "ask": dict(message.ask), "design": message.design}
        tell(error, json.dumps(asked, default=str))
        return refused(message.type, message.seq, [Problem("", _BROKEN)])


def tell(error: Exception, asked: str = "") -> None:
    """Write a line about an unexpected error, and a report of it.

    Args:
        error: any.
        asked: by the page, as JSON.
    """
    if sys.stderr is not None:
        sys.stderr.write(f"{reported(error, ['studio'], asked)}\n")
