"""Results made small enough to be frozen: numbers with the digits that are compared, no prose.

A sentence becomes its numbers with their units, so that it may be worded better without a new
frozen file; a long list becomes its ends, its extremes, its sum and some of its parts.
"""

import csv
import io
import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, ClassVar
from xml.etree import ElementTree

import numpy as np
import xarray as xr
from PIL import Image

from stepwell import __version__

# Lists up to this long are kept in full; of longer ones so many parts.
SHORT, SOME = 8, 5
WIDTH = 200
# Before each name of a column of a table in JSON.
_COLUMN = "|"
# These change by themselves, or are the same in every record.
_DROPPED = {"stepwell", "versions", "mujoco"}
_HASH = re.compile(r"\b[0-9a-f]{64}\b")
# Between spaces, so that names of columns and of files are one.
_WORD = re.compile(r"(?<!\S)\S*[^\W\d_]{2,}\S*")
_MEASURE = re.compile(
    r"(?<![\w.])[-+−±]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
    r"(?:\s?(?:%|°|k r²?|mN m|N/m|kPa|mL|mm|mJ|ms|mN|N|J|s|g)(?![\w²]))?"
)


def reduced(value: Any, digits: int, *, totals: bool = False) -> Any:
    """A record as it is frozen: floats of so many digits, prose and long lists made short.

    With `totals`, a list of records becomes the sums of its columns of numbers.
    """
    if isinstance(value, Mapping):
        return {
            name: reduced(part, digits, totals=totals)
            for name, part in value.items()
            if name not in _DROPPED and not name.endswith("sha256")
        }
    if isinstance(value, list):
        return _list(value, digits, totals)
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    return brief(lasting(value)) if isinstance(value, str) else value


def brief(text: str) -> str:
    """A sentence of four words or more as its numbers with their units; other text as it is.

    What stands before a colon, such as a verdict before its reason, is kept where it is short.
    """
    if len(_WORD.findall(text)) < 4:
        return text
    head, colon, rest = text.partition(": ")
    if not colon or len(_WORD.findall(head)) >= 4:
        head, rest = "", text
    return " ".join([f"{head}:" * bool(head) + "¶", *_MEASURE.findall(rest)])


def _list(values: list[Any], digits: int, totals: bool) -> Any:
    if len(values) > SHORT and all(_is_number(one) for one in values):
        return numbers(values, digits)
    if totals and len(values) > 1 and all(isinstance(one, Mapping) for one in values):
        return {"items": len(values)} | reduced(_sums(values), digits)
    flat = not any(isinstance(one, Mapping | list) for one in values)
    if len(values) <= (3 * SHORT if flat else SHORT):
        return [reduced(one, digits, totals=totals) for one in values]
    return {"items": len(values)} | {
        str(k): reduced(values[k], digits, totals=totals) for k in some(len(values), SOME)
    }


