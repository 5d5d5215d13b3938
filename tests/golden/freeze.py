"""Freeze what commands show and write now: `python tests/golden/freeze.py [CASE…]`.

A CASE is a name under frozen/ or the beginning of one, such as run/; without any, all are frozen
anew, and what belongs to no case is removed.
"""

import sys
import tempfile
import time
from pathlib import Path

# What stands beside this file is run, whatever else is installed.
_ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(_ROOT / "src"), str(_ROOT / "tests")]


def main(wanted: list[str]) -> None:
    from golden.cases import CASES
    from golden.running import FROZEN, told

    names = [name for name in CASES if not wanted or name.startswith(tuple(wanted))]
    for name in names:
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            text = told(CASES[name], Path(folder))
        file = FROZEN / f"{name}.txt"
        news = "" if file.exists() and file.read_text("utf-8") == text else "  changed"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
        print(f"{time.perf_counter() - began:6.2f} s  {name}{news}", flush=True)
    if not wanted:
        for file in FROZEN.rglob("*.txt"):
            if file.relative_to(FROZEN).with_suffix("").as_posix() not in CASES:
                file.unlink()
                print(f"removed   {file.name}")
    if not names:
        sys.exit(f"no case begins with {', '.join(wanted)}; there are {', '.join(CASES)}")


if __name__ == "__main__":
    main(sys.argv[1:])
