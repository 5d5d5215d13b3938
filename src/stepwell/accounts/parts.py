"""An account: what is reported of a result, before any renderer gives it a form."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import Any

from stepwell.accounts.head import About, Row, bare, head
from stepwell.base import Columns, Schema, record


class Level(IntEnum):
    """The shortest form in which a part of an account is shown: a card has the least."""

    CARD = 0
    TERMINAL = 1
    PAGE = 2


CARD, TERMINAL, PAGE = Level


@dataclass(frozen=True)
class Fact:
    """A number or a phrase by its label, a noun without the unit; without text it is not shown."""

    label: str
    text: str | Callable[[], str]
    level: Level = CARD


@dataclass(frozen=True)
class Text:
    """A paragraph, or a function where it takes time; without text it is not shown."""

    text: str | Callable[[], str]
    level: Level = TERMINAL


@dataclass(frozen=True)
class Notes:
    """Sentences as a list; without any it is not shown."""

    lines: Sequence[str]
    level: Level = TERMINAL


@dataclass(frozen=True)
class RecordTable:
    """Records as a table, made when it is shown."""

    columns: Columns  # Quantities without a head are not shown.
    rows: str | Callable[[], Sequence[Row]]  # A function, or the key in the account's record.
    about: str = ""  # How to read the table; pages alone have it.
    wide: Columns = ()  # Further columns, which pages alone have room for.
    most: int | None = 40  # How many rows a terminal shows; None for all.
    more: str = "rows"  # What the rows are: of cut cards, and of pages where `about` is empty.
    level: Level = TERMINAL
    # Makes the rows of what the record has under the key.
    pick: Callable[[Any], Sequence[Row]] | None = None


@dataclass(frozen=True)
class Picture:
    """A figure by the name of its files: pages show it where it was drawn."""

    name: str
    caption: str
    level: Level = PAGE


@dataclass(frozen=True)
class Replay:
    """The motion of the result as a replay; pages show it, or `instead` where there is none."""

    title: str
    instead: str = ""
    level: Level = PAGE


@dataclass(frozen=True)
class Verbatim:
    """Text that is copied as it is, such as TOML, and what it is."""

    text: str
    about: str
    level: Level = TERMINAL


Part = Text | Notes | RecordTable | Picture | Replay | Verbatim
# Parts by their heading, in the order in which they are read.
Sections = Mapping[str, Part | Sequence[Part]]


@dataclass(frozen=True)
class Warned:
    """What a reader has to know before the numbers: every form shows it first, if it has lines."""

    heading: str
    text: str
    lines: Sequence[str]


@dataclass(frozen=True, eq=False)
class Account:
    """All that is reported of a result.

    Args:
        value: the result.
        title: what the result is of.
        kind: of the record, with its version, such as "check/1"; "" where there is no record.
        answer: what the reader came for, in one sentence.
        facts: the numbers that matter.
        sections: the rest by its headings; one of which no part is shown is not shown either.
        warnings: what has to be known first.
        origin: from what it was computed, in sentences.
        hints: what to do next on the command line; the terminal alone has them.
        about: the design file and the recordings that it was computed from.
        seed: of the draws; None where nothing is drawn.
        packages: that took part, besides NumPy, SciPy and Numba.
        computed: whether it was computed of a design; else its record has no provenance.
        given: quantities by name that the value does not have itself.
        schema: of its record; `account` sets that of its kind by default.
    """

    value: Any
    title: str
    kind: str = ""
    answer: str = ""
    facts: Sequence[Fact] = ()
    sections: Sections = field(default_factory=dict)
    warnings: Sequence[Warned] = ()
    origin: str = ""
    hints: Sequence[str] = ()
    about: About = field(default_factory=About)
    seed: int | None = None
    packages: Sequence[str] = ()
    computed: bool = True
    given: Mapping[str, Any] = field(default_factory=dict)
    schema: Schema = ()

    @cached_property
    def record(self) -> dict[str, Any]:
        """What JSON has of it: provenance first, then the schema's quantities."""
        first = bare(self.kind)
        if self.computed:
            first = head(self.kind, self.about.design, self.seed, *self.packages)
        given = {"calibrated": self.about.calibrated, **self.given}
        return first | record(self.schema, self.value, **given)

    def known(self, level: Level) -> dict[str, str]:
        """The facts that a form shows, by label; those without a text are left out."""
        texts = {one.label: text_of(one) for one in self.facts if one.level <= level}
        return {label: text for label, text in texts.items() if text}

    def within(self, level: Level) -> Iterator[tuple[str, list[Part]]]:
        """The parts of each section that a form shows, with its heading."""
        for heading, parts in self.sections.items():
            every = [parts] if isinstance(parts, Part) else parts
            yield heading, [part for part in every if part.level <= level]

    def rows(self, table: RecordTable) -> Sequence[Row]:
        """The rows of a table of this account."""
        if callable(table.rows):
            return table.rows()
        found = self.record[table.rows]
        return (table.pick(found) if table.pick else found) or ()


def text_of(part: Fact | Text) -> str:
    """The text of a fact or a paragraph."""
    return part.text if isinstance(part.text, str) else part.text()
