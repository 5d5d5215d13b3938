"""Claims about elements of others: balloons, Kresling folds, countersnapping springs."""

import math
from dataclasses import replace
from itertools import product

import numpy as np

from stepwell.base import to_unit
from stepwell.mechanism import Chain, Element, balloon, kresling
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.paper.others.pairs import next_state, straight
from stepwell.sequences import TransitionGraph
from stepwell.statics import Event, EventKind, drive_range

MUHAXHERI = "Muhaxheri and Santangelo 2024"
# Unstretched radius and thickness [m] and second modulus [Pa] of Mooney-Rivlin balloons.
PAIR = ((0.020, 0.00015, 20e3), (0.030, 0.00030, 10e3))
TRIPLE = ((0.030, 0.00015, 20e3), (0.025, 0.00015, 15e3), (0.030, 0.00020, 10e3))
LAW = (
    "Mooney-Rivlin spheres of 150 kPa and 10 to 20 kPa; the law and sizes of the paper were out "
    "of our reach."
)
# Range of the stiffness of air for the change of an arrow [Pa/m³], and the relative tolerance.
_SOFTEST, _STIFFEST, _CLOSE = 1e2, 1e11, 0.01
_ATMOSPHERE = 101325.0  # Pa

# The next state of every state and direction of the drive.
_Arrows = dict[tuple[str, int], str]


def line(balloons: tuple[tuple[float, float, float], ...]) -> Chain:
    """Balloons on one line: one pressure in all, and their volumes add up."""
    return Chain([balloon(radius=r, thickness=t, c2=c2) for r, t, c2 in balloons])


def arrows(graph: TransitionGraph) -> _Arrows:
    """Next states by state and direction, without states in transit."""
    ways = product(graph.vertices, (+1, -1))
    targets = {way: next_state(graph, *way) for way in ways}
    return {way: target for way, target in targets.items() if target != "nowhere"}


@claim(MUHAXHERI, "a Preisach model of hysterons that do not interact", "exact")
def balloons_under_pressure() -> Finding:
    """Under a prescribed pressure balloons on one line are independent hysterons."""
    right, counts = True, []
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        graph = chain.graph("force")
        fields = [cell.fields[0] for cell in chain.elements]
        ways = product(graph.vertices, (+1, -1))
        expected = {way: to for way in ways if (to := _relay(*way, fields)) is not None}
        memory = graph.reading.return_point_memory.holds
        right &= arrows(graph) == expected and memory
        counts.append(f"{len(expected)} arrows of {len(balloons)} balloons")
    return finding_of(
        right,
        f"{' and '.join(counts)}, one balloon each; return points are remembered",
        note=f"Each balloon goes at its own two pressures. {LAW}",
        otherwise="An arrow is not that of independent hysterons, or a return point is forgotten.",
    )


@claim(MUHAXHERI, "coupled; avalanches, return points forgotten", "some of each")
def balloons_under_volume() -> Finding:
    """Under a prescribed volume they are coupled: graphs change, and memory of turns is lost."""
    changes, avalanches, memory = [], 0, True
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        volume = chain.graph()
        changed = _changed(arrows(chain.graph("force")), arrows(volume))
        avalanches += len(changed)
        memory &= volume.reading.return_point_memory.holds
        changes += [f"{_arrow(way)}{after}, not {before}" for way, before, after in changed]
    return finding_of(
        avalanches > 0 and not memory,
        "; ".join(changes),
        note="Each is an avalanche: as one balloon takes the air, another gives its own back. "
        f"The three balloons forget return points; with pressure they do not. {LAW}",
    )


@claim(MUHAXHERI, "silent on air", f"{_CLOSE:.0%} of the stiffness")
def balloons_with_air() -> Finding:
    """Air in the line leads from one graph to the other, each arrow at a stiffness of its own."""
    thresholds, single = [], True
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        ends = [arrows(chain.graph(drive)) for drive in ("force", None)]
        for way, before, after in _changed(*ends):
            stiffness = _change(chain, way, before, after)
            single &= stiffness is not None
            if stiffness is not None:
                size = f"{stiffness * 1e-6:.2g} kPa/L ({_ATMOSPHERE / stiffness:.2g} m³)"
                thresholds.append(f"{_arrow(way)}{after} above {size}")
    return finding_of(
        single and bool(thresholds),
        "; ".join(thresholds),
        note=f"In brackets the air at one atmosphere that is as stiff, K = p/V. {LAW}",
        otherwise="An arrow leads elsewhere in between.",
    )


def _relay(state: str, direction: int, fields: list[tuple[float, float]]) -> str | None:
    """Next state of independent hysterons; None if all cells have switched."""
    phase, first = ("0", min) if direction > 0 else ("1", max)
    cells = [i for i, digit in enumerate(state) if digit == phase]
    if not cells:
        return None
    cell = first(cells, key=lambda i: fields[i][int(phase)])
    return state[:cell] + str(1 - int(phase)) + state[cell + 1 :]


def _changed(before: _Arrows, after: _Arrows) -> list[tuple[tuple[str, int], str, str]]:
    return [(way, target, after[way]) for way, target in before.items() if after[way] != target]


def _change(chain: Chain, way: tuple[str, int], soft: str, stiff: str) -> float | None:
    """The stiffness above which an arrow leads elsewhere; None unless it changes exactly once."""
    low, high = _SOFTEST, _STIFFEST
    while high / low > 1.0 + _CLOSE:
        middle = math.sqrt(low * high)
        target = next_state(chain.graph(middle, start=way[0]), *way)
        if target == soft:
            low = middle
        elif target == stiff:
            high = middle
        else:
            return None
    return math.sqrt(low * high)


