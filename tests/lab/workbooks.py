"""Made-up workbooks with one sheet, made without a library: xlsx, ods and xls."""

import io
import struct
import zipfile
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Row = Sequence[float | str]

_XML = '<?xml version="1.0" encoding="UTF-8"?>'


def _rows(columns: Sequence[Array], names: Sequence[str]) -> list[Row]:
    return [list(names), *([float(x) for x in row] for row in zip(*columns, strict=True))]


def _zipped(parts: Mapping[str, str]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return file.getvalue()


def xlsx(columns: Sequence[Array], names: Sequence[str]) -> bytes:
    """An Office Open XML workbook."""

    def cell(value: float | str) -> str:
        if isinstance(value, str):
            return f'<c t="inlineStr"><is><t>{value}</t></is></c>'
        return f"<c><v>{value!r}</v></c>"

    body = "".join(f"<row>{''.join(map(cell, row))}</row>" for row in _rows(columns, names))
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="rels" '
        f'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Override '
        f'PartName="/xl/workbook.xml" ContentType="{kind}.sheet.main+xml"/><Override '
        f'PartName="/xl/worksheets/sheet1.xml" ContentType="{kind}.worksheet+xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="a" '
        f'Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="b" Type="{office}/worksheet" Target="worksheets/sheet1.xml"/>'
        "</Relationships>",
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>'
        '<sheet name="Test 1" sheetId="1" r:id="b"/></sheets></workbook>',
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{main}"><sheetData>{body}</sheetData>'
        "</worksheet>",
    }
    return _zipped({name: _XML + text for name, text in parts.items()})


def ods(columns: Sequence[Array], names: Sequence[str]) -> bytes:
    """An OpenDocument spreadsheet."""

    def cell(value: float | str) -> str:
        kind = 'string"' if isinstance(value, str) else f'float" office:value="{value!r}"'
        return (
            f'<table:table-cell office:value-type="{kind}><text:p>{value}</text:p>'
            "</table:table-cell>"
        )

    body = "".join(
        f"<table:table-row>{''.join(map(cell, row))}</table:table-row>"
        for row in _rows(columns, names)
    )
    spaces = " ".join(
        f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"'
        for name in ("office", "table", "text")
    )
    content = (
        f'<office:document-content {spaces} office:version="1.2"><office:body>'
        f'<office:spreadsheet><table:table table:name="Test 1">{body}</table:table>'
        "</office:spreadsheet></office:body></office:document-content>"
    )
    kind = "application/vnd.oasis.opendocument.spreadsheet"
    listed = (
        '<manifest:manifest xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0">'
        f'<manifest:file-entry manifest:full-path="/" manifest:media-type="{kind}"/>'
        "</manifest:manifest>"
    )
    return _zipped(
        {"mimetype": kind, "content.xml": _XML + content, "META-INF/manifest.xml": _XML + listed}
    )


# Records of a BIFF8 workbook (Excel 97 to 2003).
_BOF, _EOF, _SHEET, _LABEL, _NUMBER = 0x0809, 0x000A, 0x0085, 0x0204, 0x0203
# Sectors of a compound file, and numbers of sectors with a meaning.
_SECTOR, _FREE, _END, _TABLE = 512, 0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFFD


def xls(columns: Sequence[Array], names: Sequence[str]) -> bytes:
    """An Excel 97 workbook: BIFF8 records in a compound file."""
    records = [_record(_BOF, struct.pack("<HHHHII", 0x0600, 0x0010, 0, 0, 0, 0))]
    for i, row in enumerate(_rows(columns, names)):
        for j, value in enumerate(row):
            place = struct.pack("<HHH", i, j, 0)
            if isinstance(value, str):
                text = struct.pack("<HB", len(value), 1) + value.encode("utf-16-le")
                records.append(_record(_LABEL, place + text))
            else:
                records.append(_record(_NUMBER, place + struct.pack("<d", value)))
    sheet = b"".join([*records, _record(_EOF, b"")])
    name = "Test 1".encode("utf-16-le")
    begin = _record(_BOF, struct.pack("<HHHHII", 0x0600, 0x0005, 0, 0, 0, 0))
    end = _record(_EOF, b"")
    at = len(begin) + 4 + 8 + len(name) + len(end)
    listed = _record(_SHEET, struct.pack("<IBBBB", at, 0, 0, len(name) // 2, 1) + name)
    return _compound(b"".join([begin, listed, end, sheet]))


def _record(kind: int, data: bytes) -> bytes:
    return struct.pack("<HH", kind, len(data)) + data


def _compound(stream: bytes) -> bytes:
    """A compound file with the one stream "Workbook": allocation table, directory, stream."""
    # A shorter stream would be stored elsewhere.
    stream = stream.ljust(4096, b"\0")
    count = -(-len(stream) // _SECTOR)
    tables = -(-(count + 2) // (_SECTOR // 4 - 1)) + 1
    first = tables + 1
    chain = [_TABLE] * tables + [_END] + [*range(first + 1, first + count), _END]
    table = struct.pack(f"<{len(chain)}I", *chain).ljust(tables * _SECTOR, b"\xff")
    places = [*range(tables), *[_FREE] * (109 - tables)]
    head = struct.pack(
        "<8s16xHHHHH6xIIIIIIIII",
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        *(0x3E, 3, 0xFFFE, 9, 6),
        *(0, tables, tables, 0, 4096, _END, 0, _END, 0),
    ) + struct.pack("<109I", *places)
    entries = [
        _entry("Root Entry", 5, child=1, start=_END),
        _entry("Workbook", 2, start=first, size=len(stream)),
        *[bytes(128)] * 2,
    ]
    return head + table + b"".join(entries) + stream.ljust(count * _SECTOR, b"\0")


def _entry(name: str, kind: int, child: int = _FREE, start: int = 0, size: int = 0) -> bytes:
    text = name.encode("utf-16-le") + b"\0\0"
    links: Iterable[int] = (_FREE, _FREE, child)
    return struct.pack(
        "<64sHBB3I36xIQ", text.ljust(64, b"\0"), len(text), kind, 1, *links, start, size
    )
