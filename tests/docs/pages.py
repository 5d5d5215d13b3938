"""Running a page: its examples in order, and the numbers in its sentences beside them.

Blocks marked python run one after the other in one namespace; lines `#> ` in a block are what it
prints, and `#> ...` stands for any lines. A block with a title becomes the file of that name.
A number in a sentence is checked where a comment follows it: `37.2 mm<!-- = snap.stroke * 1e3 -->`.
"""

import contextlib
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]

_STEP = re.compile(
    r'^```(?P<language>\w+)(?: title="(?P<title>[^"]+)")?\n(?P<body>.*?)^```$'
    r"|(?P<number>[-−+]?\d+(?:\.\d+)?)[^\d<]*<!-- = (?P<wanted>.+?) -->",
    re.M | re.S,
)
_CODE = re.compile(r"^```.*?^```$|^ {4}.*?$|`[^`\n]*`|\]\([^)]*\)|<https?:[^>]*>", re.M | re.S)
_DECIMAL = re.compile(r"<!--.*?-->|(?<![\w.])\d+\.\d+(?![\w.]*\d)", re.S)


class Step(NamedTuple):
    """A block to run or to write, or a number to check, and the line where it stands."""

    line: int
    language: str
    title: str
    body: str
    number: str


def steps(text: str) -> Iterator[Step]:
    """What there is to do on a page, in order."""
    for found in _STEP.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        if found["language"]:
            yield Step(line, found["language"], found["title"] or "", found["body"], "")
        else:
            yield Step(line, "number", "", found["wanted"], found["number"].replace("−", "-"))


def run(name: str, text: str) -> int:
    """Run a page in the current folder; how many things were run or checked."""
    names: dict[str, Any] = {}
    done = 0
    for step in steps(text):
        where = f"{name}, line {step.line}"
        if step.title:
            file = Path(step.title)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(step.body, "utf-8")
        if step.language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(step.body, where, "exec"), names)
            shown = re.findall(r"^#> ?(.*)$", step.body, re.M)
            assert shows(shown, printed.getvalue().splitlines()), f"{where}\n{printed.getvalue()}"
        elif step.language == "number":
            value = float(eval(step.body, names))
            digits = len(step.number.partition(".")[2])
            assert f"{value:.{digits}f}" == step.number.lstrip("+"), f"{where}: {value!r}"
        else:
            continue
        done += 1
    return done


def shows(shown: list[str], printed: list[str]) -> bool:
    """Whether the lines on the page are the printed ones."""
    parts = "\n".join([*shown, ""]).split("...\n")
    pattern = "(?:.*\n)*".join(re.escape(part) for part in parts)
    # A figure saved or a value set prints nothing, and then nothing need be shown.
    return (
        re.fullmatch(pattern if shown else "", "".join(f"{line}\n" for line in printed)) is not None
    )


def unchecked(text: str) -> list[str]:
    """Decimal numbers in the sentences of a page that no comment checks."""
    prose = _CODE.sub("", text)
    checked = {found.end("number") for found in _STEP.finditer(prose) if found["number"]}
    found = (match for match in _DECIMAL.finditer(prose) if not match[0].startswith("<!--"))
    return [match[0] for match in found if match.end() not in checked]
