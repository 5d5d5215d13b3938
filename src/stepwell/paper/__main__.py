"""`python -m stepwell.paper claims.json PAGE.md …`: compute the claims and write them down."""

import json
import sys
from pathlib import Path

from stepwell.files import write_atomic
from stepwell.paper.run import record, run
from stepwell.paper.table import markdown, replaced


def main(files: list[str]) -> None:
    """Write the claims into a JSON file, and their table between the markers of each page."""
    if not files:
        raise SystemExit("usage: python -m stepwell.paper claims.json [PAGE.md ...]")
    target, *pages = map(Path, files)
    texts = [page.read_text("utf-8") for page in pages]
    verdicts = run()
    table = markdown(verdicts)
    written = [replaced(text, table) for text in texts]
    write_atomic(target, json.dumps(record(verdicts), indent=2) + "\n")
    for page, text in zip(pages, written, strict=True):
        write_atomic(page, text)


if __name__ == "__main__":
    main(sys.argv[1:])
