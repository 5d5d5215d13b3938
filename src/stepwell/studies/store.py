"""A study on disk: what was asked is written once, what was found chunk by chunk.

A chunk is done when all of its files are there and their checksums hold; nothing else is remembered
anywhere, so whoever dies loses what was not written yet and nothing else.
"""

import hashlib
import json
import os
import shutil
import uuid
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, TypeAdapter

from stepwell import base, robot
from stepwell.studies.designs import (
    Designs,
    IndependentBlocks,
    ListedDesigns,
    Space,
    Subject,
    Workshop,
    unit_in,
)
from stepwell.studies.screen import ranked
from stepwell.studies.work import ONE_OF, SCREEN_COLUMNS, TEXT, Work, work_of

if TYPE_CHECKING:
    import xarray as xr

# What is wrong with a design is a row's last column; empty where nothing is.
PROBLEM = "problem"
_FORMAT = 1
# Stretches of missing designs that a message names.
_MOST_NAMED = 6
# The designs that somebody listed, beside the columns.
_LISTED = "listed"


class StudyError(base.InputError):
    """A folder that holds no study, another one, or one that this version cannot go on with."""


class GapError(base.StepwellError, RuntimeError):
    """A store that lacks designs of its study; the text says which, and what to do."""


@dataclass(frozen=True, eq=False)
class Gap(base.ByValue):
    """Designs that a store lacks, from `first` to `last`.

    `damaged` tells a file whose checksum does not hold from one that is not there (yet).
    """

    first: int
    last: int
    damaged: bool

    def __str__(self):
        which = f"{self.first} to {self.last}" if self.last > self.first else f"{self.first}"
        return f"{which} ({'damaged' if self.damaged else 'not there'})"


