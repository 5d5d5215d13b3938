"""A study on disk: what was asked is written once, what was found chunk by chunk.

A chunk is done when all of its files are there and their checksums hold; nothing else is remembered
anywhere, so whoever dies loses what was not written yet and nothing else.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import uuid
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import (
    ByValue,
    InputError,
    Quantity,
    __version__,
    need,
    sync_folder,
    told_in,
    write_csv,
)
from stepwell.studies.space import Axis, How, Space
from stepwell.studies.work import TEXT, work_of

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.mechanism import Chain

# What is wrong with a design is a row's last column; empty where nothing is.
PROBLEM = "problem"
_FORMAT = 1


class StudyError(InputError):
    """A folder that holds no study, another one, or one that this version cannot go on with."""


@dataclass(frozen=True, eq=False)
class Study(ByValue):
    """What is asked, and where its answers are.

    Attributes:
        folder: of the store.
        what: is computed of each design.
        text: of the design file that is varied.
        space: of the designs.
        chunk: designs that are computed and written together.
        version: of Stepwell that fills it.
    """

    folder: Path
    what: str
    text: str = field(repr=False)
    space: Space
    chunk: int
    version: str = __version__

    @property
    def count(self) -> int:
        """Designs in all."""
        return self.space.count

    @property
    def chunks(self) -> int:
        """Chunks in all."""
        return -(-self.count // self.chunk)

    @property
    def columns(self) -> dict[str, str]:
        """Unit of every column by its name: what varies, what is found, what was wrong."""
        from stepwell.design import parameter

        varied = {name: parameter(self.chain, name).unit or "1" for name in self.space.names}
        return varied | dict(work_of(self.what).columns) | {PROBLEM: TEXT}

    @cached_property
    def chain(self) -> Chain:
        """The design that is varied."""
        from stepwell.files import loads_chain

        return loads_chain(self.text)

    @cached_property
    def identity(self) -> str:
        """SHA-256 of all that is asked; two studies of one identity hold the same bytes."""
        return hashlib.sha256(json.dumps(self._asked(), sort_keys=True).encode()).hexdigest()

    def seed_of(self, number: int) -> int:
        """The seed of a design: of the study and its number, and of nothing else."""
        digest = hashlib.sha256(f"{self.identity}:{number}".encode()).digest()
        return int.from_bytes(digest[:4], "big")

    def rows(self, chunk: int) -> range:
        """Numbers of the designs of a chunk."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.count))

    def missing(self) -> list[int]:
        """Chunks that are not done: a file is not there, or its checksum does not hold."""
        return [chunk for chunk in range(self.chunks) if not self.is_done(chunk)]

    def is_done(self, chunk: int) -> bool:
        """Whether all columns of a chunk are there and hold."""
        return all(_holds(self.column(name), chunk) for name in self.columns)

    def write(self, chunk: int, columns: dict[str, np.ndarray[Any, Any]]) -> None:
        """Write the rows of a chunk; each column's file is replaced as a whole.

        Args:
            chunk: which.
            columns: (rows,) of every column.

        Raises:
            OSError: it cannot be written; what is there then is no chunk.
        """
        rows = self.rows(chunk)
        for name in self.columns:
            self.column(name)[rows.start : rows.stop] = columns[name]
            _sync(self.folder / name / "c" / str(chunk))

    def to_xarray(self) -> xr.Dataset:
        """What is there so far, over "row"; NaN and empty words where nothing is yet."""
        need("tables")
        import xarray as xr

        return xr.open_zarr(self.folder, consolidated=False, chunks=None)

    def to_csv(self, file: str | os.PathLike[str]) -> int:
        """Write what is done as CSV, a line for every design, units in the headings.

        Args:
            file: where to.

        Returns:
            How many designs are done.

        Raises:
            OSError: it cannot be written.
        """
        missing = set(self.missing())
        done = [n for k in range(self.chunks) if k not in missing for n in self.rows(k)]
        columns: list[tuple[Quantity, Any]] = [(Quantity("design"), done)]
        for name, unit in self.columns.items():
            told = "" if unit in (TEXT, "1") else told_in(unit)[0]
            values = self.column(name)[:][done] if done else []
            columns.append(
                (Quantity(name, told), [str(v) for v in values] if unit == TEXT else values)
            )
        write_csv(file, columns)
        return len(done)

    @cached_property
    def _group(self) -> Any:
        import zarr

        return zarr.open_group(self.folder, mode="r+")

    def column(self, name: str) -> Any:
        """The Zarr array of a column (count,), in which a chunk of empty words is there too."""
        return self._group[name].with_config({"write_empty_chunks": True})

    def _asked(self) -> dict[str, Any]:
        axes = [[a.name, a.low, a.high, a.count, a.log] for a in self.space.axes]
        return {
            "format": _FORMAT,
            "what": self.what,
            "design": self.text,
            "axes": axes,
            "how": str(self.space.how),
            "count": self.count,
            "seed": self.space.seed,
            "chunk": self.chunk,
            "version": self.version,
        }

    def __repr__(self):
        varied = ", ".join(self.space.names)
        return f"Study({self.what} of {self.count} designs over {varied}, in {self.folder})"


