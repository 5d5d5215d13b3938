"""Switches of a chain: every step of a cell from one of its phases to the next, and back.

Under a prescribed force cells are independent. Cells with equilibria in their phases only are then
relays, and the order of their switching forces decides the sequence.
"""

from dataclasses import dataclass, replace

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.concave import TIED, closed
from stepwell.mechanism import Cell, Chain, Element


@dataclass(frozen=True, eq=False)
class Switches:
    """The switches of a chain, numbered cell by cell, inner first, and by rising phase."""

    cells: int  # number of cells
    cell: Ints  # (T,) cell of each switch
    phase: Ints  # (T,) phase that it leaves upwards

    @classmethod
    def of(cls, last: str) -> "Switches":
        """The switches of cells whose last state is `last`, such as "11"."""
        steps = [(cell, k) for cell, digit in enumerate(last) for k in range(int(digit))]
        cell, phase = np.array(steps, np.int64).reshape(-1, 2).T
        return cls(len(last), cell, phase)

    def __len__(self) -> int:
        return len(self.cell)

    def names(self, chain: Chain) -> tuple[str, ...]:
        """Name of each switch: its cell's name, with the phases if that has more than two."""
        steps = np.bincount(self.cell)
        return tuple(
            chain.names[cell] + (f" {k}-{k + 1}" if steps[cell] > 1 else "")
            for cell, k in zip(self.cell.tolist(), self.phase.tolist(), strict=True)
        )

    def decisive(self, forces: Floats) -> Floats:
        """(m, T, 2) forces [N] at which each switch goes up and comes down in a full cycle.

        A cell that leaves a phase upwards lands in the first stable one at this force, so it leaves
        each phase at the largest switching force of all phases up to it.
        """
        held = forces.copy()
        for t in range(1, len(self)):
            if self.phase[t]:
                held[:, t, 0] = np.maximum(held[:, t, 0], held[:, t - 1, 0])
        for t in reversed(range(len(self) - 1)):
            if self.phase[t + 1]:
                held[:, t, 1] = np.minimum(held[:, t, 1], held[:, t + 1, 1])
        return held

    def motion(self, forces: Floats) -> "RelayCycles":
        """Cycles of m chains of relays as a force rises over all (m, T, 2) and falls again."""
        held = self.decisive(forces)
        up, down = held[..., 0], held[..., 1]
        rising = np.argsort(up, axis=1, kind="stable")
        # Phases of one cell with equal forces are left from the last one on.
        back = np.arange(len(self))[::-1]
        falling = back[np.argsort(-down[:, back], axis=1, kind="stable")]
        order = np.stack([rising, falling], axis=1)
        force = np.stack([np.take_along_axis(up, rising, 1), np.take_along_axis(down, falling, 1)])
        apart = np.abs(np.diff(force, axis=-1)).swapaxes(0, 1)
        same_cell = self.cell[order[..., 1:]] == self.cell[order[..., :-1]]
        together = same_cell & (apart == 0.0)
        least = TIED * np.max(np.abs(forces), axis=(1, 2), initial=0.0)
        tied = np.any(~same_cell & (apart <= least[:, None, None]), axis=(1, 2))
        return RelayCycles(self, order, together, tied)


@dataclass(frozen=True, eq=False)
class RelayCycles:
    """Full cycles of m chains of relays."""

    switches: Switches
    order: Ints  # (m, 2, T) switches in the order in which they go up, and come down
    together: (
        Bools  # (m, 2, T - 1) whether one switches with the one before: its cell skips a phase
    )
    tied: Bools  # (m,) whether two cells switch at one force, to rounding

    def cycles(self) -> tuple[list[str], Ints]:
        """The different cycles as texts, and their numbers for each chain (m,)."""
        m = len(self.order)
        rows = np.hstack([self.order.reshape(m, -1), self.together.reshape(m, -1)])
        if not len(self.switches):
            return ["0" * self.switches.cells], np.zeros(len(rows), np.int64)
        _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        return [self._cycle(i) for i in first.tolist()], number.ravel()

    def _cycle(self, i: int) -> str:
        cell = self.switches.cell
        state = [0] * self.switches.cells
        states = [state.copy()]
        for way, order, together in zip((1, -1), self.order[i], self.together[i], strict=True):
            for switch, leaps in zip(order.tolist(), [False, *together.tolist()], strict=True):
                state[cell[switch]] += way
                if leaps:
                    states.pop()
                states.append(state.copy())
        return ">".join("".join(map(str, digits)) for digits in states)


def switching_forces(chain: Chain) -> Floats:
    """Switching forces up and down (T, 2) [N]: for a lever cell F0 and F1 with friction."""
    return np.array(
        [
            (before.force_high + cell.friction, after.force_low - cell.friction)
            for cell in chain.cells
            for before, after in zip(cell.phases, cell.phases[1:], strict=False)
        ]
    ).reshape(-1, 2)


def are_relays(chain: Chain) -> bool:
    """Whether the switching forces are proved to decide the cycle, under a prescribed force."""
    return chain.actuator_stiffness == 0 and all(map(is_relay, chain.cells))


def relay_cycle(chain: Chain) -> str | None:
    """The full cycle of a chain by its switching forces; None if they do not decide, or tie."""
    relays = chain.elements and are_relays(chain)
    return cycle_by(chain, switching_forces(chain)) if relays else None


def cycle_by(chain: Chain, forces: Floats) -> str | None:
    """The full cycle by decisive switching forces (T, 2); None if two of them tie."""
    motion = Switches.of(chain.last_state).motion(forces[None])
    return None if motion.tied[0] else motion.cycles()[0][0]


def is_relay(cell: Cell | Element) -> bool:
    """Whether a cell under a prescribed force is proved to stand in its phases only."""
    # On one sheet a cell moves to the next equilibrium at its force, which is in a phase.
    if isinstance(cell, Element):
        return len(cell.sheets) == 1
    return closed(replace(cell, friction=0.0)) is not None