@dataclass(frozen=True, eq=False)
class Study(base.ByValue):
    """What is asked, and where its answers are.

    Attributes:
        folder: of the store.
        what: is computed of each design.
        text: of the design file that is varied.
        designs: that it is computed of.
        chunk: designs that are computed and written together.
        given: what `what` takes besides the design.
        version: of Stepwell that fills it.

    Raises:
        ValueError: chunks of nothing, or the folder is an address.
    """

    folder: Path
    what: str
    text: str = field(repr=False)
    designs: Designs
    chunk: int
    given: Mapping[str, Any] = field(default_factory=dict, repr=False)
    version: str = base.__version__
    # The columns that were opened, and what was read last of each: of which chunks, and what.
    _opened: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)
    _known: dict[str, tuple[tuple[int, ...], np.ndarray[Any, Any]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __post_init__(self):
        base.refuse_address(self.folder)
        object.__setattr__(self, "folder", Path(self.folder))
        object.__setattr__(self, "given", base.ReadOnly(self.given))
        base.check.whole("chunk", self.chunk, 1)

    @property
    def count(self) -> int:
        """Designs in all."""
        return self.designs.count

    @property
    def chunks(self) -> int:
        """Chunks in all."""
        return -(-self.count // self.chunk)

    @cached_property
    def varied(self) -> dict[str, str]:
        """Unit of every number that differs, by its name."""
        return {name: unit_in(self.subject, name) for name in self.designs.names(self.subject)}

    @cached_property
    def columns(self) -> dict[str, str]:
        """Unit of every column by its name: what differs, what is found, what was wrong."""
        found = (SCREEN_COLUMNS if self.work.screen else {}) | dict(self.work.columns)
        if twice := sorted({PROBLEM, *self.varied} & found.keys()):
            raise base.InputError(
                f"{self.what}: gives {', '.join(twice)}, which is a column already."
            )
        columns = self.varied | found | {PROBLEM: TEXT}
        for name in columns:
            # Each is a folder of the store.
            if set(name) & {"/", "\\"} or not name.isprintable() or name.startswith((".", "__")):
                raise base.InputError(
                    f"{name!r}: cannot be the name of a column: / and \\ may not be in it, nor . "
                    f"and __ begin it. A cell has a number too, as in 1.q.x."
                )
        return columns

    def told(self, name: str) -> tuple[str, float]:
        """In which unit people are told a column, and how many of it make one as it is kept.

        A key of a robot has its unit in its name, and is told as it is kept.
        """
        unit = self.columns[name]
        if unit in (TEXT, "1") or (name in self.varied and isinstance(self.subject, robot.Robot)):
            return "", 1.0
        return base.display_unit(unit)

    @cached_property
    def work(self) -> Work:
        """What is computed."""
        return work_of(self.what, self.given, self.subject)

    @cached_property
    def subject(self) -> Subject:
        """The design that is varied."""
        from stepwell.files import loads

        return loads(self.text).subject

    @cached_property
    def identity(self) -> str:
        """SHA-256 of all that is asked; two studies of one identity hold the same bytes.

        Where more designs leave the others as they are, their number is none of it.
        """
        asked = self.asked()
        if self.designs.grows:
            del asked["designs"]["count"]
        return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()

    def seed_of(self, number: int) -> int:
        """The seed of a design: of the study and its number, and of nothing else."""
        digest = hashlib.sha256(f"{self.identity}:{number}".encode()).digest()
        return int.from_bytes(digest[:4], "big")

    def by_lot(self, number: int) -> bool:
        """Whether a design is computed in any case, whatever a screen says of it."""
        return self.seed_of(number) % ONE_OF == 0

    def rows(self, chunk: int) -> range:
        """Numbers of the designs of a chunk."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.count))

    def missing(self) -> list[int]:
        """Chunks that are not done: a file is not there, or its checksum does not hold."""
        return [chunk for chunk in range(self.chunks) if not self.is_done(chunk)]

    def gaps(self, missing: Sequence[int] | None = None) -> list[Gap]:
        """Designs that are missing, in stretches of one kind; `missing` are chunks known to be."""
        found: list[Gap] = []
        for chunk in self.missing() if missing is None else missing:
            rows = self.rows(chunk)
            files = (self.folder / name / "c" / str(chunk) for name in self.columns)
            gap = Gap(rows[0], rows[-1], any(one.exists() and not _holds(one) for one in files))
            last = found[-1] if found else None
            if last and (last.last + 1, last.damaged) == (gap.first, gap.damaged):
                found[-1] = replace(last, last=gap.last)
            else:
                found.append(gap)
        return found

    def require_whole(self) -> None:
        """Refuse a store that lacks designs with a `GapError`."""
        if gaps := self.gaps():
            raise GapError(
                f"{self.folder}: {gaps_text(gaps, self.count)}. `stepwell sweep resume "
                f"{self.folder}` computes them; --partial (in Python partial=True) goes without."
            )

    def is_done(self, chunk: int) -> bool:
        """Whether all columns of a chunk are there and hold."""
        return all(_holds(self.folder / name / "c" / str(chunk)) for name in self.columns)

    def write(self, chunk: int, columns: dict[str, np.ndarray[Any, Any]]) -> None:
        """Write (rows,) of every column of a chunk; each column's file is replaced as a whole.

        After an `OSError` what is there is no chunk.
        """
        rows = self.rows(chunk)
        for name in self.columns:
            self.column(name)[rows.start : rows.stop] = columns[name]
            _sync(self.folder / name / "c" / str(chunk))

    def once(self, name: str, chunk: int, find: Callable[[], Sequence[str]]) -> list[str]:
        """What is found of a chunk and need not come out alike twice: who is first decides it.

        It is kept beside the chunks of the column for which it is found, or an `OSError` is raised.
        """
        rows = self.rows(chunk)
        place = self.folder / name / f".found-{rows.start}-{rows.stop}.json"
        if (there := _read(place)) is not None:
            return there
        draft = place.with_name(f".{uuid.uuid4().hex}")
        try:
            base.write_atomic(draft, json.dumps(list(find())))
            with suppress(FileExistsError):  # somebody else was faster
                os.link(draft, place)
            base.sync_folder(place.parent)
        finally:
            draft.unlink(missing_ok=True)
        found = _read(place)
        assert found is not None
        return found

    def to_xarray(self) -> "xr.Dataset":
        """What is there so far, over "row"; NaN and empty words where nothing is yet."""
        base.need("tables")
        import xarray as xr

        return xr.open_zarr(self.folder, consolidated=False, chunks=None)

    def done_chunks(self) -> list[int]:
        """Chunks that are done."""
        missing = set(self.missing())
        return [k for k in range(self.chunks) if k not in missing]

    def _chunks(self, partial: bool) -> list[int]:
        if partial:
            return self.done_chunks()
        self.require_whole()
        return list(range(self.chunks))

    def values(self, name: str, chunks: Sequence[int] | None = None) -> np.ndarray[Any, Any]:
        """What a column holds, row after row, as it is kept.

        Of these chunks, all of them done; by default of all that hold.
        """
        if chunks is None:
            files = self.folder / name / "c"
            chunks = [k for k in range(self.chunks) if _holds(files / str(k))]
        wanted = tuple(chunks)
        # A chunk that is done never changes.
        known, found = self._known.get(name, ((), None))
        if found is None or known != wanted:
            column = self.column(name)
            if len(wanted) == self.chunks:  # at once, which is much faster
                found = column[:]
            else:
                parts = [column.get_block_selection(k) for k in wanted]
                found = np.concatenate(parts) if parts else column[:0]
            found.flags.writeable = False
            self._known[name] = wanted, found
        return found

    def best(self, count: int, by: Sequence[str], *, partial: bool = False) -> ListedDesigns:
        """The best of the designs that are done, best first, as a list of designs.

        Args:
            count: how many at most.
            by: columns of numbers, each by its largest values or, with - before it, its least; the
                next decides where one has ties, and the design's number at last.

        Raises:
            ValueError: no such column of numbers, or no design that has a value in the first.
            GapError: designs are missing; not where `partial` is set.
        """
        if count < 1 or not by:
            raise base.InputError(
                f"best {count} by {list(by)}: must be 1 or more, by a column or more."
            )
        chunks = self._chunks(partial)
        columns = {}
        for name in dict.fromkeys(one.removeprefix("-") for one in by):
            if self.columns.get(name, TEXT) == TEXT:
                known = ", ".join(name for name, unit in self.columns.items() if unit != TEXT)
                raise base.InputError(f"{name}: is no column of numbers: must be one of {known}.")
            columns[name] = self.values(name, chunks)
        order = ranked(columns, by)[:count]
        if not order:
            raise base.InputError(f"{self.folder}: no design has a value of {by[0]} yet.")
        rows = [self.values(name, chunks)[order] for name in self.varied]
        return ListedDesigns(tuple(self.varied), np.column_stack(rows))

    def to_csv(self, file: str | os.PathLike[str], *, partial: bool = False) -> int:
        """Write a study as CSV, a line for every design, units in the headings; returns how many.

        Raises:
            GapError: designs are missing, and `partial` does not allow it.
            OSError: it cannot be written.
        """
        done, columns = self._table(partial)
        base.write_csv(file, columns)
        return len(done)

    def to_parquet(self, file: str | os.PathLike[str], *, partial: bool = False) -> int:
        """Write a study as Parquet, all as for `to_csv`; an `ExtraError` without that extra."""
        base.need("parquet")
        import pyarrow as pa
        from pyarrow import parquet

        done, columns = self._table(partial)
        table = {q.key: v if isinstance(v, list) else np.asarray(v) * q.factor for q, v in columns}
        whole = BytesIO()
        parquet.write_table(pa.table(table), whole)
        base.write_atomic(file, whole.getvalue())
        return len(done)

    def _table(self, partial: bool) -> tuple[list[int], list[tuple[base.Quantity, Any]]]:
        chunks = self._chunks(partial)
        done = [number for k in chunks for number in self.rows(k)]
        columns: list[tuple[base.Quantity, Any]] = [(base.Quantity("design"), done)]
        for name, unit in self.columns.items():
            values = self.values(name, chunks)
            told = list(map(str, values)) if unit == TEXT else values
            columns.append((base.Quantity(name, self.told(name)[0]), told))
        return done, columns

    @cached_property
    def group(self) -> Any:
        """The Zarr group."""
        import zarr

        return zarr.open_group(self.folder, mode="r+")

    def column(self, name: str) -> Any:
        """The Zarr array of a column (count,), in which a chunk of empty words is there too."""
        import zarr

        if name not in self._opened:
            # An array takes what holds when it is opened, in every version of Zarr.
            with zarr.config.set({"array.write_empty_chunks": True}):
                self._opened[name] = self.group[name]
        return self._opened[name]

    def asked(self) -> dict[str, Any]:
        """All that is asked, as the store holds it."""
        designs = self.designs
        if isinstance(designs, ListedDesigns):
            told: Any = {"columns": designs.columns, "sha256": designs.digest}
        else:
            told = _DESIGNS.dump_python(designs, mode="json")
        return {
            "format": _FORMAT,
            "what": self.what,
            "given": dict(self.given),
            "design": self.text,
            "designs": told,
            "chunk": self.chunk,
            "version": self.version,
        }

    def __repr__(self):
        names = self.designs.names(self.subject)
        varied = ", ".join(names[:4]) + (", ..." if len(names) > 4 else "")
        return f"Study({self.what} of {self.count} designs over {varied}, in {self.folder})"


_DESIGNS: TypeAdapter[Any] = TypeAdapter(Space | Workshop | IndependentBlocks)


class _Listed(BaseModel):
    columns: tuple[str, ...]
    sha256: str


class _Asked(BaseModel):
    """What a store holds of a study, so that nothing of it is believed unseen."""

    model_config = ConfigDict(extra="forbid")
    format: int
    what: str
    given: dict[str, Any]
    design: str
    designs: _Listed | Space | Workshop | IndependentBlocks
    chunk: int
    version: str


def opened(folder: str | os.PathLike[str]) -> Study:
    """The study that a folder holds; a `StudyError` if none, or its description is damaged."""
    base.need("studies")
    import zarr

    place = Path(folder)
    try:
        group = zarr.open_group(place, mode="r")
        held: Any = group.attrs["stepwell_study"]
        if isinstance(held, dict) and held.get("format", _FORMAT) != _FORMAT:
            problem = f"is of format {held['format']}, and this version reads {_FORMAT}"
            raise StudyError(f"{place}: {problem}.")
        asked = _Asked.model_validate(held)
        designs = asked.designs
        if isinstance(designs, _Listed):
            listed: Any = group[_LISTED]
            table = ListedDesigns(designs.columns, listed[:])
            if table.digest != designs.sha256:
                raise StudyError(f"{place}: its list of designs is damaged.")
            designs = table
        study = Study(
            place, asked.what, asked.design, designs, asked.chunk, asked.given, asked.version
        )
        study.subject  # noqa: B018  the design is read, or refused
    except StudyError:
        raise
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise StudyError(f"{place}: holds no study ({type(error).__name__}: {error}).") from None
    return study


def edition(folder: str | os.PathLike[str]) -> tuple[int, ...]:
    """Of the description that a folder holds what differs once it is written anew."""
    try:
        held = (Path(folder) / "zarr.json").stat()
    except OSError:
        return ()
    return held.st_ino, held.st_size, held.st_mtime_ns


def begun(study: Study) -> Study:
    """The study with its store: made where there is none, the same where it was begun before.

    Raises:
        StudyError: the folder holds another study, or the same by another version.
        OSError: it cannot be written.
    """
    base.need("studies")
    if not study.folder.exists():
        _make(study)
    there = opened(study.folder)
    same_version(there, study.version)
    if there.identity != study.identity:
        raise StudyError(
            f"{study.folder}: holds another study: {there!r}. Name another folder, or remove it."
        )
    if there.count != study.count:
        raise StudyError(
            f"{study.folder}: holds this study with {there.count} designs, not {study.count}: "
            f"extend it, or name another folder."
        )
    return there


def same_version(study: Study, version: str) -> None:
    """Refuse to go on with what another version of Stepwell has begun, with a `StudyError`."""
    if study.version != version:
        raise StudyError(
            f"{study.folder}: was begun by Stepwell {study.version}, and this is {version}: "
            f"numbers of two versions are not mixed. Go on with that version, or name another "
            f"folder."
        )


def extended(study: Study, count: int) -> Study:
    """The study with more designs; those that there are stay. Nobody may be working on it.

    Raises:
        StudyError: fewer designs, or designs of which more would move the others: only those of a
            Sobol' sequence, at random or as built were drawn one by one.
        OSError: it cannot be written; the same call goes on.
    """
    designs = study.designs
    if isinstance(designs, ListedDesigns) or not designs.grows:
        raise StudyError(
            f"{study.folder}: its designs are {designs.how}: more of them would move the others. "
            f"Those that are sobol, random or as built can be extended."
        )
    if count < study.count:
        raise StudyError(f"{study.folder}: has {study.count} designs: {count} would be fewer.")
    larger = replace(study, designs=replace(designs, count=count))
    if study.count % study.chunk and count > study.count:
        # The last chunk was not full: it is computed again with what now belongs to it.
        for name in study.columns:
            (study.folder / name / "c" / str(study.chunks - 1)).unlink(missing_ok=True)
    # Columns first: whoever dies in between leaves a study of as many designs as before.
    for name in study.columns:
        if study.column(name).shape[0] < count:
            study.column(name).resize((count,))
    study.group.attrs["stepwell_study"] = larger.asked()
    base.sync_folder(study.folder)
    return opened(study.folder)


def _make(study: Study) -> None:
    """Write the description into a sibling, which then takes the name."""
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec

    draft = study.folder.with_name(f".{study.folder.name}.{uuid.uuid4().hex}")
    try:
        group = zarr.open_group(draft, mode="w", zarr_format=3)
        for name, unit in study.columns.items():
            array = group.create_array(
                name,
                shape=(study.count,),
                chunks=(study.chunk,),
                dtype=str if unit == TEXT else "float64",
                fill_value="" if unit == TEXT else np.nan,
                compressors=[ZstdCodec(level=3), Crc32cCodec()],
                dimension_names=["row"],
            )
            if unit != TEXT:
                array.attrs["units"] = unit
        if isinstance(study.designs, ListedDesigns):
            rows = study.designs.rows
            dims = ["row", "listed_column"]
            group.create_array(
                _LISTED, data=np.array(rows), chunks=rows.shape, dimension_names=dims
            )
        design = hashlib.sha256(study.text.encode()).hexdigest()
        told = {"stepwell_study": study.asked(), "design_sha256": design}
        # What xarray then has as coordinates.
        group.attrs.update(told | {"coordinates": " ".join(study.varied)})
        try:
            draft.rename(study.folder)
        except OSError:
            if not study.folder.exists():  # else somebody else was faster
                raise
        base.sync_folder(study.folder.parent)
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def gaps_text(gaps: Sequence[Gap], count: int) -> str:
    """How many designs of a study are missing, and which."""
    lacking = sum(gap.last - gap.first + 1 for gap in gaps)
    named = base.join_first([*map(str, gaps)], _MOST_NAMED, "more stretches")
    return f"{lacking} of {count} designs are missing: {named}"


def _holds(file: Path) -> bool:
    """Whether a chunk's file is there and ends in the checksum of what is before it."""
    from google_crc32c import value

    try:
        held = file.read_bytes()
    except OSError:
        return False
    return value(held[:-4]) == int.from_bytes(held[-4:], "little") if len(held) > 4 else False


def _read(file: Path) -> list[str] | None:
    return json.loads(file.read_text("utf-8")) if file.exists() else None


def _sync(file: Path) -> None:
    """Have the disk hold a file before anybody counts on it."""
    with file.open("rb") as written:
        os.fsync(written.fileno())
    base.sync_folder(file.parent)
