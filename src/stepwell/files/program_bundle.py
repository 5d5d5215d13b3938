"""Everything about a stroke program in one folder: figure, table, numbers, the design itself."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from stepwell.files._steps import Progress, Steps, names, save_figures, write_json
from stepwell.files.atomic import staged_folder, write_atomic
from stepwell.files.program import WrittenProgram
from stepwell.files.program_record import program_record
from stepwell.files.write import dumps, with_program

if TYPE_CHECKING:
    from stepwell.sequences import Program


def write_program(
    program: Program,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
) -> tuple[str, ...]:
    """Write a stroke program into a folder, all of it or nothing.

    Args:
        program: any.
        folder: made if missing; files of the same names are replaced, others stay.
        design: text of the chain's design file, to keep with the program in it; written anew by
            default.
        progress: called with (done, total) files.

    Returns:
        The names of the files: design.toml with the table [program], program.csv, program.json,
        program.png and program.svg.

    Raises:
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    kept = WrittenProgram.of(program)
    with staged_folder(folder) as draft:
        steps = Steps(progress, 5)
        text = with_program(design, kept) if design else dumps(program.chain, program=kept)
        write_atomic(draft / "design.toml", text)
        steps.next()
        program.to_csv(draft / "program.csv")
        steps.next()
        write_json(draft / "program.json", program_record(program))
        steps.next()
        save_figures({"program": figures.stroke_program(program)}, draft, steps)
        return names(draft)
