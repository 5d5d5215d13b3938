"""Stop what computes a study; what is done stays."""

from __future__ import annotations

from stepwell.studies import cancel
from stepwell.studio.panels.studies._folder import study_of
from stepwell.studio.panels.studies._running import stop
from stepwell.studio.wire import Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """At once where this server began it; else whoever did stops after the chunks in work."""
    study = study_of(ask)
    ask.close()
    at_once = stop(study.folder)
    if not at_once:
        cancel(study)
    return View({"name": study.folder.name, "at_once": at_once})
