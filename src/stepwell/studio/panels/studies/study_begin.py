"""Begin a study in the server's folder, or go on with one of those that are there."""

from __future__ import annotations

from stepwell.studies import begun
from stepwell.studio.panels.studies._asked import asked_study
from stepwell.studio.panels.studies._folder import home, study_of
from stepwell.studio.panels.studies._running import begin
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """The name of the store; a study that was begun before is the same, and goes on."""
    if ask.has("name"):
        study = study_of(ask)
        ask.close()
    else:
        folder = home(ask)
        study = asked_study(design, ask, folder)
        folder.mkdir(parents=True, exist_ok=True)
    study = begun(study)
    begin(study.folder)
    return View({"name": study.folder.name})
