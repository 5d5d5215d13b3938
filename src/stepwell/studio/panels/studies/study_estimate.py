"""What a study will take, from a few of its designs."""

from __future__ import annotations

from stepwell.kernels import cores
from stepwell.studies import estimate
from stepwell.studio.panels.studies._asked import asked_study
from stepwell.studio.panels.studies._command import command_of
from stepwell.studio.panels.studies._folder import home
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(design: Design, ask: Ask) -> View:
    """What `stepwell sweep ... --estimate` tells, as numbers."""
    study = asked_study(design, ask, home(ask))
    found = estimate(study, cores())
    return View(
        {
            "name": study.folder.name,
            "designs": found.designs,
            "sample": found.sample,
            "each_ms": found.each * 1e3,
            "time_s": found.seconds,
            "workers": found.workers,
            "disk_MB": found.disk / 1e6,
            "command": command_of(study),
        }
    )
