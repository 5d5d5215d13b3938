"""Nesting in a process of its own: reads outlines as JSON, writes places as JSON.

Run as a file, not imported: the solver ends its process when it meets an outline that it does not
like, and it knows no interruption.

Input: `height` and `gap` [mm], `seconds`, `seed`, `shapes` (corners of each part, [mm]).
Output: `places`, of each part its x, y [mm] and angle [degrees], turned before it is shifted.
"""

import json
import sys

# Parts may be turned by these angles [degrees]; the fibres of wood and a kerf that differs in x and
# y allow no others.
TURNS = (0.0, 90.0, 180.0, 270.0)


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
    places = [[*one.translation, one.rotation] for one in (found[i] for i in range(len(items)))]
    json.dump({"places": places}, sys.stdout)


if __name__ == "__main__":
    main()
