"""One design of a study, for the editor."""

from __future__ import annotations

from stepwell import files
from stepwell.base import InputError
from stepwell.robot import Robot
from stepwell.studies import Blocks
from stepwell.studio.panels.studies._folder import study_of
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(_design: Design, ask: Ask) -> View:
    """The tables of the design of that `number`, counted from 0."""
    study = study_of(ask)
    number = ask.whole("number", 0, study.count - 1)
    ask.close()
    designs = study.designs
    if isinstance(designs, Blocks):
        raise InputError(f"{study.folder.name}: is an atlas, whose rows are blocks of designs.")
    (_, made), *_ = designs.made(study.subject, number, number + 1)
    if isinstance(made, ValueError):
        raise InputError(f"design {number}: cannot be built: {made}")
    tables = files.tables_in(files.dumps(made))
    return View({"number": number, "design": tables, "robot": isinstance(made, Robot)})
