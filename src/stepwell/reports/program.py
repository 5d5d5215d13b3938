"""Everything about a stroke program in one folder: figure, table, numbers, the design itself."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from stepwell.base import write_atomic
from stepwell.files import dumps, staged_folder, with_program
from stepwell.files.tables import WrittenProgram
from stepwell.reports.steps import Progress, Steps, names, save_figures, write_json
from stepwell.results import program_record

if TYPE_CHECKING:
    from stepwell.sequences import Program


def write_program(
    program: Program,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a stroke program into a folder, all of it or nothing.

    Args:
        program: any.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the chain's design file, to keep with the program in it; written anew by
            default.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: design.toml with the table [program], program.csv, program.json,
        program.png and program.svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    kept = WrittenProgram.of(program)
    record = program_record(program, design=design)
    with staged_folder(folder, "program", record, force=force) as draft:
        steps = Steps(progress, 5)
        text = with_program(design, kept) if design else dumps(program.chain, program=kept)
        write_atomic(draft / "design.toml", text)
        steps.next()
        program.to_csv(draft / "program.csv")
        steps.next()
        write_json(draft / "program.json", record)
        steps.next()
        save_figures({"program": figures.stroke_program(program)}, draft, steps)
        return names(draft)