def _arrow(way: tuple[str, int]) -> str:
    """Text for an arrow, such as 01-: from 01 on a falling drive."""
    return f"{way[0]}{'+' if way[1] > 0 else chr(0x2212)} to "


BALLOON_CLAIMS = (balloons_under_pressure, balloons_under_volume, balloons_with_air)


DUCARME = "Ducarme et al. 2025"
# A curve that crosses itself [mm, N]: to the peak, back on an unstable stretch, and on.
_CROSSING = ((0.0, 0.0), (10.0, 1.0), (8.0, 0.2), (9.3, 0.35), (10.0, 1.4), (11.0, 2.9))
# The same peak and valley without the crossing: it lengthens when it snaps.
_PLAIN = ((-5.0, -0.5), (10.0, 1.0), (12.0, 0.2), (14.0, 3.2))
COUNT, _BESIDE = 5, 3
_SPREAD = 0.001  # of the forces, from one element to the next


@claim(DUCARME, "shortens under a rising pull", "shorter at the same force")
def countersnap() -> Finding:
    """A countersnapping element shortens when its pull passes the peak."""
    chain = Chain((straight(_CROSSING),), actuator_stiffness=0.0)
    snap = _snaps(chain, (0.0, 1.5))[0]
    counter = Chain((straight(_CROSSING),))
    pulled = _snaps(counter, (0.0, 0.0105))[0]
    return finding_of(
        snap.after[0] < snap.before[0] and pulled.force_after > pulled.force_before,
        f"{to_unit(snap.before[0], 'mm'):.4g} to {to_unit(snap.after[0], 'mm'):.4g} mm at "
        f"{snap.drive:.3g} N; at a prescribed length from {pulled.force_before:.3g} to "
        f"{pulled.force_after:.3g} N",
        note="A curve that crosses itself, of our own making; the paper's three building blocks "
        "and their curves were out of our reach as numbers.",
    )


@claim(DUCARME, "all together", "one snap for all, and one for each of ordinary ones")
def countersnaps_in_series() -> Finding:
    """In series such elements switch together, where ordinary ones switch one by one."""
    scales = 1.0 + _SPREAD * np.arange(COUNT)
    together = _flips([straight(_CROSSING, scale) for scale in scales])
    apart = _flips([straight(_PLAIN, scale) for scale in scales])
    return finding_of(
        together == [COUNT] and apart == [1] * COUNT,
        f"snaps of {', '.join(map(str, together))}; of ordinary ones, of "
        f"{', '.join(map(str, apart))}",
        note=f"{COUNT} elements under a prescribed length, forces {100 * _SPREAD:g} % apart. The "
        f"first that shortens pulls harder on all others, so that they pass their peaks too.",
    )


@claim(DUCARME, "one by one", "one element a snap")
def countersnaps_in_parallel() -> Finding:
    """Side by side such elements switch one by one, and each changes the stiffness."""
    elements = [replace(straight(_CROSSING), travel_scale=1.0 + 0.02 * k) for k in range(_BESIDE)]
    snaps = _snaps(Chain((Element.side_by_side(elements),)), (0.0, 0.0110))
    places = ", ".join(f"{to_unit(snap.drive, 'mm'):.4g}" for snap in snaps)
    return finding_of(
        len(snaps) == len(elements),
        f"{len(snaps)} snaps of {len(elements)} elements, at {places} mm",
        note="A prescribed length, so that none feels the others.",
    )


def _flips(elements: list[Element]) -> list[int]:
    """Number of elements that change phase in each snap while a chain is loaded."""
    snaps = _snaps(Chain(elements), (0.0, 1e-3 * 14.0 * len(elements)))
    return [count for snap in snaps if (count := len(snap.arrivals))]


def _snaps(chain: Chain, drives: tuple[float, float]) -> list[Event]:
    return [event for event in chain.path(drives).events if event.kind is EventKind.SNAP]


COUNTERSNAPPING_CLAIMS = (countersnap, countersnaps_in_series, countersnaps_in_parallel)


# Height at rest deployed [m] of the weak and of the strong fold; numbers of the paper's folds were
# not available.
WEAK, STRONG = 0.040, 0.045


@claim("Bhovad, Kaufmann and Li 2019", "a deterministic sequence", "one closed sequence")
def kresling_pair() -> Finding:
    """Two Kresling folds in series go through one sequence when only their length is controlled."""
    weak, strong = kresling(deployed=WEAK), kresling(deployed=STRONG)
    sequences, ties, same = list[str](), 0, True
    for folds in ((weak, strong), (strong, weak)):
        chain = Chain(folds)
        cycle = chain.cycle()
        sequences.append(str(cycle.sequence))
        ties += len(cycle.degenerate)
        low, high = drive_range(chain)
        events = chain.path((low, high, low, high, low)).events
        half = len(events) // 2
        same &= all(
            a.arrivals == b.arrivals and abs(a.drive - b.drive) <= 1e-9 * (high - low)
            for a, b in zip(events[:half], events[half:], strict=True)
        )
    right = sequences == ["00>10>11>01>00", "00>01>11>10>00"]
    return finding_of(
        right and same and not ties,
        f"{sequences[0]}, and {sequences[1]} with the folds exchanged",
        note="The fold that takes less force goes first both ways, so that the pair goes through "
        "all four states in a circle, and the next cycle is the same. Truss model of Yasuda and "
        f"Yang 2015; deployed heights {to_unit(WEAK, 'mm'):g} and {to_unit(STRONG, 'mm'):g} mm are "
        "ours.",
    )


KRESLING_CLAIMS = (kresling_pair,)
