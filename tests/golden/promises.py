"""What holds for everything that a command prints and writes, whatever it is about."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any

from stepwell.base import number

WIDE = 80
# A number with a point: counts and the digits of states are too many to mean one thing.
_NUMBER = re.compile(r"(?<![\w.>])[-+]?\d+\.\d+(?![\w.>])")


def too_wide(screen: str) -> list[str]:
    """Lines that are wider than a terminal; a single word, such as a path, may be longer."""
    # What is there to be copied is printed as it is.
    lines = screen.partition("For a design file")[0].split("\n")
    return [line for line in lines if len(line) > WIDE and " " in line.strip()]


def unknown_numbers(text: str, records: list[dict[str, Any]]) -> list[str]:
    """Numbers of a text that no record holds, neither as they are nor as percent or thousandths."""
    known = {
        abs(value * factor)
        for record in records
        for value in _numbers(record)
        for factor in (1.0, 100.0, 1e3)
    }
    # How far an anchor has been moved stands in JSON as a share of the whole way.
    known |= {
        one["fraction"] * record["distance_mm"]
        for record in records
        for one in record.get("way", ())
    }
    # Numbers of a design are printed as they were given, all others with four digits or fewer.
    printed = {number(value, digits) for value in known for digits in (2, 3, 4, 6)}
    printed |= {f"{value:.{digits}f}" for value in known for digits in (1, 2, 3)}
    found = _NUMBER.findall(text.replace("\N{MINUS SIGN}", "-"))
    return [one for one in found if one.lstrip("+-") not in printed]


def _numbers(value: Any) -> Iterator[float]:
    """Every number in a record, those in its sentences too."""
    if isinstance(value, dict):
        for part in value.values():
            yield from _numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from _numbers(part)
    elif isinstance(value, str):
        yield from map(float, _NUMBER.findall(value))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def page_faults(text: str) -> list[str]:
    """Why a page is not complete in itself, safe to open and readable without its pictures."""
    head = _Head()
    head.feed(text)
    faults = [f"loads {one[:60]}" for one in head.loaded if not one.startswith(("data:", "#"))]
    faults += [f"{one} without words" for one in head.wordless]
    needed = {"lang", "charset", "title", "policy"}
    return faults + [f"no {one}" for one in sorted(needed - head.there)]


class _Head(HTMLParser):
    def __init__(self):
        super().__init__()
        self.loaded: list[str] = []
        self.wordless: list[str] = []
        self.there: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.loaded += [given[key] or "" for key in ("src", "srcset", "data") if key in given]
        self.loaded += [given["href"] or ""] if tag == "link" and "href" in given else []
        if tag == "img" and not given.get("alt"):
            self.wordless.append("image")
        if tag == "iframe" and not (given.get("title") and given.get("sandbox")):
            self.wordless.append("frame")
        self.there |= {"lang"} if given.get("lang") else set()
        self.there |= {"charset"} if "charset" in given else set()
        self.there |= {"title"} if tag == "title" else set()
        if given.get("http-equiv") == "Content-Security-Policy":
            self.there |= {"policy"} if "default-src 'none'" in str(given["content"]) else set()
