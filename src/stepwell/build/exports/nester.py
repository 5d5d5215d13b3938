"""Nesting in a process of its own: reads outlines as JSON, writes places as JSON.

This file is run, too: the solver ends its process when it meets an outline that it does not like,
and it knows no interruption.

Input: `height` and `gap` [mm], `seconds`, `seed`, `shapes` (corners of each part, [mm]).
Output: `places`, of each part its x, y [mm] and angle [degrees], turned before it is shifted.
"""

import json
import subprocess
import sys
from collections.abc import Callable
from time import monotonic
from typing import Any

# Parts may be turned by these angles [degrees]; the fibres of wood and a kerf that differs in x and
# y allow no others.
TURNS = (0.0, 90.0, 180.0, 270.0)


# Time for the start of the process, added to twice its limit [s]; time between two reports [s].
_START, _EVERY = 10.0, 0.1


def places(asked: dict[str, Any], spent: Callable[[float], object]) -> list[list[float]] | None:
    """The places that the process finds; None if it ended with an error or took too long.

    Args:
        asked: the input, as above.
        spent: called with the time spent [s] while the process runs.
    """
    begun = monotonic()
    process = subprocess.Popen(
        # -P: modules beside this file are not to be found by their bare names.
        [sys.executable, "-P", __file__],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    answer = ""
    question: str | None = json.dumps(asked)
    try:
        while True:
            try:
                answer, _ = process.communicate(question, timeout=_EVERY)
                break
            except subprocess.TimeoutExpired:
                question = None
                spent(monotonic() - begun)
                if monotonic() - begun > 2.0 * asked["seconds"] + _START:
                    return None
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
    return json.loads(answer)["places"] if process.returncode == 0 else None


def main() -> None:
    """Nest the shapes of standard input; write their places to standard output."""
    import spyrrow

    asked = json.load(sys.stdin)
    items = [
        spyrrow.Item(str(i), [tuple(point) for point in shape], 1, TURNS)
        for i, shape in enumerate(asked["shapes"])
    ]
    strip = spyrrow.StripPackingInstance("sheet", asked["height"], items)
    # More than one worker would make the result depend on the order of threads.
    settings = spyrrow.StripPackingConfig(
        early_termination=True,
        total_computation_time=asked["seconds"],
        min_items_separation=asked["gap"],
        num_workers=1,
        seed=asked["seed"],
    )
    found = {int(one.id): one for one in strip.solve(settings).placed_items}
    placed = (found[i] for i in range(len(items)))
    json.dump({"places": [[*one.translation, one.rotation] for one in placed]}, sys.stdout)


if __name__ == "__main__":
    main()
