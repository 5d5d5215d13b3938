"""Freeze what commands print and write now: `python tests/golden/freeze.py [CASE…]`.

A CASE is a name in cases.py or the beginning of one, such as run/; without any, all cases are
frozen, and what belongs to no case is removed.
"""

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

# What stands beside this file is run, whatever else is installed.
_ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(_ROOT / "src"), str(_ROOT / "tests")]


def main(wanted: list[str]) -> None:
    from golden.cases import CASES
    from golden.options import options
    from golden.running import frozen, outcome, save, write

    names = [name for name in CASES if not wanted or name.startswith(tuple(wanted))]
    for name in names:
        began = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            found = outcome(CASES[name], Path(folder))
        before = frozen(CASES[name])
        save(CASES[name], found)
        news = "" if frozen(CASES[name]) == before else "  changed"
        print(f"{time.process_time() - began:6.2f} s of CPU  {name}{news}", flush=True)
    for name in () if wanted else leftovers():
        print(f"removed   {name}")
    if "options".startswith(tuple(wanted) or ""):
        write("options", options())
    elif not names:
        sys.exit(f"no case begins with {', '.join(wanted)}; there are {', '.join(CASES)}")


def leftovers() -> Iterator[str]:
    """Remove what belongs to no case, and name it."""
    from golden.cases import CASES
    from golden.running import FROZEN, entries_of, shown_in, write

    texts = {shown_in(case) for case in CASES.values() if case.shown}
    for file in FROZEN.glob("*.txt"):
        if file not in texts:
            file.unlink()
            yield file.name
    for file in {*FROZEN.glob("*.json")} - {FROZEN / "options.json"}:
        entries = entries_of(file.stem)
        kept = {name: entries[name] for name in CASES if name in entries}
        write(file.stem, kept)
        yield from entries.keys() - kept.keys()


if __name__ == "__main__":
    main(sys.argv[1:])
