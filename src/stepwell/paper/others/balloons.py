"""Claims about rubber balloons on one line: alone under pressure, coupled under volume."""

from __future__ import annotations

import math

from stepwell.mechanism import Chain, balloon
from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.others.pairs import next_state
from stepwell.sequences import TransitionGraph

WHERE = "Muhaxheri and Santangelo 2024"
# Unstretched radius and thickness [m] and second modulus [Pa] of Mooney-Rivlin balloons.
PAIR = ((0.020, 0.00015, 20e3), (0.030, 0.00030, 10e3))
TRIPLE = ((0.030, 0.00015, 20e3), (0.025, 0.00015, 15e3), (0.030, 0.00020, 10e3))
LAW = (
    "Mooney-Rivlin spheres of 150 kPa and 10 to 20 kPa; the law and sizes of the paper were out "
    "of our reach."
)
# Stiffness of air between which an arrow's change is looked for [Pa/m³], and how closely.
_SOFTEST, _STIFFEST, _CLOSE = 1e2, 1e11, 0.01
_ATMOSPHERE = 101325.0  # Pa

# Of every state and sense of the drive, the next state.
_Arrows = dict[tuple[str, int], str]


def line(balloons: tuple[tuple[float, float, float], ...]) -> Chain:
    """Balloons on one line: one pressure in all, and their volumes add up."""
    return Chain([balloon(radius=r, thickness=t, c2=c2) for r, t, c2 in balloons])


def arrows(graph: TransitionGraph) -> _Arrows:
    """Where each state leads, states in transit left out."""
    ways = ((state, direction) for state in graph.vertices for direction in (+1, -1))
    found = {way: next_state(graph, *way) for way in ways}
    return {way: target for way, target in found.items() if target != "nowhere"}


@claim(WHERE, "a Preisach model of hysterons that do not interact", "exact")
def balloons_under_pressure() -> Finding:
    """Under a prescribed pressure balloons on one line are independent hysterons."""
    right, told = True, []
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        graph = chain.graph("force")
        fields = [cell.fields[0] for cell in chain.elements]
        wanted = {
            (state, direction): flipped
            for state in graph.vertices
            for direction in (+1, -1)
            if (flipped := _relay(state, direction, fields)) is not None
        }
        memory = graph.reading.return_point_memory.holds
        right &= arrows(graph) == wanted and memory
        told.append(f"{len(wanted)} arrows of {len(balloons)} balloons")
    return judged(
        right,
        f"{' and '.join(told)}, one balloon each; return points are remembered",
        note=f"Each balloon goes at its own two pressures. {LAW}",
        otherwise="An arrow is not that of independent hysterons, or a return point is forgotten.",
    )


@claim(WHERE, "coupled; avalanches, return points forgotten", "some of each")
def balloons_under_volume() -> Finding:
    """Under a prescribed volume they are coupled: graphs change, and memory of turns is lost."""
    told, avalanches, memory = [], 0, True
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        volume = chain.graph()
        found = _changed(arrows(chain.graph("force")), arrows(volume))
        avalanches += len(found)
        memory &= volume.reading.return_point_memory.holds
        told += [f"{_arrow(way)}{after}, not {before}" for way, before, after in found]
    return judged(
        avalanches > 0 and not memory,
        "; ".join(told),
        note="Each is an avalanche: as one balloon takes the air, another gives its own back. "
        f"The three balloons forget return points; with pressure they do not. {LAW}",
    )


@claim(WHERE, "silent on air", f"{_CLOSE:.0%} of the stiffness")
def balloons_with_air() -> Finding:
    """Air in the line leads from one graph to the other, each arrow at a stiffness of its own."""
    told, single = [], True
    for balloons in (PAIR, TRIPLE):
        chain = line(balloons)
        ends = [arrows(chain.graph(drive)) for drive in ("force", None)]
        for way, before, after in _changed(*ends):
            stiffness = _change(chain, way, before, after)
            single &= stiffness is not None
            if stiffness is not None:
                air = _ATMOSPHERE / stiffness
                told.append(
                    f"{_arrow(way)}{after} above {stiffness * 1e-6:.2g} kPa/L ({air:.2g} m³)"
                )
    return judged(
        single and bool(told),
        "; ".join(told),
        note=f"In brackets the air at one atmosphere that is as stiff, K = p/V. {LAW}",
        otherwise="An arrow leads elsewhere in between.",
    )


def _relay(state: str, direction: int, fields: list[tuple[float, float]]) -> str | None:
    """Where a set of independent hysterons goes."""
    phase, first = ("0", min) if direction > 0 else ("1", max)
    cells = [i for i, digit in enumerate(state) if digit == phase]
    if not cells:
        return None
    cell = first(cells, key=lambda i: fields[i][int(phase)])
    return state[:cell] + str(1 - int(phase)) + state[cell + 1 :]


def _changed(before: _Arrows, after: _Arrows) -> list[tuple[tuple[str, int], str, str]]:
    return [(way, target, after[way]) for way, target in before.items() if after[way] != target]


def _change(chain: Chain, way: tuple[str, int], soft: str, stiff: str) -> float | None:
    """The stiffness above which an arrow leads elsewhere; None where it does not change once."""
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
    """Such as 01-: from 01 on a falling drive."""
    return f"{way[0]}{'+' if way[1] > 0 else chr(0x2212)} to "


CLAIMS = (balloons_under_pressure, balloons_under_volume, balloons_with_air)
