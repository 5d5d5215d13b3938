"""What statics says of a robot: gait, advance and the legs' margins."""

from __future__ import annotations

from stepwell.accounts import account
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell robot show --json` prints, and the prediction in words."""
    ask.close()
    prediction = design.robot.predict()
    return View({"motion": prediction.motion.value, "record": account(prediction).record})
