"""Chains of elements pulled out once, beside the peer that solves any assembly of springs.

That one, springable, is under the GPL: it is called and nothing of it is in here. Install it beside
Stepwell in an environment of its own.
"""

import contextlib
import importlib.util
import io
import itertools
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw

Corners = tuple[tuple[float, float], ...]

# Corners of curves [mm, N], from rest on; one folds back. The weaker, the lower the valley: else
# the peer's way by arc length leads past some of the states.
WEAK = ((0.0, 0.0), (1.5, 1.5), (2.1, -1.5), (5.6, 2.0), (7.6, 4.0))
MIDDLE = ((0.0, 0.0), (2.0, 2.0), (2.6, -1.0), (5.6, 2.0), (7.6, 4.0))
STRONG = ((0.0, 0.0), (2.5, 2.5), (3.0, -0.5), (5.5, 2.0), (7.5, 4.0))
HIGH = ((0.0, 0.0), (3.0, 3.0), (3.5, 0.5), (6.0, 3.0), (7.0, 4.0))
# Its valley is so high that it gives back while a strong one goes.
YIELDING = ((0.0, 0.0), (2.0, 1.0), (2.25, 0.5), (4.25, 1.5), (9.25, 4.0))
FOLDED = ((0.0, 0.0), (4.0, 2.0), (3.0, -0.8), (9.0, 4.0))
# And the radius of the peer's steps, its own 0.05 where that gets to the end; with 0.02 and finer
# ones others run out of steps.
CASES: dict[str, tuple[tuple[Corners, ...], float]] = {
    "two": ((WEAK, STRONG), 0.02),
    "two, one gives back": ((YIELDING, STRONG), 0.05),
    "two, one folds back": ((FOLDED, STRONG), 0.05),
    "three": ((WEAK, MIDDLE, STRONG), 0.05),
    "four": ((WEAK, MIDDLE, STRONG, HIGH), 0.05),
}
_SMOOTH = 0.02  # of corners: mm, and a share for curves that fold back
_DENSE = 8


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    if importlib.util.find_spec("springable") is None:
        return [("against springable", "not installed: pip install springable", "as a ratio")]
    return [row for name, case in CASES.items() for row in _compared(name, *case)]


def _compared(name: str, curves: tuple[Corners, ...], radius: float) -> list[tuple[str, str, str]]:
    chain = sw.Chain([element(curve) for curve in curves])
    far = 1e-3 * sum(_at(curve, 3.5) for curve in curves)
    ours, seconds = timed(lambda: states_of(chain, chain.path((0.0, far))), 5)
    theirs, their_seconds = timed(lambda: solved(curves, 1e3 * far, radius), 1)
    same = "the same states" if ours == theirs else f"{'>'.join(ours)}, there {'>'.join(theirs)}"
    times = (
        f"{1e3 * seconds:.2g} ms, there {their_seconds:.2g} s: {their_seconds / seconds:.0f} times"
    )
    return [(f"{name}, pulled out, beside springable", f"{same}; {times}", "as a ratio")]


def element(curve: Corners) -> sw.Element:
    """An element of straight pieces."""
    travel, force = np.array(curve).T
    if np.all(np.diff(travel) > 0.0):
        return sw.Element.from_points(1e-3 * travel, force)
    places = np.linspace(0.0, len(curve) - 1.0, _DENSE * (len(curve) - 1) + 1)
    by_arc = (np.interp(places, np.arange(len(curve)), column) for column in (travel, force))
    travel, force = by_arc
    return sw.Element.from_curve(1e-3 * travel, force)


def states_of(chain: sw.Chain, path: sw.Path) -> list[str]:
    """The states with all cells in a phase, in their order."""
    state, found = list(chain.first_state), [chain.first_state]
    for event in path.events:
        for cell, phase in event.arrivals:
            state[cell] = str(phase)
        if event.arrivals:
            found.append("".join(state))
    return found


def solved(curves: tuple[Corners, ...], far: float, radius: float) -> list[str]:
    """The same of the peer: its equilibria by arc length, and a jump where they fold back."""
    from springable import simulation  # pyright: ignore[reportMissingImports]

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        file = Path(folder) / "model.csv"
        file.write_text(_model(curves, far))
        result = simulation.solve_model(str(file), solver_settings={"radius": radius})
    length, force = map(np.asarray, result.get_equilibrium_path())
    stands = np.array([str(word) != "unstable" for word in result.get_stability()])
    ends = np.array(result.get_displacements())[:, ::2]
    travels = np.diff(ends[:, : len(curves) + 1], axis=1)
    at, found = 0, [_state(curves, travels[0], force[0])]
    while at is not None:
        state = _state(curves, travels[at], force[at])
        if "-" not in state and state != found[-1]:
            found.append(state)
        at = _next(length, stands, at)
    return found


def _next(length: Any, stands: Any, at: int) -> int | None:
    """The next point that stands, on the way or after a jump at the same length."""
    if at + 1 < len(length) and stands[at + 1] and length[at + 1] > length[at]:
        return at + 1
    later = np.flatnonzero(stands & (length >= length[at]) & (np.arange(len(length)) > at))
    return int(later[0]) if len(later) else None


def _state(curves: tuple[Corners, ...], travels: Any, force: float) -> str:
    digits = ""
    for curve, travel in zip(curves, travels.tolist(), strict=True):
        (peak, _), (valley, _) = curve[1:3]
        near = 2.0 * _SMOOTH
        # Where a curve folds back, both phases hold a travel: the force tells which it is.
        off = [abs(force - _force(part, travel)) for part in (curve[:2], curve[2:])]
        if valley < peak:
            digits += str(int(np.argmin(off)))
        else:
            digits += "0" if travel <= peak + near else "1" if travel >= valley - near else "-"
    return digits


def _force(part: Corners, travel: float) -> float:
    """Force on a rising part of a curve [N]."""
    s, f = np.array(part).T
    return float(np.interp(travel, s, f))


def _model(curves: tuple[Corners, ...], far: float) -> str:
    lines = ["NODES"]
    lines += [f"{k}, {100.0 * k}, 0.0, {int(k == 0)}, 1" for k in range(len(curves) + 1)]
    lines += ["SPRINGS", *(f"{k}-{k + 1}, {_law(curve)}" for k, curve in enumerate(curves))]
    return "\n".join([*lines, "LOADING", f"{len(curves)}, X, 4.0, {far}", ""])


def _law(curve: Corners) -> str:
    travel, force = np.array(curve).T
    if np.any(np.diff(travel) < 0.0):
        u, f = (";".join(map(str, column[1:].tolist())) for column in (travel, force))
        return f"ZIGZAG2(u_i=[{u}]; f_i=[{f}]; epsilon={_SMOOTH})"
    slopes = ";".join(f"{slope:.9g}" for slope in np.diff(force) / np.diff(travel))
    return f"PIECEWISE(k_i=[{slopes}]; u_i=[{';'.join(map(str, travel[1:-1]))}]; us={_SMOOTH})"


def _at(curve: Corners, force: float) -> float:
    """Travel on the last piece of a curve [mm]."""
    (s, f), (t, g) = curve[-2:]
    return s + (force - f) * (t - s) / (g - f)


def timed(work: Callable[[], list[str]], times: int) -> tuple[list[str], float]:
    """What came out, and the median time [s] after a first run."""
    found, taken = work(), []
    for _ in itertools.repeat(None, times):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return found, statistics.median(taken)
