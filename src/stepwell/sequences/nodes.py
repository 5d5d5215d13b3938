"""Nodes and transitions of a transition graph, stored or made from arrays."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import accumulate
from operator import mul
from typing import overload

import numpy as np
from numpy.typing import NDArray

from stepwell.base import ByValue, Floats, Ints, deep_equal, number


class TransitionKind(Enum):
    """Kind of a transition between nodes."""

    SWITCH = "a cell reaches or leaves a phase; reversible"
    SNAP = "snap-through; irreversible"


@dataclass(frozen=True, slots=True, eq=False)
class Node(ByValue):
    """Connected stable equilibria with every cell in the same phase or in transit.

    A node with no cell in transit is a *vertex*. Under a rigid actuator one with every cell at a
    stop has one stroke and a range of forces; all others have a range of strokes.

    Attributes:
        label: its name in the graph: `state`, numbered where several nodes have it.
        state: one character a cell, inner first: the number of its phase, or - for one in transit.
        low, high: the drives between which it exists [m], or [N] under force control.
        force_low, force_high: the actuator's force λ there [N].
        travel_low, travel_high: (N,) travels there [m].
        branch: number of its branch; nodes of one branch are connected without a snap.
    """

    label: str
    state: str
    low: float
    high: float
    force_low: float
    force_high: float
    travel_low: tuple[float, ...]
    travel_high: tuple[float, ...]
    branch: int

    @property
    def is_vertex(self) -> bool:
        """Whether every cell stands in a phase."""
        return "-" not in self.state

    @property
    def level(self) -> int:
        """The sum of the phases of a vertex; the number of cells at 1 if all have two phases."""
        return sum(map(int, self.state))

    def __repr__(self):
        drives = f"{number(self.low)} to {number(self.high)}"
        return f"Node({self.label}: drive {drives}, branch {self.branch})"


@dataclass(frozen=True, slots=True, eq=False)
class Transition(ByValue):
    """Transition at an end of a node.

    Attributes:
        kind: a switch or a snap.
        direction: +1 where the drive rises, -1 where it falls.
        drive: where [m], or [N] under force control.
        cells: cells whose phase differs before and after, or that are in transit before or after a
            snap.
        released: energy that a snap turns into heat [J].
        tie: whether another outcome was closer than the tolerance.
    """

    kind: TransitionKind
    direction: int
    drive: float
    cells: tuple[int, ...]
    released: float = 0.0
    tie: bool = False

    def __repr__(self):
        way = "up" if self.direction > 0 else "down"
        return f"Transition({self.kind.name} {way} at {number(self.drive)}, cells {self.cells})"


Digits = NDArray[np.uint8]


class Nodes(Sequence[Node]):
    """Nodes by number, each with a label of its own, and the drives between which they exist."""

    def __init__(self, nodes: Sequence[Node]):
        self._nodes = tuple(nodes)
        self._numbers = {node.label: number for number, node in enumerate(self._nodes)}
        self.low = np.array([node.low for node in self._nodes], float)
        self.high = np.array([node.high for node in self._nodes], float)

    @cached_property
    def branch(self) -> Ints:
        """(R,) number of the branch on which each node lies."""
        return np.array([node.branch for node in self._nodes], int)

    def label(self, number: int) -> str:
        """Label of a node."""
        return self.labels(np.array([number]))[0]

    def labels(self, numbers: Ints) -> list[str]:
        """What these nodes are called."""
        return [self._nodes[number].label for number in numbers.tolist()]

    def find(self, label: str) -> int | None:
        """Number of the node of that label; None where there is none."""
        return self._numbers.get(label)

    def phases(self, numbers: Ints) -> Digits:
        """(V, N) the phase of every cell of these vertices."""
        states = [self._nodes[number].state for number in numbers.tolist()]
        text = "".join(states).encode()
        digits = np.frombuffer(text, np.uint8).reshape(len(states), -1)
        return digits - np.uint8(ord("0"))

    @cached_property
    def vertices(self) -> Ints:
        """Numbers of the nodes with every cell in a phase, by the sum of their phases.

        Of equal sums the state with the smaller phase of the outermost cell comes first.
        """
        numbered = enumerate(self._nodes)
        vertices = sorted((x.level, x.label[::-1], k) for k, x in numbered if x.is_vertex)
        return np.array([number for *_, number in vertices], int)

    @overload
    def __getitem__(self, number: int) -> Node: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Node]: ...
    def __getitem__(self, number: int | slice) -> Node | Sequence[Node]:
        if isinstance(number, slice):
            return [self._node(k) for k in range(*number.indices(len(self)))]
        return self._node(number)

    def _node(self, number: int) -> Node:
        return self._nodes[number]

    def __len__(self) -> int:
        return len(self.low)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Nodes):
            return NotImplemented
        if not (np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high)):
            return False
        return all(map(deep_equal, self, other))

    __hash__ = None  # type: ignore[assignment]


# Actuator force and travels by state and drive.
At = Callable[[tuple[int, ...], float], tuple[float, tuple[float, ...]]]


class StateNodes(Nodes):
    """Vertices, one per state, made on demand; `codes` are the stable states, rising.

    Each is a branch of its own.
    """

    def __init__(self, states: "States", codes: Ints, low: Floats, high: Floats, at: At):
        self.states, self.codes, self.low, self.high, self._at = states, codes, low, high, at

    @cached_property
    def branch(self) -> Ints:
        """(R,) number of the branch on which each node lies."""
        return np.arange(len(self))

    def labels(self, numbers: Ints) -> list[str]:
        """What these nodes are called."""
        return self.states.labels(self.codes[numbers])

    def find(self, label: str) -> int | None:
        """Number of the node of that label; None where there is none."""
        code = self.states.code(label)
        if code is None:
            return None
        number = int(np.searchsorted(self.codes, code))
        return number if number < len(self) and self.codes[number] == code else None

    def numbers(self, codes: Ints) -> Ints:
        """Numbers of nodes by their states, which are all stable."""
        if len(self.codes) == self.states.count:
            return codes
        return np.searchsorted(self.codes, codes)

    def phases(self, numbers: Ints) -> Digits:
        """(V, N) the phase of every cell of these vertices."""
        return self.states.phases(self.codes[numbers])

    @cached_property
    def vertices(self) -> Ints:
        """Numbers of the nodes with every cell in a phase, by the sum of their phases."""
        level, last_first = np.zeros(len(self), int), np.zeros(len(self), int)
        for cell in reversed(range(len(self.states.sizes))):
            digit = self.states.digit(self.codes, cell)
            level += digit
            last_first = last_first * self.states.sizes[cell] + digit
        return np.lexsort((last_first, level))

    def _node(self, number: int) -> Node:
        number = range(len(self))[number]
        label = self.label(number)
        low, high = float(self.low[number]), float(self.high[number])
        phases = tuple(map(int, label))
        (force_low, begin), (force_high, end) = self._at(phases, low), self._at(phases, high)
        return Node(label, label, low, high, force_low, force_high, begin, end, number)


class States:
    """All states of a chain, numbered from 0 with the innermost cell as the first digit.

    `sizes` are the numbers of phases of the cells.
    """

    def __init__(self, sizes: Sequence[int]):
        self.sizes = tuple(sizes)
        self.count = math.prod(self.sizes)
        # Difference of the state number when a cell goes to its next phase.
        self.weights = [*accumulate(self.sizes[:0:-1], mul, initial=1)][::-1]

    def digit(self, codes: Ints, cell: int) -> Ints:
        """(S,) the phase of a cell in each of these states."""
        return codes // self.weights[cell] % self.sizes[cell]

    def phases(self, codes: Ints) -> Digits:
        """(S, N) the phase of every cell in each of these states."""
        phases = np.empty((len(codes), len(self.sizes)), np.uint8)
        for cell, size in reversed(list(enumerate(self.sizes))):
            codes, phases[:, cell] = np.divmod(codes, size)
        return phases

    def labels(self, codes: Ints) -> list[str]:
        """These states as strings of digits."""
        text, n = (self.phases(codes) + ord("0")).tobytes().decode(), len(self.sizes)
        return [text[k : k + n] for k in range(0, len(text), n)]

    def code(self, label: str) -> int | None:
        """The number of a state; None for what is none."""
        if len(label) != len(self.sizes) or not (label.isdecimal() and label.isascii()):
            return None
        digits = list(map(int, label))
        if any(digit >= size for digit, size in zip(digits, self.sizes, strict=True)):
            return None
        return sum(digit * weight for digit, weight in zip(digits, self.weights, strict=True))
