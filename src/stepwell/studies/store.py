"""A study on disk: its description is written once, its results chunk by chunk.

A chunk is finished when all of its files exist with valid checksums. There is no other state, so an
interruption loses only what was not yet written.
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

# The last column of a row is the problem of a design, empty without one.
PROBLEM = "problem"
_FORMAT = 1
# Largest number of gaps named in a message.
_MOST_NAMED = 6
# Array with the list of designs, stored next to the columns.
_LISTED = "listed"


class StudyError(base.InputError):
    """A folder without a study, with another one, or with one that this version cannot resume."""


class GapError(base.StepwellError, RuntimeError):
    """A store that lacks designs of its study; the text lists them, with a remedy."""


@dataclass(frozen=True, eq=False)
class Gap(base.ByValue):
    """Designs that a store lacks, from `first` to `last`.

    `damaged` is true for an invalid checksum, and false for a missing file.
    """

    first: int
    last: int
    damaged: bool

    def __str__(self):
        which = f"{self.first} to {self.last}" if self.last > self.first else f"{self.first}"
        return f"{which} ({'damaged' if self.damaged else 'missing'})"


@dataclass(frozen=True, eq=False)
class Study(base.ByValue):
    """Description of a study, and the path of its store.

    Attributes:
        folder: path of the store.
        what: quantity computed for each design.
        text: text of the nominal design file.
        designs: the designs.
        chunk: number of designs that are computed and written together.
        given: options of `what`.
        version: version of Stepwell that computes it.

    Raises:
        ValueError: chunks smaller than 1, or a folder that is an URL.
    """

    folder: Path
    what: str
    text: str = field(repr=False)
    designs: Designs
    chunk: int
    given: Mapping[str, Any] = field(default_factory=dict, repr=False)
    version: str = base.__version__
    # Opened columns, and the last read chunks and values of each.
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
        """Number of designs."""
        return self.designs.count

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self.count // self.chunk)

    @cached_property
    def varied(self) -> dict[str, str]:
        """Unit of every varied parameter, by its name."""
        return {name: unit_in(self.subject, name) for name in self.designs.names(self.subject)}

    @cached_property
    def columns(self) -> dict[str, str]:
        """Unit of every column by its name: varied parameters, results, problem."""
        results = (SCREEN_COLUMNS if self.work.screen else {}) | dict(self.work.columns)
        if twice := sorted({PROBLEM, *self.varied} & results.keys()):
            raise base.InputError(
                f"{self.what}: returns {', '.join(twice)}, which is already a column."
            )
        columns = self.varied | results | {PROBLEM: TEXT}
        for name in columns:
            # Each column is a folder of the store.
            if set(name) & {"/", "\\"} or not name.isprintable() or name.startswith((".", "__")):
                raise base.InputError(
                    f"{name!r}: cannot be the name of a column: it must not contain / or \\, nor "
                    f"begin with . or __. Refer to the cell by its number, as in 1.q.x."
                )
        return columns

    def display_unit(self, name: str) -> tuple[str, float]:
        """Display unit of a column, and the factor from its stored unit. A key of a robot has its
        unit in its name and is not converted.
        """
        unit = self.columns[name]
        if unit in (TEXT, "1") or (name in self.varied and isinstance(self.subject, robot.Robot)):
            return "", 1.0
        return base.display_unit(unit)

    @cached_property
    def work(self) -> Work:
        """The computation of a row."""
        return work_of(self.what, self.given, self.subject)

    @cached_property
    def subject(self) -> Subject:
        """The nominal design."""
        from stepwell.files import loads

        return loads(self.text).subject

    @cached_property
    def identity(self) -> str:
        """SHA-256 of the description; two studies with one identity have bit-identical results. It
        does not depend on the number of designs if a study can be extended.
        """
        asked = self.asked()
        if self.designs.grows:
            del asked["designs"]["count"]
        return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()

    def seed_of(self, number: int) -> int:
        """Random seed of a design; it depends only on the study and the number."""
        digest = hashlib.sha256(f"{self.identity}:{number}".encode()).digest()
        return int.from_bytes(digest[:4], "big")

    def by_lot(self, number: int) -> bool:
        """Whether a design belongs to the random sample that a screen does not skip."""
        return self.seed_of(number) % ONE_OF == 0

    def rows(self, chunk: int) -> range:
        """Numbers of the designs of a chunk."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.count))

    def missing(self) -> list[int]:
        """Unfinished chunks: a file is missing, or its checksum is invalid."""
        return [chunk for chunk in range(self.chunks) if not self.is_done(chunk)]

    def gaps(self, missing: Sequence[int] | None = None) -> list[Gap]:
        """Missing designs as gaps of one kind; `missing` are known missing chunks."""
        gaps: list[Gap] = []
        for chunk in self.missing() if missing is None else missing:
            rows = self.rows(chunk)
            files = (self.folder / name / "c" / str(chunk) for name in self.columns)
            gap = Gap(rows[0], rows[-1], any(one.exists() and not _holds(one) for one in files))
            last = gaps[-1] if gaps else None
            if last and (last.last + 1, last.damaged) == (gap.first, gap.damaged):
                gaps[-1] = replace(last, last=gap.last)
            else:
                gaps.append(gap)
        return gaps

    def require_whole(self) -> None:
        """Raise a `GapError` if designs are missing."""
        if gaps := self.gaps():
            raise GapError(
                f"{self.folder}: {gaps_text(gaps, self.count)}. Compute them with `stepwell sweep "
                f"resume {self.folder}`, or leave them out with --partial (in Python partial=True)."
            )

    def is_done(self, chunk: int) -> bool:
        """Whether all columns of a chunk exist with valid checksums."""
        return all(_holds(self.folder / name / "c" / str(chunk)) for name in self.columns)

    def write(self, chunk: int, columns: dict[str, np.ndarray[Any, Any]]) -> None:
        """Write (rows,) of every column of a chunk; each file is replaced completely.

        After an `OSError` the chunk is unfinished.
        """
        rows = self.rows(chunk)
        for name in self.columns:
            self.column(name)[rows.start : rows.stop] = columns[name]
            _sync(self.folder / name / "c" / str(chunk))

    def once(self, name: str, chunk: int, find: Callable[[], Sequence[str]]) -> list[str]:
        """Texts for a chunk that may differ between two computations; the first result is kept. The
        file is next to the chunks of its column; an `OSError` is raised if it cannot be written.
        """
        rows = self.rows(chunk)
        place = self.folder / name / f".found-{rows.start}-{rows.stop}.json"
        if (there := _read(place)) is not None:
            return there
        draft = place.with_name(f".{uuid.uuid4().hex}")
        try:
            base.write_atomic(draft, json.dumps(list(find())))
            with suppress(FileExistsError):  # another worker was faster
                os.link(draft, place)
            base.sync_folder(place.parent)
        finally:
            draft.unlink(missing_ok=True)
        texts = _read(place)
        assert texts is not None
        return texts

    def to_xarray(self) -> "xr.Dataset":
        """The results so far over "row"; NaN and empty texts where they are missing."""
        base.need("tables")
        import xarray as xr

        return xr.open_zarr(self.folder, consolidated=False, chunks=None)

    def done_chunks(self) -> list[int]:
        """Finished chunks."""
        missing = set(self.missing())
        return [k for k in range(self.chunks) if k not in missing]

    def _chunks(self, partial: bool) -> list[int]:
        if partial:
            return self.done_chunks()
        self.require_whole()
        return list(range(self.chunks))

    def values(self, name: str, chunks: Sequence[int] | None = None) -> np.ndarray[Any, Any]:
        """Stored values of a column in these finished chunks; by default in all finished chunks."""
        if chunks is None:
            files = self.folder / name / "c"
            chunks = [k for k in range(self.chunks) if _holds(files / str(k))]
        wanted = tuple(chunks)
        # A finished chunk never changes.
        known, values = self._known.get(name, ((), None))
        if values is None or known != wanted:
            column = self.column(name)
            if len(wanted) == self.chunks:  # at once, which is much faster
                values = column[:]
            else:
                parts = [column.get_block_selection(k) for k in wanted]
                values = np.concatenate(parts) if parts else column[:0]
            values.flags.writeable = False
            self._known[name] = wanted, values
        return values

    def best(self, count: int, by: Sequence[str], *, partial: bool = False) -> ListedDesigns:
        """The best of the finished designs, best first, as a list of designs.

        Args:
            count: largest number of designs.
            by: columns of numbers, sorted by falling values or, with - before the name, by rising
                values; later columns break ties, then the number of the design.
            partial: ignore missing designs.

        Raises:
            ValueError: an unknown column, or no design with a value in the first.
            GapError: designs are missing, and `partial` is not set.
        """
        if count < 1 or not by:
            raise base.InputError(
                f"best {count} by {list(by)}: the number must be at least 1, with a column."
            )
        chunks = self._chunks(partial)
        columns = {}
        for name in dict.fromkeys(one.removeprefix("-") for one in by):
            if self.columns.get(name, TEXT) == TEXT:
                known = ", ".join(name for name, unit in self.columns.items() if unit != TEXT)
                raise base.InputError(f"{name}: no column of numbers: must be one of {known}.")
            columns[name] = self.values(name, chunks)
        order = ranked(columns, by)[:count]
        if not order:
            raise base.InputError(
                f"{self.folder}: no finished design has a value of {by[0]}: choose another column."
            )
        rows = [self.values(name, chunks)[order] for name in self.varied]
        return ListedDesigns(tuple(self.varied), np.column_stack(rows))

    def to_csv(self, file: str | os.PathLike[str], *, partial: bool = False) -> int:
        """Write a study as CSV with a line per design and units in the headings.

        Returns the number of designs.

        Raises:
            GapError: designs are missing, and `partial` is not set.
            OSError: the file cannot be written.
        """
        done, columns = self._table(partial)
        base.write_csv(file, columns)
        return len(done)

    def to_parquet(self, file: str | os.PathLike[str], *, partial: bool = False) -> int:
        """Write a study as Parquet, otherwise as `to_csv`; needs the extra parquet."""
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
            shown = list(map(str, values)) if unit == TEXT else values
            columns.append((base.Quantity(name, self.display_unit(name)[0]), shown))
        return done, columns

    @cached_property
    def group(self) -> Any:
        """The Zarr group."""
        import zarr

        return zarr.open_group(self.folder, mode="r+")

    def column(self, name: str) -> Any:
        """The Zarr array of a column (count,); chunks of empty texts are written too."""
        import zarr

        if name not in self._opened:
            # In every version of Zarr, an array uses the configuration at its opening.
            with zarr.config.set({"array.write_empty_chunks": True}):
                self._opened[name] = self.group[name]
        return self._opened[name]

    def asked(self) -> dict[str, Any]:
        """The description of the study, as stored."""
        designs = self.designs
        if isinstance(designs, ListedDesigns):
            described: Any = {"columns": designs.columns, "sha256": designs.digest}
        else:
            described = _DESIGNS.dump_python(designs, mode="json")
        return {
            "format": _FORMAT,
            "what": self.what,
            "given": dict(self.given),
            "design": self.text,
            "designs": described,
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
    """The stored description of a study, for validation."""

    model_config = ConfigDict(extra="forbid")
    format: int
    what: str
    given: dict[str, Any]
    design: str
    designs: _Listed | Space | Workshop | IndependentBlocks
    chunk: int
    version: str


def opened(folder: str | os.PathLike[str]) -> Study:
    """The study in a folder; a `StudyError` if there is none, or its description is damaged."""
    base.need("studies")
    import zarr

    place = Path(folder)
    try:
        group = zarr.open_group(place, mode="r")
        held: Any = group.attrs["stepwell_study"]
        if isinstance(held, dict) and held.get("format", _FORMAT) != _FORMAT:
            problem = f"has format {held['format']}, and this version reads format {_FORMAT}"
            raise StudyError(f"{place}: {problem}: use the version that wrote it.")
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
        study.subject  # noqa: B018  raises an error for an invalid design
    except StudyError:
        raise
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise StudyError(f"{place}: contains no study ({type(error).__name__}: {error}).") from None
    return study


def edition(folder: str | os.PathLike[str]) -> tuple[int, ...]:
    """Inode, size and time of the description in a folder, which differ after it is rewritten."""
    try:
        held = (Path(folder) / "zarr.json").stat()
    except OSError:
        return ()
    return held.st_ino, held.st_size, held.st_mtime_ns


def begun(study: Study) -> Study:
    """The study with its store, which is created if it does not exist.

    Raises:
        StudyError: the folder contains another study, or the same study of another version.
        OSError: the store cannot be written.
    """
    base.need("studies")
    if not study.folder.exists():
        _make(study)
    there = opened(study.folder)
    same_version(there, study.version)
    if there.identity != study.identity:
        raise StudyError(
            f"{study.folder}: contains another study: {there!r}. Use another folder, or remove it."
        )
    if there.count != study.count:
        raise StudyError(
            f"{study.folder}: contains this study with {there.count} designs, not {study.count}: "
            f"extend it, or use another folder."
        )
    return there


def same_version(study: Study, version: str) -> None:
    """Raise a `StudyError` if another version of Stepwell has started the study."""
    if study.version != version:
        raise StudyError(
            f"{study.folder}: started with Stepwell {study.version}, and this is {version}: "
            f"results of two versions are not mixed. Resume with that version, or use another "
            f"folder."
        )


def extended(study: Study, count: int) -> Study:
    """The study with more designs; existing results are kept. No worker may be running.

    Raises:
        StudyError: fewer designs, or designs whose values depend on their number: only Sobol',
            random and Monte Carlo designs can be extended.
        OSError: the store cannot be written; repeat the same call.
    """
    designs = study.designs
    if isinstance(designs, ListedDesigns) or not designs.grows:
        raise StudyError(
            f"{study.folder}: its designs are {designs.how}: more designs would change them. Only "
            f"designs that are sobol, random or as built can be extended."
        )
    if count < study.count:
        raise StudyError(f"{study.folder}: has {study.count} designs: {count} would be fewer.")
    larger = replace(study, designs=replace(designs, count=count))
    if study.count % study.chunk and count > study.count:
        # The last chunk was not full: it is recomputed with its new designs.
        for name in study.columns:
            (study.folder / name / "c" / str(study.chunks - 1)).unlink(missing_ok=True)
    # Columns first: an interruption then leaves the study with its previous number of designs.
    for name in study.columns:
        if study.column(name).shape[0] < count:
            study.column(name).resize((count,))
    study.group.attrs["stepwell_study"] = larger.asked()
    base.sync_folder(study.folder)
    return opened(study.folder)


def _make(study: Study) -> None:
    """Write the description into a temporary folder and rename it."""
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
        attributes = {"stepwell_study": study.asked(), "design_sha256": design}
        # Coordinates for xarray.
        group.attrs.update(attributes | {"coordinates": " ".join(study.varied)})
        try:
            draft.rename(study.folder)
        except OSError:
            if not study.folder.exists():  # otherwise another process was faster
                raise
        base.sync_folder(study.folder.parent)
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def gaps_text(gaps: Sequence[Gap], count: int) -> str:
    """Text with the number of missing designs of a study, and the gaps."""
    lacking = sum(gap.last - gap.first + 1 for gap in gaps)
    named = base.join_first([*map(str, gaps)], _MOST_NAMED, "more stretches")
    return f"{lacking} of {count} designs are missing: {named}"


def _holds(file: Path) -> bool:
    """Whether a chunk's file exists and ends in a valid checksum."""
    from google_crc32c import value

    try:
        held = file.read_bytes()
    except OSError:
        return False
    return value(held[:-4]) == int.from_bytes(held[-4:], "little") if len(held) > 4 else False


def _read(file: Path) -> list[str] | None:
    return json.loads(file.read_text("utf-8")) if file.exists() else None


def _sync(file: Path) -> None:
    """Flush a file and its folder to the disk."""
    with file.open("rb") as written:
        os.fsync(written.fileno())
    base.sync_folder(file.parent)
