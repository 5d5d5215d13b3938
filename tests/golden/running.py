"""A case run in this process, and what it printed and wrote as two things that are frozen.

A record goes into one JSON file for each kind of case, what people read into a text of its own.
"""

import json
import re
import shlex
from collections.abc import Iterator
from contextlib import chdir, contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import typer
from typer.testing import CliRunner, Result

from golden import reducing
from golden.cases import Case
from golden.sketching import filmed_blank, sketched
from sizes import SIZE
from stepwell.cli import app
from stepwell.paper import Claim, ClaimVerdict, Judgement

FROZEN = Path(__file__).parent / "frozen"
_DOCS = Path(__file__).resolve().parents[2] / "docs"
# A second each or more: their verdicts are taken from the page that other tests hold against them.
_SLOW_CLAIMS = frozenset({
    "sequential", "undirected-boundary", "order-two-cells", "order-many-cells", "robot-forward",
    "robot-backward", "robot-turn", "robot-15-on-the-floor", "antennas-paper-numbers",
    "antennas-turn-away", "more-cells-sequenced", "more-cells-programmable", "directed-snaps",
    "robot-15-in-the-air", "robot-states", "antennas-bench-20", "antennas-bench-14",
})  # fmt: skip
# On a slow or busy machine.
_PASSING = re.compile(r"stepwell: compiling \w+, once|[\w ]+: +\d+%(, about .* left)?$")
_USAGE = re.compile(r"Usage: stepwell[^\n]*\nTry 'stepwell[^\n]*' for help\.\n\n")
_commands = cache(typer.main.get_command)
# No colours, and always the same width.
_TERMINAL = {"COLUMNS": "80", "NO_COLOR": "1", "TERM": "dumb"}


@dataclass
class Outcome:
    """What a case printed and wrote.

    Attributes:
        entries: for each command what is frozen as JSON.
        text: the screens and pages of a case that shows them.
        screens: what was printed for people, by command.
        pages: the HTML of every page, by its name.
        words: the text of every page, by its name.
        records: every result in JSON, whole.
        folders: the manifest of every folder that was written, and the files in it.
    """

    entries: list[dict[str, Any]] = field(default_factory=list)
    text: str = ""
    screens: dict[str, str] = field(default_factory=dict)
    pages: dict[str, str] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    records: list[dict[str, Any]] = field(default_factory=list)
    folders: list[tuple[dict[str, Any], set[str]]] = field(default_factory=list)


def outcome(case: Case, folder: Path) -> Outcome:
    """Run a case in an empty folder."""
    for name, text in case.given.items():
        (folder / name).write_text(text, "utf-8")
    case.prepare(folder)
    found, seen, lines = Outcome(), _files(folder), []
    filmed = nullcontext() if SIZE == "full" else filmed_blank()
    with chdir(folder), sketched(words=case.shown), filmed, _quick_claims():
        for command in case.commands:
            result = invoke(*shlex.split(command))
            now = _files(folder)
            new = sorted(name for name in now if now[name] != seen.get(name))
            gone = sorted(seen.keys() - now.keys())
            found.entries.append(_entry(command, result, new, folder, case, found))
            if gone:
                found.entries[-1]["gone"] = gone
            if case.shown and not _is_json(command):
                lines += [f"$ stepwell {command}".rstrip(), *_read(result, new, folder), ""]
            seen = now
    found.text = "\n".join(lines).replace(str(folder), "<folder>")
    return found


def shown_in(case: Case) -> Path:
    """The file with the screens and pages of a case."""
    return FROZEN / f"{case.name.replace('/', '-')}.txt"


def entries_of(kind: str) -> dict[str, Any]:
    """Everything of a kind that is frozen as JSON, by case."""
    file = FROZEN / f"{kind}.json"
    return reducing.read(file.read_text("utf-8")) if file.exists() else {}


def frozen(case: Case) -> tuple[Any, str]:
    """What is frozen of a case: its commands, and the text that it shows."""
    file = shown_in(case)
    text = file.read_text("utf-8") if case.shown and file.exists() else ""
    return entries_of(case.kind).get(case.name), text


def save(case: Case, found: Outcome) -> None:
    """Freeze a case."""
    write(case.kind, entries_of(case.kind) | {case.name: found.entries})
    if case.shown:
        shown_in(case).write_text(found.text, "utf-8")


