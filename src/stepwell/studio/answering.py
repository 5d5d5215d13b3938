"""The answer to a message as bytes, whatever comes of it."""

from __future__ import annotations

import sys
import traceback

from stepwell.base import StepwellError
from stepwell.studio.panels import answer
from stepwell.studio.wire import Ask, Design, Message, Problem, packed, problems_of, refused

_BROKEN = (
    "The studio failed on this, and its terminal says where. Please report it with the design; "
    "go back to the last good state and on from there."
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
    except Exception:  # a fault of ours must not cost the user's session
        traceback.print_exc(file=sys.stderr)
        return refused(message.type, message.seq, [Problem("", _BROKEN)])
