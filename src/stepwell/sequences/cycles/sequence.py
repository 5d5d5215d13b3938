"""The vertices a chain visits, in order, and the four ways in which two cells can go round."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise

from stepwell.base import ByValue, InputError

_DIGITS = frozenset("0123456789")


@dataclass(frozen=True, eq=False)
class Sequence(ByValue):
    """States with every cell in a phase, in the order of the visit, such as 00>10>11>01>00.

    Kept as what changes from one vertex to the next, so that it stays small for long chains.

    Attributes:
        first: state at the first vertex, the phase of every cell as a digit, inner first.
        changes: for every later vertex (cell, phase) of all that have changed since the one before.
    """

    first: str
    changes: tuple[tuple[tuple[int, int], ...], ...]

    @classmethod
    def parse(cls, text: str) -> Sequence:
        """The sequence that a text such as "00>10>11>01>00" says; spaces do not count.

        Raises:
            ValueError: states that are not equally many digits.
        """
        states = text.replace(" ", "").split(">")
        if any(len(s) != len(states[0]) or not s or set(s) - _DIGITS for s in states):
            raise InputError(
                f"{text!r}: must be states with > between, each as many characters 0 or 1 as there "
                f"are cells, as in 00>10>11>01>00; of elements with more phases, their digits."
            )
        changes = tuple(
            tuple(
                (i, int(now)) for i, (was, now) in enumerate(zip(a, b, strict=True)) if was != now
            )
            for a, b in pairwise(states)
        )
        return cls(states[0], changes)

    @classmethod
    def full_cycle(cls, loading: Iterable[int], unloading: Iterable[int]) -> Sequence:
        """The cycle in which the cells load, then unload, one by one in these orders."""
        up = tuple(((cell, 1),) for cell in loading)
        return cls("0" * len(up), (*up, *(((cell, 0),) for cell in unloading)))

    @property
    def flips(self) -> tuple[tuple[int, ...], ...]:
        """For every later vertex the cells that have changed since the one before."""
        return tuple(tuple(cell for cell, _ in change) for change in self.changes)

    @property
    def orders(self) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
        """Cells in order of loading and of unloading; None unless each goes once, one by one."""
        cells, twice = len(self.first), 2 * len(self.first)
        moves = [move for change in self.changes for move in change]
        if len(self.changes) != twice or len(moves) != twice or set(self.first) != {"0"}:
            return None
        if any(phase != (k < cells) for k, (_, phase) in enumerate(moves)):
            return None
        order = tuple(cell for cell, _ in moves)
        loading, unloading = order[:cells], order[cells:]
        if len(set(loading)) < cells or len(set(unloading)) < cells:
            return None
        return loading, unloading

    @cached_property
    def states(self) -> tuple[str, ...]:
        """All vertices as strings."""
        state = list(self.first)
        found = [self.first]
        for change in self.changes:
            for cell, phase in change:
                state[cell] = str(phase)
            found.append("".join(state))
        return tuple(found)

    def __iter__(self) -> Iterator[str]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.changes) + 1

    def __getitem__(self, index: int) -> str:
        return self.states[index]

    def __str__(self) -> str:
        return ">".join(self.states)

    def __eq__(self, other: object) -> bool:
        return str(self) == other if isinstance(other, str) else super().__eq__(other)

    # It equals its text, so the two are one key.
    def __hash__(self) -> int:
        return hash(str(self))

    def __repr__(self) -> str:
        if len(self.first) * len(self) > 2000:
            return f"Sequence({len(self.first)} cells, {len(self)} vertices)"
        return f"Sequence({str(self)!r})"


class Pathway(Enum):
    """How a two-cell chain loads and unloads (Kamp et al. 2024, Fig. 2)."""

    CLOCKWISE = "00>10>11>01>00"
    COUNTERCLOCKWISE = "00>01>11>10>00"
    VIA_01 = "00>01>11>01>00"
    VIA_10 = "00>10>11>10>00"
    OTHER = "any other sequence"

    @property
    def label(self) -> str:
        """A word or two for tables and figures."""
        return {"VIA_01": "via 01", "VIA_10": "via 10"}.get(self.name, self.name.lower())

    @property
    def is_directed(self) -> bool:
        """Whether loading and unloading take different ways."""
        return self in (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)


def pathway_of(sequence: Sequence) -> Pathway | None:
    """The pathway of a full cycle of two cells; None for any other number of cells."""
    if len(sequence.first) != 2:
        return None
    text = str(sequence)
    return next((p for p in Pathway if p.value == text), Pathway.OTHER)