def write(kind: str, entries: dict[str, Any]) -> None:
    """Write the JSON file of a kind."""
    FROZEN.mkdir(exist_ok=True)
    (FROZEN / f"{kind}.json").write_text(reducing.laid_out(entries), "utf-8")


def _entry(
    command: str, result: Result, new: list[str], folder: Path, case: Case, found: Outcome
) -> dict[str, Any]:
    """What is frozen of one command as JSON; `found` gets what is there of it in full."""
    entry: dict[str, Any] = {"command": command}
    if result.exit_code:
        entry["exit"] = result.exit_code
    said = "\n".join(x for x in result.stderr.split("\n") if not _PASSING.match(x)).strip()
    if said:
        said = reducing.lasting(_USAGE.sub("", said)).replace(str(folder), "<folder>")
        entry["error"] = said.split("\n") if "\n" in said else said
    record = None
    if result.stdout and _is_json(command):
        # Nothing else is printed.
        record = json.loads(result.stdout)
    elif result.stdout:
        found.screens[command] = result.stdout
    files: dict[str, Any] = {}
    for name in new:
        if not name.endswith(".json"):
            files[name] = reducing.file_reduced(folder / name, case.within.digits, words=case.shown)
            if name.endswith(".html"):
                found.pages[name] = (folder / name).read_text("utf-8")
                found.words[name] = "\n".join(reducing.page(folder / name))
            continue
        written = json.loads((folder / name).read_text("utf-8"))
        if str(written.get("schema")).startswith("stepwell."):
            found.records.append(written)
        if str(written.get("schema")).startswith("stepwell.folder/"):
            inside = (folder / name).parent
            found.folders.append(
                (
                    written,
                    {
                        one.relative_to(inside).as_posix()
                        for one in inside.rglob("*")
                        if one.is_file()
                    },
                )
            )
        elif record is None:
            record = written
        elif written != {key: part for key, part in record.items() if key != "files"}:
            files[name] = reducing.reduced(written, case.within.digits)
            continue
        files[name] = None
    if files:
        entry["files"] = files if any(files.values()) else list(files)
    if record is not None:
        if "schema" in record:
            found.records.append(record)
        short = reducing.reduced(record, case.within.digits, totals=case.spare)
        kept = {key: part for key, part in short.items() if key != "files"}
        same = [one["command"] for one in found.entries if one.get("record") == kept]
        entry["record"] = f"the same as of: {same[0]}" if same else kept
    return entry


def _is_json(command: str) -> bool:
    return "--json" in command.split() or command.startswith("schema ")


def _read(result: Result, new: list[str], folder: Path) -> Iterator[str]:
    yield from (line.rstrip() for line in reducing.lasting(result.stdout).rstrip().split("\n"))
    for name in new:
        if name.endswith(".html"):
            yield f"--- {name}"
            yield from reducing.page(folder / name)


def invoke(*arguments: str) -> Result:
    """Run a command the way a user does, in this process."""
    # The commands are put together only once, which takes as long as many of them run.
    with patch("typer.testing._get_command", _commands):
        result = CliRunner().invoke(app, arguments, prog_name="stepwell", env=_TERMINAL)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


@contextmanager
def _quick_claims() -> Iterator[None]:
    """Claims of the paper that take seconds, and those of others, are not computed again."""
    of_paper, of_others = (
        {one["id"]: one for one in json.loads((_DOCS / name).read_text("utf-8"))["claims"]}
        for name in ("claims.json", "others.json")
    )
    committed = of_others | {name: of_paper[name] for name in _SLOW_CLAIMS}
    judge = Claim.judge

    def quick(claim: Claim) -> ClaimVerdict:
        if claim.id not in committed:
            return judge(claim)
        one = committed[claim.id]
        return ClaimVerdict(claim, one["ours"], Judgement(one["verdict"]), one["reason"])

    with patch.object(Claim, "judge", quick):
        yield


def _files(folder: Path) -> dict[str, bytes]:
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and not _of_a_store(file.relative_to(folder))
    }


def _of_a_store(name: Path) -> bool:
    """Whether it is a file of a study; what it holds is shown by the commands."""
    return any(part.endswith(".zarr") for part in name.parts)
