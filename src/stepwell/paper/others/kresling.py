"""The claim about two Kresling folds of which only the total length is controlled."""

from __future__ import annotations

from stepwell.mechanism import Chain, kresling
from stepwell.paper.claims import Finding, claim, judged
from stepwell.statics import drive_range

# Height at rest deployed [m] of the weak and of the strong fold; the paper's folds were not to be
# had in numbers.
WEAK, STRONG = 0.040, 0.045


@claim("Bhovad, Kaufmann and Li 2019", "a deterministic sequence", "one closed sequence")
def kresling_pair() -> Finding:
    """Two Kresling folds in series go through one sequence when only their length is controlled."""
    weak, strong = kresling(deployed=WEAK), kresling(deployed=STRONG)
    told: list[str] = []
    ties = 0
    same = True
    for folds in ((weak, strong), (strong, weak)):
        chain = Chain(folds)
        cycle = chain.cycle()
        told.append(str(cycle.sequence))
        ties += len(cycle.degenerate)
        low, high = drive_range(chain)
        again = chain.path((low, high, low, high, low))
        half = len(again.events) // 2
        drives = [event.drive for event in again.events]
        same &= [event.arrivals for event in again.events[:half]] == [
            event.arrivals for event in again.events[half:]
        ]
        same &= all(
            abs(a - b) <= 1e-9 * (high - low)
            for a, b in zip(drives[:half], drives[half:], strict=True)
        )
    right = told == ["00>10>11>01>00", "00>01>11>10>00"]
    return judged(
        right and same and not ties,
        f"{told[0]}, and {told[1]} with the folds exchanged",
        note="The fold that takes less force goes first both ways, so that the pair goes through "
        "all four states in a circle, and the next cycle is the same. Truss model of Yasuda and "
        f"Yang 2015; deployed heights {1e3 * WEAK:g} and {1e3 * STRONG:g} mm are ours.",
    )


CLAIMS = (kresling_pair,)
