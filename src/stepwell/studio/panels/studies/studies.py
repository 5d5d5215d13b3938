"""The studies in the server's folder, and which of them it is computing."""

from __future__ import annotations

from stepwell.base import have, missing
from stepwell.studio.panels.studies._folder import described, home, stores
from stepwell.studio.panels.studies._running import how
from stepwell.studio.wire import Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """Each by its name, the newest first; `missing` says how to get what studies need."""
    ask.close()
    if not have("studies"):
        return View({"missing": str(missing("studies")), "folder": "", "studies": []})
    folder = home(ask)
    found = []
    for name, place in stores(folder).items():
        running, problem = how(place)
        told = {"name": name, "running": running, "problem": problem, **described(place)}
        if "what" in told:
            found.append(told)
    return View({"missing": "", "folder": str(folder), "studies": found})
