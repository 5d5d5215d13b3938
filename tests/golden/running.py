"""A case run in this process, and everything that it shows and writes as one text."""

import json
import re
import shlex
from collections.abc import Iterable, Iterator
from contextlib import chdir, contextmanager
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import typer
from typer.testing import CliRunner, Result

from golden import telling
from golden.cases import Case
from golden.sketching import sketched
from stepwell.cli import app
from stepwell.paper import Claim, Judgement, Verdict

FROZEN = Path(__file__).parent / "frozen"
_CLAIMS = Path(__file__).resolve().parents[2] / "docs" / "claims.json"
# A second each or more: their verdicts are taken from the page that other tests hold against them.
_SLOW_CLAIMS = frozenset({
    "sequential", "undirected-boundary", "order-two-cells", "order-many-cells", "robot-forward",
    "robot-backward", "robot-turn", "robot-15-on-the-floor", "antennas-paper-numbers",
    "antennas-turn-away", "more-cells-sequenced", "more-cells-programmable", "directed-snaps",
    "robot-15-in-the-air", "robot-states", "antennas-bench-20", "antennas-bench-14",
})  # fmt: skip
_COMPILING = re.compile(r"stepwell: compiling \w+, once")
_commands = cache(typer.main.get_command)
# No colours, and always the same width.
_TERMINAL = {"COLUMNS": "80", "NO_COLOR": "1", "TERM": "dumb"}


def told(case: Case, folder: Path, records: list[dict[str, Any]] | None = None) -> str:
    """Run a case in an empty folder and tell what it showed and wrote.

    Args:
        case: what is run.
        folder: where; it is empty.
        records: gets every result that was printed or written as JSON.
    """
    for name, text in case.given.items():
        (folder / name).write_text(text, "utf-8")
    case.prepare(folder)
    seen = _files(folder)
    lines: list[str] = []
    with chdir(folder), sketched(words=case.words), _quick_claims():
        for command in case.commands:
            result = invoke(*shlex.split(command))
            lines += [f"$ stepwell {command}".rstrip(), *_shown(result, folder)]
            now = _files(folder)
            if records is not None:
                new = (now[name] for name in now if now[name] != seen.get(name))
                records += _records([result.stdout.encode(), *new])
            for name in sorted(seen.keys() - now.keys()):
                lines.append(f"--- {name} is gone")
            for name in sorted(name for name in now if now[name] != seen.get(name)):
                lines += [f"--- {name}", *telling.file_lines(folder / name)]
            seen = now
            lines.append("")
    return "\n".join(lines).replace(str(folder), "<folder>")


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
    """Claims of the paper that take seconds are not computed anew."""
    committed = {one["id"]: one for one in json.loads(_CLAIMS.read_text("utf-8"))["claims"]}
    judge = Claim.judge

    def quick(claim: Claim) -> Verdict:
        if claim.id not in _SLOW_CLAIMS:
            return judge(claim)
        one = committed[claim.id]
        return Verdict(claim, one["ours"], Judgement(one["verdict"]), one["reason"])

    with patch.object(Claim, "judge", quick):
        yield


def _shown(result: Result, folder: Path) -> Iterator[str]:
    if result.exit_code:
        yield f"--- exit code {result.exit_code}"
    if result.stdout:
        yield "--- shown"
        yield from _output(result.stdout, folder)
    # Whether a kernel is compiled meanwhile hangs on what ran before.
    said = [line for line in telling.text_lines(result.stderr) if not _COMPILING.match(line)]
    if any(said):
        yield "--- standard error"
        yield from said


def _output(text: str, folder: Path) -> list[str]:
    """Text as it is; JSON only where it is not what stands in a file too."""
    if not text.startswith("{"):
        return telling.text_lines(text)
    record = json.loads(text)
    for file in sorted(folder.glob("*/*.json")):
        written = json.loads(file.read_text("utf-8"))
        if written == {name: part for name, part in record.items() if name != "files"}:
            return [f"(JSON as in {file.relative_to(folder)}, and files: {record['files']})"]
    return telling.json_lines(text)


def _records(texts: Iterable[bytes]) -> Iterator[dict[str, Any]]:
    """Those that are results of ours as JSON."""
    for text in texts:
        if text.startswith(b"{") and b'"schema": "stepwell.' in text[:200]:
            yield json.loads(text)


def _files(folder: Path) -> dict[str, bytes]:
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and not _of_a_store(file.relative_to(folder))
    }


def _of_a_store(name: Path) -> bool:
    """Whether it is a file of a study; what it holds is shown by the commands."""
    return any(part.endswith(".zarr") for part in name.parts)
