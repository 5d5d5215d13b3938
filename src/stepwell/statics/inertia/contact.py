"""Which cells move, and what a blow leaves of their speeds: one convex problem, twice."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import kernel

# So near to the solution, as a share of the largest number in it.
_CLOSE = 1e-15


@kernel
def taut(low: Floats, high: Floats, extra: Floats, loose: Floats, end: float, out: Floats) -> None:
    """Forces across cells, each within its bounds, that pull the blocks as little as can be.

    The force x_i across cell i accelerates the block inside it by +x_i/M and the one outside it by
    -x_i/M. Of all forces within their bounds those are taken that minimise Σ M ü²: where x_i is
    inside its bounds cell i then does not accelerate, at its upper bound it does upwards, at its
    lower one downwards. This is Gauss's principle of least constraint, and over the blocks' masses
    laid end to end it is a taut string through the bounds. Impulses and jumps of speed obey the
    same, with `extra` for what the speeds were.

    Args:
        low, high: (N,) bounds of the forces [N], or of impulses [N s].
        extra: (N,) added to the acceleration of each cell [m/s²], or to its speed [m/s].
        loose: (N,) 1/M of the block outside each cell [1/kg]; 0 for one that cannot move.
        end: the force on the outermost block [N].
        out: (N,) the forces, from a first guess on.

    Source: Gauss 1829; as contact problems, Moreau 1966.
    """
    n = len(low)
    for i in range(n):
        out[i] = min(max(out[i], low[i]), high[i])
    # Sweeps from cell to cell: a run of n cells at rest needs of the order of n² of them.
    for _ in range(100 + 40 * n * n):
        change, size = 0.0, abs(end)
        for i in range(n):
            inner = loose[i - 1] if i > 0 else 0.0
            outer = loose[i]
            if inner + outer == 0.0:
                continue
            pull = extra[i]
            if i > 0:
                pull += inner * out[i - 1]
            pull += outer * (out[i + 1] if i + 1 < n else end)
            value = min(max(pull / (inner + outer), low[i]), high[i])
            change = max(change, abs(value - out[i]))
            size = max(size, abs(value))
            out[i] = value
        if change <= _CLOSE * size:
            return


@kernel
def rates(force: Floats, loose: Floats, end: float, out: Floats) -> None:
    """Accelerations of the cells under the forces across them, (N,) [m/s²]; or jumps of speed."""
    n, before = len(force), 0.0
    for i in range(n):
        block = loose[i] * ((force[i + 1] if i + 1 < n else end) - force[i])
        out[i] = block - before
        before = block


@kernel
def kinetic(mass: Floats, loose: Floats, speed: Floats) -> float:
    """½ Σ M_j (v_1 + … + v_j)² of the blocks that can move [J]."""
    total, block = 0.0, 0.0
    for j in range(len(speed)):
        block += speed[j]
        if loose[j] > 0.0:
            total += 0.5 * mass[j] * block * block
    return total


@kernel
def blow(low: Floats, high: Floats, bounce: Floats, loose: Floats, speed: Floats) -> None:
    """What is left of the speeds where cells hit their stops, in place.

    Args:
        low, high: (N,) 0, or infinite where a stop can strike.
        bounce: (N,) restitution of each blow.
        loose: (N,) as for `taut`.
        speed: (N,) before, and then after [m/s].

    Source: Newton's law of restitution; for several blows at once Moreau 1988.
    """
    impulse, jump = np.zeros(len(speed)), np.empty(len(speed))
    taut(low, high, (1.0 + bounce) * speed, loose, 0.0, impulse)
    rates(impulse, loose, 0.0, jump)
    for i in range(len(speed)):
        held = low[i] < impulse[i] < high[i] and low[i] < high[i]
        speed[i] = -bounce[i] * speed[i] if held else speed[i] + jump[i]
