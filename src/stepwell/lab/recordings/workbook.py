"""Rows of fields in a sheet of a workbook: xlsx, xls, ods."""

import datetime
import io
import re
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from stepwell import base
from stepwell.base import Floats, InputError
from stepwell.lab.recordings.text import CHUNK

_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
# A workbook of zeros may unpack to a thousand times its size.
_MOST_UNPACKED = 1 << 30
_RATIO = 200
# The reader keeps every cell between the first and the last, about 30 bytes each.
_MOST_CELLS = 30 << 20
_WIDE = (
    (16384, rb'<c [^>]*?\br="[A-Z]{3}\d'),
    (702, rb'<c [^>]*?\br="[C-Z][A-Z]\d'),
    (78, rb'<c [^>]*?\br="[A-Z]{2}\d'),
)
# Cells of an ods sheet that hold a value and are repeated.
_REPEATED = (
    rb'<table:table-cell(?=[^>]*office:value)[^>]*columns-repeated="\d{4,}"'
    rb'|<table:table-row[^>]*rows-repeated="\d{5,}"[^>]*>(?:(?!</table:table-row>).){0,4096}'
    rb"office:value"
)


def is_workbook(content: bytes) -> bool:
    """Whether a file begins as an xlsx, ods or xls workbook does."""
    return content[:4] in (_ZIP, _OLE)


class Cells(NamedTuple):
    """Consecutive rows of a sheet."""

    cells: list[list[Any]]

    def rows(self) -> list[list[str]]:
        """Fields of every row."""
        return [[_text(cell) for cell in row] for row in self.cells]

    def numbers(self, width: int, places: Sequence[int]) -> Floats | None:
        """(n, len(places)) numbers in these of `width` columns; None if a row is irregular."""
        if {len(row) for row in self.cells} != {width}:
            return None
        some = [[row[k] for k in places] for row in self.cells]
        kinds = {type(cell) for row in some for cell in row}
        return np.array(some, float) if kinds <= {float, int} else None


def sheets(content: bytes, skip: int = 0) -> Iterator[tuple[str, Iterator[Cells]]]:
    """Name and rows of every sheet, without its first rows.

    Raises:
        ValueError: the workbook is broken or unpacks to more than 1 GiB.
        ExtraError: python-calamine is not installed.
    """
    if content[:4] == _ZIP:
        _refuse_bomb(content)
    base.need("tables")
    import python_calamine

    try:
        book = python_calamine.CalamineWorkbook.from_filelike(io.BytesIO(content))
        for name in book.sheet_names:
            rows = islice(book.get_sheet_by_name(name).iter_rows(), skip, None)
            yield name, map(Cells, iter(lambda rows=rows: list(islice(rows, CHUNK)), []))
    except InputError:
        raise
    except Exception as error:  # each format has errors of its own
        raise InputError(
            f"is no workbook that can be read ({type(error).__name__}): export it again as CSV."
        ) from None


def _refuse_bomb(content: bytes) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(one.file_size for one in archive.infolist())
            if size > min(_MOST_UNPACKED, max(_RATIO * len(content), 1 << 24)):
                raise InputError(
                    f"unpacks to {size >> 20} MiB, {size // max(len(content), 1)} times its size: "
                    f"export it again as CSV."
                )
            for name in archive.namelist():
                if name == "content.xml" or re.fullmatch(r"xl/worksheets/[^/]+\.xml", name):
                    _refuse_wide(archive.read(name))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, zlib.error):
        raise InputError("is a broken workbook or archive: export it again.") from None


def _refuse_wide(sheet: bytes) -> None:
    """Refuse a sheet whose reader would need memory for cells that the file does not have."""
    wide = next((most for most, one in _WIDE if re.search(one, sheet)), 26)
    tall = max(map(int, re.findall(rb'<(?:row|c) [^>]*?\br="[A-Z]*(\d{1,9})"', sheet)), default=0)
    if wide * tall > _MOST_CELLS or re.search(_REPEATED, sheet):
        raise InputError(
            f"has a sheet of up to {tall} rows and {wide} columns: delete the cells beside the "
            f"table, or export it again as CSV."
        )


def _text(cell: Any) -> str:
    if isinstance(cell, bool):
        return str(cell)
    if isinstance(cell, float | int):
        return repr(cell)
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    return str(cell)
