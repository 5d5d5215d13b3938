"""The design as a file and as a script."""

from __future__ import annotations

from stepwell import files
from stepwell.studio.panels.designs._script import script
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """TOML that reads as this design, and Python that makes it."""
    ask.close()
    found, program = design.read.subject, design.read.program
    toml = files.dumps(found, program=program)
    return View({"toml": toml, "python": script(found, toml)})
