"""Outputs told briefly: what a person can read in a diff, and nothing that changes by itself.

Text is kept as it is, long lists of numbers are summed up, images are only named. Versions, hashes
and places on the disk become words in angle brackets.
"""

import csv
import hashlib
import io
import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from PIL import Image

from stepwell import __version__
from stepwell.files import preset_text, presets

# Lists and tables up to this long are told in full; longer ones by so many of their rows.
SHORT, ROWS = 8, 5
_WIDTH = 110
_DIGITS = re.compile(r"[\d.e+-]{5,}")
_HASH = re.compile(r"\b[0-9a-f]{64}\b")


def file_lines(file: Path) -> list[str]:
    """What is in a file that a command wrote."""
    tell = _TELLERS.get(file.suffix, lambda place: text_lines(place.read_text("utf-8")))
    return tell(file)


def text_lines(text: str) -> list[str]:
    """Text as it is, but for what changes by itself; the text of a preset only by its name."""
    if text in (known := _presets()):
        return [f"(the text of preset:{known[text]})"]
    # The end of the last line is told too, by an empty line that is there or not.
    return [_lasting(line) for line in text.split("\n")]


@cache
def _presets() -> dict[str, str]:
    return {preset_text(name): name for name in presets()}


def json_lines(text: str) -> list[str]:
    """JSON with short lists on one line and long ones summed up."""
    record = json.loads(text)
    return [f"(JSON, {_layout(text, record)})", *_tree(record, "")]


def _layout(text: str, record: Any) -> str:
    for ascii_only, words in ((True, "escaped to ASCII"), (False, "not escaped")):
        if text == json.dumps(record, indent=2, ensure_ascii=ascii_only) + "\n":
            return f"indented by 2, {words}"
    return "laid out in its own way"


def _tree(value: Any, indent: str, key: str = "") -> Iterator[str]:
    head = f"{indent}{key}: " if key else indent
    if key == "versions" and isinstance(value, Mapping):
        value = dict.fromkeys(value, "<version>")
    elif key in ("stepwell", "mujoco") and isinstance(value, str):
        value = "<version>"
    line = head + _flat(value)
    scalar = not isinstance(value, Mapping | list)
    # Where lines break shall not hang on the digits of a number.
    width = len(_DIGITS.sub("12345678", line))
    if scalar or (width <= _WIDTH and not _is_deep(value)):
        yield line
    elif isinstance(value, Mapping) and all(_HASH.fullmatch(str(v)) for v in value.values()):
        yield f"{head}{{"
        yield from (f"{indent}{line}" for line in _wrapped([*value], ", "))
        yield f'{indent}}} each "<sha256>"'
    elif isinstance(value, Mapping):
        yield f"{head}{{"
        for name, part in value.items():
            yield from _tree(part, indent + "  ", json.dumps(name, ensure_ascii=False)[1:-1])
        yield f"{indent}}}"
    elif all(_is_number(part) for part in value):
        yield f"{head}{numbers(value)}" if len(value) > SHORT else line
    elif all(isinstance(part, list) and all(map(_is_number, part)) for part in value):
        yield f"{head}{len(value)} lists ["
        for k in _some(len(value)):
            yield f"{indent}  {k}: {numbers(value[k])}"
        yield f"{indent}]"
    else:
        yield f"{head}{len(value)} items ["
        most = SHORT if any(map(_is_deep, value)) else 3 * SHORT
        shown = range(len(value)) if len(value) <= most else _some(len(value))
        for k in shown:
            yield from _tree(value[k], indent + "  ", str(k))
        yield f"{indent}]"


def _is_deep(value: Any) -> bool:
    """Whether what is in a record or a list deserves lines of its own."""
    if not isinstance(value, Mapping | list):
        return False
    parts = value.values() if isinstance(value, Mapping) else value
    return any(isinstance(part, Mapping) and part for part in parts)


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _flat(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name}: {_flat(part)}" for name, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flat, value)) + "]"
    if isinstance(value, float):
        return number(value)
    return _lasting(json.dumps(value, ensure_ascii=False))


def number(value: float | None) -> str:
    """Twelve digits: three more than are compared."""
    if value is None or isinstance(value, int):
        return str(value)
    # A float keeps its point, so that it is not held to be a count.
    text = f"{value:.12g}"
    return text if not text.lstrip("-").isdigit() else f"{text}.0"


def numbers(values: Sequence[Any]) -> str:
    """A list of numbers: all, or how many, the ends, the extremes, the sum and some of them."""
    if len(values) <= SHORT:
        return "[" + ", ".join(map(number, values)) + "]"
    some = ", ".join(number(values[k]) for k in _some(len(values)))
    return f"[{extremes(values)}; some: {some}]"


def extremes(values: Sequence[Any]) -> str:
    """How many numbers there are, the extremes and the sum."""
    found = [value for value in values if value is not None and math.isfinite(value)]
    missing = len(values) - len(found)
    told = [f"{len(values)} numbers"]
    told += [f"{missing} missing or infinite"] if missing else []
    if found:
        least, most, total = min(found), max(found), math.fsum(found)
        told.append(f"least {number(least)}, most {number(most)}, sum {number(total)}")
    return "; ".join(told)


def _some(count: int) -> list[int]:
    """Some of the first `count` places, both ends among them."""
    return sorted({round(k * (count - 1) / max(1, ROWS - 1)) for k in range(min(count, ROWS))})


def _csv(file: Path) -> list[str]:
    text = file.read_bytes().decode("utf-8")
    ends = "CR LF" if "\r\n" in text else "LF"
    rows = list(csv.reader(io.StringIO(text, newline="")))
    lines = [f"(CSV, {len(rows)} lines that end in {ends})"]
    if len(rows) <= SHORT:
        return lines + [",".join(row) for row in rows]
    head, *body = rows
    lines += [",".join(head), *(",".join(body[k]) for k in _some(len(body)))]
    for k, name in enumerate(head):
        lines.append(f"  {name}: {_column([row[k] for row in body])}")
    return lines