def opened(folder: str | os.PathLike[str]) -> Study:
    """The study that a folder holds.

    Raises:
        StudyError: it holds none, or one whose description is damaged.
    """
    need("studies")
    import zarr

    place = Path(folder)
    try:
        asked = dict(zarr.open_group(place, mode="r").attrs)["stepwell_study"]
        if asked["format"] != _FORMAT:
            problem = f"is of format {asked['format']}, and this version reads {_FORMAT}"
            raise StudyError(f"{place}: {problem}.")
        axes = tuple(Axis(*axis) for axis in asked["axes"])
        space = Space(axes, How(asked["how"]), asked["count"], asked["seed"])
        return Study(place, asked["what"], asked["design"], space, asked["chunk"], asked["version"])
    except StudyError:
        raise
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise StudyError(f"{place}: holds no study ({type(error).__name__}: {error}).") from None


def begun(study: Study) -> Study:
    """The study with its store: made where there is none, the same where it was begun before.

    Raises:
        StudyError: the folder holds another study, or the same by another version.
        OSError: it cannot be written.
    """
    need("studies")
    if not study.folder.exists():
        _make(study)
    there = opened(study.folder)
    if there.version != study.version:
        raise StudyError(
            f"{study.folder}: was begun by Stepwell {there.version}, and this is {study.version}: "
            f"numbers of two versions are not mixed. Go on with that version, or name another "
            f"folder."
        )
    if there.identity != study.identity:
        raise StudyError(
            f"{study.folder}: holds another study: {there!r}. Name another folder, or remove it."
        )
    return there


def _make(study: Study) -> None:
    """Write the description into a sibling, which then takes the name."""
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec

    if study.chunk < 1:
        raise InputError(f"chunk = {study.chunk}: must be 1 or more.")
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
        design = hashlib.sha256(study.text.encode()).hexdigest()
        group.attrs.update({"stepwell_study": study._asked(), "design_sha256": design})
        try:
            draft.rename(study.folder)
        except OSError:
            if not study.folder.exists():  # else somebody else was faster
                raise
        sync_folder(study.folder.parent)
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _holds(array: Any, chunk: int) -> bool:
    file = Path(array.store.root) / array.path / "c" / str(chunk)
    if not file.exists():
        return False
    try:
        array.get_block_selection(chunk)
    except (OSError, ValueError, RuntimeError):
        return False
    return True


def _sync(file: Path) -> None:
    """Have the disk hold a file before anybody counts on it."""
    with file.open("rb") as written:
        os.fsync(written.fileno())
    sync_folder(file.parent)