def _sums(records: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """The sum of the absolute numbers in each column, in those that have any."""
    columns: dict[str, list[float]] = {}
    for record in records:
        for name, part in record.items():
            columns.setdefault(name, []).extend(_numbers_in(part))
    return {name: math.fsum(found) for name, found in columns.items() if found}


def _numbers_in(value: Any) -> Iterator[float]:
    if isinstance(value, Mapping | list):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from _numbers_in(part)
    elif value is not None and _is_number(value) and math.isfinite(value):
        yield abs(value)


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def numbers(values: Sequence[Any], digits: int) -> dict[str, Any]:
    """Many numbers as how many there are, how many are missing, least, most, sum and some."""
    found = [float(one) for one in values if one is not None and math.isfinite(one)]
    brief = {"numbers": len(values)}
    if len(found) < len(values):
        brief["missing"] = len(values) - len(found)
    if not found:
        return brief
    ends = {"least": min(found), "most": max(found), "sum": math.fsum(found)}
    return brief | reduced(ends | {"some": [values[k] for k in some(len(values), 3)]}, digits)


def some(count: int, most: int) -> list[int]:
    """Some of the first `count` places, both ends among them."""
    return sorted({round(k * (count - 1) / max(1, most - 1)) for k in range(min(count, most))})


def lasting(text: str) -> str:
    """Text without what changes by itself."""
    text = _HASH.sub("<sha256>", text)
    return re.sub(rf"(?i)(stepwell[ /]){re.escape(__version__)}", r"\1<version>", text)


def laid_out(value: Any) -> str:
    """JSON with short things on one line, as many a line as fit, and records as tables.

    A list of records with the same keys is written as the keys and the values of each record.
    """
    return "\n".join(_lines(_tabled(value), "", "")) + "\n"


def read(text: str) -> Any:
    """What was laid out."""
    return _untabled(json.loads(text))


def _tabled(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _tabled(part) for name, part in value.items()}
    if not isinstance(value, list):
        return value
    keys = list(value[0]) if value and isinstance(value[0], Mapping) else []
    if len(value) > 1 and keys and all(isinstance(x, Mapping) and [*x] == keys for x in value):
        rows = [[_tabled(part) for part in one.values()] for one in value]
        return [_COLUMN + _COLUMN.join(keys), *rows]
    return [_tabled(one) for one in value]


def _untabled(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _untabled(part) for name, part in value.items()}
    if not isinstance(value, list):
        return value
    if value and isinstance(value[0], str) and value[0].startswith(_COLUMN):
        keys = value[0].removeprefix(_COLUMN).split(_COLUMN)
        return [
            {key: _untabled(part) for key, part in zip(keys, row, strict=True)} for row in value[1:]
        ]
    return [_untabled(one) for one in value]


def _lines(value: Any, head: str, indent: str) -> Iterator[str]:
    text = head + json.dumps(value, ensure_ascii=False)
    if len(indent) + len(text) <= WIDTH or not isinstance(value, dict | list):
        yield indent + text
        return
    named = isinstance(value, dict)
    parts = value.items() if named else ((None, one) for one in value)
    opening, closing = "{}" if named else "[]"
    yield f"{indent}{head}{opening}"
    line = ""
    for k, (name, part) in enumerate(parts, 1):
        end = "," if k < len(value) else ""
        inner = list(_lines(part, f"{json.dumps(name)}: " if named else "", indent + " "))
        inner[-1] += end
        if len(inner) == 1 and line and len(line) + len(inner[0].strip()) < WIDTH:
            line += f" {inner[0].strip()}"
            continue
        if line:
            yield line
        *whole, line = inner
        yield from whole
        if whole:
            # What stands on several lines is followed by nothing on its last one.
            yield line
            line = ""
    if line:
        yield line
    yield f"{indent}{closing}"


def file_reduced(file: Path, digits: int, *, words: bool) -> Any:
    """What is frozen of a written file besides its name; None where the name is enough.

    Args:
        words: the words of a figure too.
    """
    if file.suffix == ".svg":
        return _svg(file) if words else None
    how = _FILES.get(file.suffix)
    return None if how is None else how(file, digits)


def _csv(file: Path, digits: int) -> dict[str, Any]:
    text = file.read_bytes().decode("utf-8")
    head, *body = csv.reader(io.StringIO(text, newline=""))
    found = {"columns": ",".join(head), "rows": len(body), "ends": "CRLF" * ("\r\n" in text)}
    if body:
        found["first"], found["last"] = ([_cell(one) for one in body[k]] for k in (0, -1))
    return {name: reduced(part, digits) for name, part in found.items()}


def _cell(text: str) -> Any:
    try:
        return float(text) if "." in text or "e" in text else int(text)
    except ValueError:
        return text


def _netcdf(file: Path, digits: int) -> dict[str, Any]:
    with xr.open_dataset(file, engine="scipy", decode_times=False) as data:
        return {
            "sizes": {str(name): size for name, size in data.sizes.items()},
            "variables": {
                str(name): _variable(one, digits) for name, one in data.variables.items()
            },
        }


def _variable(one: xr.Variable, digits: int) -> Any:
    """The unit and the extremes of a variable in one line."""
    kind = [one.attrs.get("units", ""), *map(str, one.dims)]
    if one.dtype.kind not in "fiu" or not one.size:
        return kind
    values = np.asarray(one.values, float).ravel()
    finite = values[np.isfinite(values)]
    ends = [float(finite.min()), float(finite.max())] if len(finite) else []
    return [*kind, *reduced(ends, digits)]


def _picture(file: Path, digits: int) -> str:
    with Image.open(file) as image:
        frames = getattr(image, "n_frames", 1)
        return f"{image.width} x {image.height}" + f", {frames} frames" * (frames > 1)


def _svg(file: Path) -> str:
    root = ElementTree.fromstring(file.read_text("utf-8"))
    words = [str(node.text) for node in root.iter() if node.tag.endswith("text")]
    # Numbers at ticks are where the data is, which others look at.
    names = dict.fromkeys(word for word in words if _WORD.search(word) or "[" in word)
    return f"{root.get('width')} x {root.get('height')}: " + " | ".join(names)


def _toml(file: Path, digits: int) -> Any:
    return reduced(tomllib.loads(file.read_text("utf-8")), digits)


def _xml(file: Path, digits: int) -> dict[str, int]:
    """How many there are of each tag."""
    tags = [node.tag.rpartition("}")[2] for node in ElementTree.parse(file).iter()]
    return {tag: tags.count(tag) for tag in dict.fromkeys(tags)}


def _text(file: Path, digits: int) -> str:
    lines = file.read_text("utf-8").splitlines()
    return f"{len(lines)} lines, the first {lines[0]!r}" if lines else "no lines"


_FILES = {
    ".csv": _csv,
    ".nc": _netcdf,
    ".gif": _picture,
    ".png": _picture,
    ".toml": _toml,
    ".xml": _xml,
    ".dot": _text,
    ".graphml": _xml,
}


def page(file: Path) -> list[str]:
    """The text of a page as a person reads it: a row of a table on a line, images by name."""
    reader = _Page()
    reader.feed(file.read_text("utf-8"))
    return [line for line in reader.lines if line]


class _Page(HTMLParser):
    """Words of one paragraph, or of one row of a table, on one line."""

    _HEADS: ClassVar = {"h1": "# ", "h2": "## ", "h3": "### ", "li": "- ", "summary": "> "}
    _WITHIN: ClassVar = {
        "td",
        "th",
        "dd",
        "strong",
        "em",
        "code",
        "a",
        "b",
        "i",
        "span",
        "sub",
        "sup",
    }

    def __init__(self):
        super().__init__()
        self.lines: list[str] = []
        self.quiet = 0
        self.row = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.quiet += tag in ("script", "style")
        if tag == "tr":
            self.row = True
        if tag == "img":
            self.lines.append(f"[{dict(attrs).get('alt')}]")
        elif tag == "dd":
            while not self.lines[-1]:
                self.lines.pop()
            self.lines[-1] += ": "
        elif self.row and tag in ("td", "th"):
            self.lines[-1] += " | "
        elif tag not in self._WITHIN:
            self.lines.append(self._HEADS.get(tag, ""))

    def handle_endtag(self, tag: str) -> None:
        self.quiet -= tag in ("script", "style")
        self.row &= tag != "tr"
        if tag not in self._WITHIN:
            self.lines.append("")

    def handle_data(self, data: str) -> None:
        text = lasting(" ".join(data.split()))
        if text and not self.quiet:
            before = self.lines[-1]
            self.lines[-1] += f" {text}" if before and not before.endswith(" ") else text