def _column(texts: list[str]) -> str:
    try:
        return extremes([float(text) if text else None for text in texts])
    except ValueError:
        pass
    kinds = {text: texts.count(text) for text in dict.fromkeys(texts)}
    shown = [f"{text!r} {count}" for text, count in list(kinds.items())[:SHORT]]
    more = [f"and {len(kinds) - SHORT} more"] if len(kinds) > SHORT else []
    return "texts " + ", ".join(shown + more)


def _netcdf(file: Path) -> list[str]:
    with xr.open_dataset(file, engine="scipy", decode_times=False) as dataset:
        return dataset_lines(dataset)


def dataset_lines(dataset: xr.Dataset) -> list[str]:
    """Names, dimensions, attributes and some numbers of a dataset."""
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    lines = [f"(dataset: {sizes})", *_attributes(dataset.attrs, "")]
    for kind, variables in (("coordinate", dataset.coords), ("variable", dataset.data_vars)):
        for name, variable in variables.items():
            dims = ", ".join(map(str, variable.dims))
            lines.append(f"{kind} {name}({dims}) {variable.dtype.kind}: {_array(variable.values)}")
            lines += _attributes(variable.attrs, "    ")
    return lines


def _attributes(attrs: Mapping[Any, Any], indent: str) -> list[str]:
    told = []
    for name, value in attrs.items():
        if isinstance(value, np.ndarray | np.generic):
            text = _array(np.atleast_1d(value))
        else:
            text = _lasting(repr(value))
        if name in ("stepwell", "mujoco", "versions"):
            text = "<version>"
        told.append(f"{indent}@{name} = {text}")
    return told


def _array(values: np.ndarray) -> str:
    flat = values.ravel()
    if flat.dtype.kind in "fiu":
        return numbers(flat.tolist())
    return _column([_text(value) for value in flat.tolist()])


def _text(value: Any) -> str:
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def _picture(file: Path) -> list[str]:
    with Image.open(file) as image:
        width, height = image.size
        frames = getattr(image, "n_frames", 1)
    return [f"({width} x {height} pixels{f', {frames} frames' if frames > 1 else ''})"]


def _svg(file: Path) -> list[str]:
    root = ET.fromstring(file.read_text("utf-8"))
    size = f"(SVG, {root.get('width')} x {root.get('height')})"
    words = [str(node.text) for node in root.iter() if node.tag.endswith("text")]
    return [size, *_wrapped(words, " | ")]


def _wrapped(words: list[str], between: str) -> list[str]:
    """Words on lines that are not too long."""
    lines: list[str] = []
    for word in words:
        if lines and len(lines[-1]) + len(word) < _WIDTH:
            lines[-1] += between + word
        else:
            lines.append(f"  {word}")
    return lines


def _video(file: Path) -> list[str]:
    return ["(a video)"] if file.stat().st_size else ["(an empty file)"]


class _Page(HTMLParser):
    """Tags with their attributes and all text, a row of a table on a line; images only named."""

    _ALONE, _BESIDE = ("meta", "img", "br", "link", "hr", "source"), ("td", "th", "dd")

    def __init__(self):
        super().__init__()
        self.lines: list[str] = []
        self.open: list[str] = []
        # Whether the next text stands on the line of its tag.
        self.beside = False
        # Whether what follows comes from the sources of the studio's page.
        self.built = False

    def handle_decl(self, decl: str) -> None:
        self.lines.append(f"<!{decl}>")

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        # The heading of a number on a phone stands above its column too.
        kept = ((name, value) for name, value in attrs if name != "data-head")
        told = "".join(f' {name}="{_brief(name, value)}"' for name, value in kept)
        self._add(f"<{tag}{told}>", tag in self._BESIDE)
        self.beside = tag not in self._ALONE
        self.built = ("class", "built") in attrs
        if self.beside:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        self.open.pop()
        self.beside = self.built = False

    def handle_data(self, data: str) -> None:
        text = " ".join(data.split())
        if self.built or self.open[-1:] == ["script"]:
            text = "(built from studio/, or what that reads)"
        elif self.open[-1:] == ["style"]:
            text = f"({len(text)} letters, SHA-1 {hashlib.sha1(text.encode()).hexdigest()[:8]})"
        if text:
            self._add(_lasting(text), self.beside)

    def _add(self, text: str, beside: bool) -> None:
        if beside and self.lines:
            self.lines[-1] += f" {text}"
        else:
            self.lines.append(f"{' ' * len(self.open)}{text}")


def _brief(name: str, value: str | None) -> str:
    if name == "srcdoc":
        return "<page>"
    return "<image>" if value and value.startswith("data:") else _lasting(value or "")


def _html(file: Path) -> list[str]:
    page = _Page()
    page.feed(file.read_text("utf-8"))
    return page.lines


def _lasting(text: str) -> str:
    """A line without what changes by itself."""
    text = _HASH.sub("<sha256>", text)
    text = re.sub(r"sha256-[A-Za-z0-9+/]{43}=", "sha256-<of what was built>", text)
    return re.sub(rf"(?i)(stepwell[ /]){re.escape(__version__)}", r"\1<version>", text)


_TELLERS = {
    ".csv": _csv,
    ".html": _html,
    ".json": lambda file: json_lines(file.read_text("utf-8")),
    ".nc": _netcdf,
    ".gif": _picture,
    ".png": _picture,
    ".svg": _svg,
    ".mp4": _video,
}
