"""The vertices a chain visits, in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Sequence:
    """States with every cell at a stop, in the order of the visit, such as 00>10>11>01>00.

    Kept as what flips from one vertex to the next, so that it stays small for long chains.

    Attributes:
        first: state at the first vertex, one character 0 or 1 a cell, inner first.
        flips: for every later vertex the cells that have changed since the one before.
    """

    first: str
    flips: tuple[tuple[int, ...], ...]

    @cached_property
    def states(self) -> tuple[str, ...]:
        """All vertices as strings."""
        state = list(self.first)
        found = [self.first]
        for flip in self.flips:
            for cell in flip:
                state[cell] = "1" if state[cell] == "0" else "0"
            found.append("".join(state))
        return tuple(found)

    def __iter__(self) -> Iterator[str]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.flips) + 1

    def __getitem__(self, index: int) -> str:
        return self.states[index]

    def __str__(self) -> str:
        return ">".join(self.states)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Sequence):
            return self.first == other.first and self.flips == other.flips
        return str(self) == other if isinstance(other, str) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.first, self.flips))

    def __repr__(self) -> str:
        if len(self.first) * len(self) > 2000:
            return f"Sequence({len(self.first)} cells, {len(self)} vertices)"
        return f"Sequence({str(self)!r})"
