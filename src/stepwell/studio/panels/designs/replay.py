"""The motion on the page as one HTML file that can be mailed."""

from __future__ import annotations

import numpy as np

from stepwell.studio.panels.motions import program_of
from stepwell.studio.wire import Ask, Design, View

# Where no closed form tells the margins they are searched.
LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The file: of `turning_points_mm` where there are some, else of the design's own program.

    A design without a program is shown in its full cycle.
    """
    from stepwell.studio.replay import replay

    chain, written = design.chain, design.program
    if ask.has("turning_points_mm"):
        result = program_of(chain, ask)
    else:
        result = chain if written is None else written.on(chain)
    title = ask.text("title", 10_000) if ask.has("title") else None
    ask.close()
    page = replay(result, title=title, progress=ask.tell)
    return View({"suffix": "html"}, {"file": np.frombuffer(page.encode(), np.uint8)})
