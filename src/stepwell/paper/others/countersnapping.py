"""Claims about elements that shorten when they snap under a rising pull."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stepwell.mechanism import Chain, Element
from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.others.curves import straight
from stepwell.statics import Event, EventKind

WHERE = "Ducarme et al. 2025"
# A curve that crosses itself [mm, N]: to the peak, back on an unstable stretch, and on.
_CROSSING = ((0.0, 0.0), (10.0, 1.0), (8.0, 0.2), (9.3, 0.35), (10.0, 1.4), (11.0, 2.9))
# The same peak and valley without the crossing: it lengthens when it snaps.
_PLAIN = ((-5.0, -0.5), (10.0, 1.0), (12.0, 0.2), (14.0, 3.2))
COUNT, _BESIDE = 5, 3
_SPREAD = 0.001  # of the forces, from one element to the next


@claim(WHERE, "shortens under a rising pull", "shorter at the same force")
def countersnap() -> Finding:
    """A countersnapping element shortens when its pull passes the peak."""
    chain = Chain((straight(_CROSSING),), actuator_stiffness=0.0)
    snap = _snaps(chain, (0.0, 1.5))[0]
    counter = Chain((straight(_CROSSING),))
    pulled = _snaps(counter, (0.0, 0.0105))[0]
    return judged(
        snap.after[0] < snap.before[0] and pulled.force_after > pulled.force_before,
        f"{1e3 * snap.before[0]:.4g} to {1e3 * snap.after[0]:.4g} mm at {snap.drive:.3g} N; at a "
        f"prescribed length from {pulled.force_before:.3g} to {pulled.force_after:.3g} N",
        note="A curve that crosses itself, of our own making; the paper's three building blocks "
        "and their curves were out of our reach as numbers.",
    )


@claim(WHERE, "all together", "one snap for all, and one for each of ordinary ones")
def countersnaps_in_series() -> Finding:
    """In series such elements switch together, where ordinary ones switch one by one."""
    scales = 1.0 + _SPREAD * np.arange(COUNT)
    together = _flips([straight(_CROSSING, scale) for scale in scales])
    apart = _flips([straight(_PLAIN, scale) for scale in scales])
    return judged(
        together == [COUNT] and apart == [1] * COUNT,
        f"snaps of {', '.join(map(str, together))}; of ordinary ones, of "
        f"{', '.join(map(str, apart))}",
        note=f"{COUNT} elements under a prescribed length, forces {100 * _SPREAD:g} % apart. The "
        f"first that shortens pulls harder on all others, so that they pass their peaks too.",
    )


@claim(WHERE, "one by one", "one element a snap")
def countersnaps_in_parallel() -> Finding:
    """Side by side such elements switch one by one, and each changes the stiffness."""
    elements = [replace(straight(_CROSSING), travel_scale=1.0 + 0.02 * k) for k in range(_BESIDE)]
    snaps = _snaps(Chain((Element.side_by_side(elements),)), (0.0, 0.0110))
    return judged(
        len(snaps) == len(elements),
        f"{len(snaps)} snaps of {len(elements)} elements, at "
        f"{', '.join(f'{1e3 * snap.drive:.4g}' for snap in snaps)} mm",
        note="A prescribed length, so that none feels the others.",
    )


def _flips(elements: list[Element]) -> list[int]:
    """How many elements change their phase in each snap while a chain is pulled out."""
    chain = Chain(elements)
    length = 1e-3 * 14.0 * len(elements)
    snaps = _snaps(chain, (0.0, length))
    return [count for snap in snaps if (count := len(snap.arrivals))]


def _snaps(chain: Chain, drives: tuple[float, float]) -> list[Event]:
    return [event for event in chain.path(drives).events if event.kind is EventKind.SNAP]


CLAIMS = (countersnap, countersnaps_in_series, countersnaps_in_parallel)
