"""The smallest change of one number of a cell with which a chain reaches a target."""

import math
from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise

import numpy as np

from stepwell.base import Progress, bisected, notify
from stepwell.concave import Neighbour, SortedChain
from stepwell.design.margins.nearest import sequence
from stepwell.design.parameters import Parameter
from stepwell.design.plane import Method
from stepwell.design.switches import Switches, are_relays, cycle_by, switching_forces
from stepwell.mechanism import Chain
from stepwell.statics import StaticsError

# Additional change beyond the smallest one, large enough to avoid a tie.
_PAST = 1e-7
_RATIOS = 12
_MOST = 8.0  # largest ratio tried, up and down; every other is the root of the next
_FINELY = 200  # tries each way if the target may be a narrow range
_RESOLUTION = 1e-6  # where bisection stops

# Parameters that change switching forces in proportion, or not at all.
_OF_FORCES = ("stiffness", "force_scale", "travel_scale", "friction")

_THEN = f"then bisection to {_RESOLUTION * 100:g} %"
RESOLUTION_FINE = (
    f"evaluated at {_FINELY} values each way between 1/{_MOST:g} and {_MOST:g} times the value "
    f"(for friction up to the peak of the element); changes between them are missed; {_THEN}"
)


def resolution(part: str, force: str) -> str:
    """Resolution of a search of a number, in words."""
    if part == "friction":
        return f"evaluated at {_RATIOS} values up to the largest {force} of the element, {_THEN}"
    return f"evaluated at {_RATIOS} factors each way between 1/{_MOST:g} and {_MOST:g}, {_THEN}"


# Size of a relative change, the signed change, a slightly larger one, and the method.
Share = tuple[float, float, float, Method]


def changed_by(chain: Chain, number: Parameter, share: float) -> Chain:
    """The chain with a number changed by a fraction of it; friction, of the largest force."""
    if number.part != "friction":
        return number.scaled(chain, 1.0 + share)
    assert number.cell is not None
    own = chain.cells[number.cell]
    return number.changed(chain, own.friction + share * own.largest_force)


def nearest_share(
    chain: Chain,
    forces: SortedChain | None,
    now: str,
    number: Parameter,
    target: str | None = None,
    progress: Progress = None,
) -> Share:
    """The smallest change of a number of a cell with which a chain reaches the target.

    It is a fraction of the number, for friction of the largest force, and NaN if there is none.

    In closed form F of one linear band is proportional to k, so the ratio of stiffness that reaches
    another force is a quotient; a force of the other sign, or zero, is never reached. The same
    holds for all forces of an element under a prescribed force, where only the order of the
    switching forces counts. Otherwise values are simulated, and the first change is bisected.
    Without a target, any sequence other than `now` counts.
    """
    assert number.cell is not None
    if forces is not None and number.part == "stiffness" and target is None:
        return share_of_stiffness(tuple(forces.neighbours(number.cell)))
    if chain.elements and number.part in _OF_FORCES and are_relays(chain):
        return _among_relays(chain, number, target)

    def does(share: float) -> bool:
        # A design that cannot be built or simulated counts as another sequence.
        try:
            done = str(sequence(changed_by(chain, number, share)))
        except (StaticsError, ValueError):
            return target is None
        return done != now if target is None else done == target

    changes = _searched(does, chain, number, finely=target is not None, progress=progress)
    share = min(changes, key=abs, default=math.nan)
    return _share(share, share, Method.SEARCH)


# Kept, because in a drag most cells keep their neighbours in force.
@lru_cache(maxsize=1024)
def share_of_stiffness(neighbours: tuple[Neighbour, ...]) -> Share:
    """The smallest change of the stiffness of a cell with which it passes a neighbour in force."""
    quotients = [
        (n.other / n.own - 1.0, n.up if n.own > 0 else -n.up)
        for n in neighbours
        if n.own * n.other > 0
    ]
    share, grows = min(quotients, key=lambda one: abs(one[0]), default=(math.nan, 1))
    return _share(share, share + math.copysign(_PAST, grows), Method.EXACT)


def _share(share: float, past: float, method: Method) -> Share:
    return math.inf if math.isnan(share) else abs(share), share, past, method


def _among_relays(chain: Chain, number: Parameter, target: str | None) -> Share:
    """The smallest change by evaluating once between each two meetings of switching forces."""
    assert number.cell is not None
    own, least = chain.cells[number.cell], -1.0
    forces = switching_forces(chain)
    rub = np.array([1.0, -1.0])
    # Slope of the forces by the relative change.
    slope = forces - own.friction * rub
    if number.part == "friction":
        slope = np.broadcast_to(own.largest_force * rub, forces.shape)
        least = -own.friction / own.largest_force
    elif number.part == "travel_scale":
        slope = np.zeros_like(forces)
    mine = Switches.of(chain.last_state).cell == number.cell
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (forces[~mine][None] - forces[mine][:, None]) / slope[mine][:, None]
    meetings = np.unique(at[np.isfinite(at)])
    now = cycle_by(chain, forces)
    up = [0.0, *meetings[meetings > 0.0].tolist(), math.inf]
    down = [0.0, *meetings[meetings < 0.0][::-1].tolist(), least]
    stretches = [*pairwise(up), *pairwise(down)]
    for begin, end in sorted(stretches, key=lambda one: abs(one[0])):
        way = math.copysign(1.0, end)
        if begin == end or (way < 0 and begin <= least):
            continue
        middle = begin + way * (1.0 if math.isinf(end) else abs(end - begin) / 2.0)
        done = cycle_by(chain, forces + middle * np.where(mine[:, None], slope, 0.0))
        if done is None or (done == now if target is None else done != target):
            continue
        past = begin + way * min(_PAST, abs(middle - begin))
        return _share(begin, past, Method.EXACT)
    return _share(math.nan, math.nan, Method.EXACT)


def _searched(
    does: Callable[[float], bool], chain: Chain, number: Parameter, finely: bool, progress: Progress
) -> list[float]:
    """The first change that reaches the target each way, if smaller than the known one."""
    changes: list[float] = []
    least, done = math.inf, 0
    tries = [(sign, _tries(chain, number, sign, finely)) for sign in (1, -1)]
    for sign, shares in tries:
        good = 0.0
        for share in shares:
            notify(progress, done, sum(len(shares) for _, shares in tries))
            done += 1
            bad = sign * min(share, least)
            if does(bad):
                halvings = math.ceil(math.log2(max(1.0, abs(bad - good) / _RESOLUTION)))
                changes.append(bisected(lambda at: not does(at), good, bad, halvings)[1])
                least = abs(changes[-1])
            if abs(bad) >= least:
                break
            good = bad
    return changes


def _tries(chain: Chain, number: Parameter, sign: int, finely: bool) -> list[float]:
    fine = [(k + 1) / _FINELY for k in range(_FINELY)]
    parts = fine if finely else [0.5**k for k in reversed(range(_RATIOS))]
    if number.part != "friction":
        return [abs(_MOST ** (sign * part) - 1.0) for part in parts]
    assert number.cell is not None
    own = chain.cells[number.cell]
    most = 1.0 if sign > 0 else own.friction / own.largest_force
    return [most * part for part in parts] if most > 0 else []
