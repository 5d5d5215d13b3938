"""Everything about a stroke program in one folder: figure, table, numbers, the design itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.files import dumps, with_program
from stepwell.files.tables import WrittenProgram
from stepwell.reports.steps import Folder, Progress, bundle
from stepwell.results import program_record

if TYPE_CHECKING:
    from stepwell.sequences import Program


def write_program(
    program: Program,
    folder: Folder,
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a stroke program: program.csv, program.json, program, and design.toml that has it."""
    from stepwell import figures

    kept = WrittenProgram.of(program)
    contents = {
        "design.toml": with_program(design, kept) if design else dumps(program.chain, program=kept),
        "program.csv": program.to_csv,
        "program.json": program_record(program, design=design),
    }
    drawn = {"program": figures.stroke_program(program)}
    return bundle(folder, "program", contents, drawn, progress=progress, force=force)
