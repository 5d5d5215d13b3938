"""Options that say how recordings are read, shared by all commands that read them."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperCommand

import stepwell as sw
from stepwell.base import Measure
from stepwell.cli.options import Group, flag, option
from stepwell.cli.screen import progress, usable, warn, wrong

if TYPE_CHECKING:
    from stepwell.lab import Batch, LabError, Reading, Recording

_MOST_SHOWN = 4  # readings, and tables of columns
_RANGE = re.compile(r", -?[\d.e+-]+ to -?[\d.e+-]+ [^ ]*$|, -?[\d.e+-]+ [^ ]* in the file$")


class ReadingCommand(TyperCommand):
    """A command with the options below, in which `--force 5` is the column of the force.

    `--force` without a number overwrites files, as in all commands.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse arguments, after `--force` with a number is `--force-column`."""
        end = args.index("--") if "--" in args else len(args)
        for k, (one, after) in enumerate(zip(args, [*args[1:], ""], strict=True)):
            is_column = one == "--force" and after.isdecimal() and k + 1 < end
            if k < end and (is_column or one.startswith("--force=")):
                args[k] = one.replace("--force", "--force-column", 1)
        return super().parse_args(ctx, args)


class ReadingOptions(Group):
    """How recordings are read, where their files leave it open."""

    stroke: str | None = option("Column of the stroke: number or name.", "COLUMN")
    force_column: str | None = option(
        "Column of the force: number or name; a number may follow --force.", "--force-column COLUMN"
    )
    unit: str | None = option("Units of stroke and force, such as mm,N.", "UNIT,UNIT")
    flip: str | None = option(
        "Signs to turn: none, stroke, force or both; by default the work decides.", "WORD"
    )
    half: str | None = option("Half to use: loading, unloading or both.", "WORD")
    cycle: int | None = option("Cycle to use, from 1.", "N", min=1)
    skip: int = option("Lines at the beginning of a file to skip.", "N", default=0, min=0)
    sample: int | None = option("Specimen of a file with several, from 1.", "N", min=1)
    decimal: str | None = option("Decimal mark of the numbers: . or , if unclear.", "MARK")
    save_reading: bool = flag(
        "Write these options into recording.toml in the folder of the files, where all commands "
        "and designs use them.",
        "--save-reading",
    )

    @property
    def reading(self) -> Reading:
        """The reading that these options give; a usage error for a wrong value."""
        with usable():
            names = [one.name for one in fields(sw.lab.Reading)]
            given: dict[str, Any] = {n: getattr(self, n) for n in names if n != "force"}
            return sw.lab.Reading(force=self.force_column, **given)

    def read_all(
        self, paths: Sequence[Path], measures: Iterable[Measure] = (Measure.TRAVEL,)
    ) -> Batch:
        """All recordings of some paths; how they were read is printed.

        At a terminal, columns that the files leave open are asked, and the signs of a single file.
        """
        reading = self.reading
        if self.save_reading and not reading.given() and not _asks():
            raise wrong("--save-reading", "needs --stroke, --force or another option to save.")

        def read() -> Batch:
            with progress("reading") as tell:
                return sw.lab.read_all(paths, reading, tell, measures)

        batch = read()
        unclear = [error for error in batch.refused if error.columns]
        if unclear and _asks():
            reading = _asked(unclear[0], reading)
            batch = read()
        elif unclear:
            warn(columns_text(unclear[0]))
        if reading.flip is None and _asks() and (signs := _open_signs(paths, batch)):
            reading = replace(reading, flip=asked_flip(*signs))
            batch = read()
        warn_readings(batch.recordings)
        if self.save_reading and reading.given():
            _save_reading(reading, batch)
        return batch

    def recordings(
        self, paths: Sequence[Path], measures: Iterable[Measure] = (Measure.TRAVEL,)
    ) -> list[Recording]:
        """All recordings of some paths; files that cannot be read are warnings."""
        batch = self.read_all(paths, measures)
        for error in batch.refused:
            warn(str(error))
        if not batch.recordings:
            raise sw.lab.LabError(
                ", ".join(map(str, paths)), "holds no recording that can be read."
            )
        return list(batch.recordings)


def warn_readings(recordings: Iterable[Recording]) -> None:
    """Print how recordings were read, once for all files that were read alike."""
    groups: dict[tuple[str, ...], list[Recording]] = {}
    for one in recordings:
        if one.reading:
            alike = tuple(_RANGE.sub("", line) for line in one.reading)
            groups.setdefault(alike, []).append(one)
    for alike, some in list(groups.items())[:_MOST_SHOWN]:
        first, others = some[0], len(some) - 1
        lines = alike if others else first.reading
        more = f" and {others} more" if others else ""
        warn(f"{first.source}{more}: {'; '.join(lines)}")
    if len(groups) > _MOST_SHOWN:
        warn(f"{len(groups) - _MOST_SHOWN} more kinds of files: read them alone to list columns.")


def columns_text(error: LabError) -> str:
    """The numbered columns of a file as lines: name, unit, range, and what each may be."""
    rows = [("", "column", "unit", "range", ""), *error.columns]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    lines = (
        "  ".join([*(f"{x:<{w}}" for x, w in zip(row[:4], widths, strict=True)), row[4]]).rstrip()
        for row in rows
    )
    return "\n".join([f"Columns of {error.name}:", *lines])


def _save_reading(reading: Reading, batch: Batch) -> None:
    folders = [Path(one.source).parent for one in batch.recordings]
    for folder in dict.fromkeys(folders):
        warn(f"{sw.lab.save_reading(reading, folder)}: written.")


def _open_signs(paths: Sequence[Path], batch: Batch) -> tuple[str, tuple[str, ...]] | None:
    """Why the signs of a single file are open, and its values of `flip`; None if they are not."""
    if len(paths) != 1 or not paths[0].is_file():
        return None
    for error in batch.refused:
        return (str(error), error.flips) if error.flips else None
    for one in batch.recordings:
        if one.other_flip:
            return f"{one.source}: {'; '.join(one.reading)}", ("none", one.other_flip)
    return None


def asked_flip(why: str, flips: Sequence[str]) -> str:
    """The value of `flip` that the user enters."""
    warn(why)
    allowed = ", ".join(flips)
    while (answer := typer.prompt(f"Signs to turn ({allowed})", err=True)) not in flips:
        warn(f"{answer!r}: must be one of {allowed}.")
    warn(f"The same as options: --flip {answer}")
    return answer


def _asks() -> bool:
    """Whether a person at a terminal can answer."""
    streams = sys.stdin, sys.stderr
    return all(stream is not None and stream.isatty() for stream in streams)


def _asked(error: LabError, reading: Reading) -> Reading:
    """The reading with the columns and the units that the user enters."""
    warn(f"{error}\n{columns_text(error)}")
    given: dict[str, Any] = {}
    for key in ("stroke", "force"):
        if getattr(reading, key) is None:
            given[key] = typer.prompt(f"Column of the {key} (number)", type=int, err=True)
    chosen = [row for row in error.columns if row[0] in {str(one) for one in given.values()}]
    if reading.unit is None and any(not row[2] for row in chosen):
        given["unit"] = typer.prompt("Units of stroke and force (such as mm,N)", err=True)
    with usable():
        answer = replace(reading, **given)
    warn(f"The same as options: {answer.options}")
    return answer
