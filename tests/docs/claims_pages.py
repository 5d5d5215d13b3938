"""`python tests/docs/claims_pages.py claims.json PAGE.md …`: compute the claims and write them."""

import json
import sys
from pathlib import Path

from stepwell.accounts import account
from stepwell.base import write_atomic
from stepwell.paper import Verdicts, run, validate
from stepwell.paper.claims import markdown, replaced
from stepwell.paper.measured import IDS
from stepwell.paper.steering import MANY_RUNS

USAGE = """usage:
python tests/docs/claims_pages.py [--data PATH | --all | --others] FILE.json [PAGE.md ...]

Without an option all claims are written but those that take many simulated runs; those that
recordings decide say that they need data. With the recordings only those are written, with --all
only those of many runs, and with --others those of other papers."""


def main(given: list[str]) -> None:
    """Write the claims into a JSON file, and their table between the markers of each page."""
    data, many, theirs = None, given[:1] == ["--all"], given[:1] == ["--others"]
    if many or theirs:
        given = given[1:]
    if given[:1] == ["--data"] and len(given) > 1:
        data, given = given[1], given[2:]
    if not given or given[0].startswith("-"):
        raise SystemExit(USAGE)
    target, *pages = map(Path, given)
    texts = [page.read_text("utf-8") for page in pages]
    if theirs:
        verdicts = validate()
    else:
        verdicts = Verdicts(claim.judge() for claim in MANY_RUNS) if many else run(data=data)
    if data is not None:
        verdicts = Verdicts(verdict for verdict in verdicts if verdict.claim.id in IDS)
    table = markdown(verdicts)
    written = [replaced(text, table) for text in texts]
    write_atomic(target, json.dumps(account(verdicts).record, indent=2) + "\n")
    for page, text in zip(pages, written, strict=True):
        write_atomic(page, text)


if __name__ == "__main__":
    main(sys.argv[1:])
