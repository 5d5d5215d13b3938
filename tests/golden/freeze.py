"""Freeze what commands show and write now: `python tests/golden/freeze.py [CASE…]`.

A CASE is a name under frozen/ or the beginning of one, such as run/; without any, all are frozen
anew, and what belongs to no case is removed. The published JSON Schemas are widened by what the
cases print as JSON; they are never narrowed but by a new version in a record's `schema`.
"""

import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

# What stands beside this file is run, whatever else is installed.
_ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(_ROOT / "src"), str(_ROOT / "tests")]


def publish(record: dict[str, Any]) -> None:
    """Widen the published JSON Schema by a record that it does not allow yet."""
    from stepwell.results.json_schema import kind_of, schema_of, widened

    kind = kind_of(record)
    name = f"{kind}.json"
    places = [_ROOT / "src/stepwell/results/schemas" / name, _ROOT / "docs/schema" / name]
    old = schema_of(kind) if places[0].exists() else None
    new = widened(old, record)
    if new != old:
        print(f"published {name}")
        for place in places:
            place.write_text(json.dumps(new, indent=2) + "\n", "utf-8")


def main(wanted: list[str]) -> None:
    from golden.cases import CASES
    from golden.running import FROZEN, told
    from stepwell.cli.doctor import examined

    records: list[dict[str, Any]] = []
    names = [name for name in CASES if not wanted or name.startswith(tuple(wanted))]
    for name in names:
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            text = told(CASES[name], Path(folder), records)
        file = FROZEN / f"{name}.txt"
        news = "" if file.exists() and file.read_text("utf-8") == text else "  changed"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
        print(f"{time.perf_counter() - began:6.2f} s  {name}{news}", flush=True)
    if not wanted:
        records.append(examined() | {"files": []})
    for record in records:
        publish(record)
    if not wanted:
        for file in FROZEN.rglob("*.txt"):
            if file.relative_to(FROZEN).with_suffix("").as_posix() not in CASES:
                file.unlink()
                print(f"removed   {file.name}")
    if not names:
        sys.exit(f"no case begins with {', '.join(wanted)}; there are {', '.join(CASES)}")


if __name__ == "__main__":
    main(sys.argv[1:])
