"""An account: what is reported of a result, before any renderer gives it a form."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import Any

from stepwell.accounts.head import About, bare, head
from stepwell.base import Columns, Schema, record

Row = Mapping[str, Any]


class Level(IntEnum):
    """The shortest form in which a part of an account is shown: a card has the least."""

    CARD = 0
    TERMINAL = 1
    PAGE = 2


@dataclass(frozen=True)
class Fact:
    """A number or a phrase by its label; without text it is not shown.

    Args:
        label: a noun, without the unit.
        text: the value with its unit, or a function that makes it where that takes time.
        level: the shortest form that has it.
    """

    label: str
    text: str | Callable[[], str]
    level: Level = Level.CARD


@dataclass(frozen=True)
class Text:
    """A paragraph; without text it is not shown."""

    text: str
    level: Level = Level.TERMINAL


@dataclass(frozen=True)
class Notes:
    """Sentences as a list; without any it is not shown."""

    lines: Sequence[str]
    level: Level = Level.TERMINAL


@dataclass(frozen=True)
class RecordTable:
    """Records as a table.

    Args:
        columns: what is shown of each record; quantities without a head are not.
        rows: makes the records, so that a table that is not shown costs nothing; or the key under
            which the account's record has them.
        wide: further columns, which pages alone have room for.
        about: how to read the table; pages alone have it.
        most: how many rows a terminal shows; None for all.
        more: what the rows are, in the plural.
        level: the shortest form that has it.
        pick: makes the rows of what the record has under the key.
    """

    columns: Columns
    rows: str | Callable[[], Sequence[Row]]
    about: str = ""
    wide: Columns = ()
    most: int | None = 40
    more: str = "rows"
    level: Level = Level.TERMINAL
    pick: Callable[[Any], Sequence[Row]] | None = None


@dataclass(frozen=True)
class Picture:
    """A figure by its name: pages show it where it was drawn.

    Args:
        name: of the figure, and of its files.
        caption: what it shows.
    """

    name: str
    caption: str
    level: Level = Level.PAGE


@dataclass(frozen=True)
class Replay:
    """The motion of the result as a replay; pages show it, or `instead` where there is none."""

    title: str
    instead: str = ""
    level: Level = Level.PAGE


@dataclass(frozen=True)
class Verbatim:
    """Text that is copied as it is, such as TOML.

    Args:
        text: what is copied.
        about: what it is.
        level: the shortest form that has it.
    """

    text: str
    about: str
    level: Level = Level.TERMINAL


Part = Text | Notes | RecordTable | Picture | Replay | Verbatim


class Section:
    """Parts under a heading; without any that is shown, the heading is not shown either.

    Args:
        heading: a noun; "" for none.
        parts: in the order in which they are read; a function makes those that take a while.
        level: the shortest form that has it.
    """

    def __init__(
        self, heading: str, *parts: Part | Callable[[], Sequence[Part]], level: Level = Level.CARD
    ) -> None:
        self.heading, self.parts, self.level = heading, parts, level

    def within(self, level: Level) -> list[Part]:
        """The parts that a form shows."""
        if self.level > level:
            return []
        made = (one() if callable(one) else (one,) for one in self.parts)
        return [part for some in made for part in some if part.level <= level]


@dataclass(frozen=True)
class Warned:
    """What a reader has to know before the numbers: every form shows it first.

    Args:
        heading: in a few words.
        text: what it means.
        lines: what it applies to, a sentence each; without any it is not shown.
    """

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
        schema: of its record.
        origin: from what it was computed, in sentences.
        answer: what the reader came for, in one sentence.
        about: the design file and the recordings that it was computed from.
        seed: of the draws; None where nothing is drawn.
        packages: that took part, besides NumPy, SciPy and Numba.
        computed: whether it was computed of a design; else its record has no provenance.
        given: quantities by name that the value does not have itself.
        facts: the numbers that matter.
        warnings: what has to be known first.
        sections: the rest, in the order in which it is read.
        hints: what to do next on the command line; the terminal alone has them.
    """

    value: Any
    title: str
    kind: str = ""
    schema: Schema = ()
    origin: str = ""
    answer: str = ""
    about: About = field(default_factory=lambda: About())
    seed: int | None = None
    packages: tuple[str, ...] = ()
    computed: bool = True
    given: Mapping[str, Any] = field(default_factory=dict)
    facts: Sequence[Fact] = ()
    warnings: Sequence[Warned] = ()
    sections: Sequence[Section] = ()
    hints: Sequence[str] = ()

    @cached_property
    def record(self) -> dict[str, Any]:
        """What JSON has of it: provenance first, then the schema's quantities."""
        first = (
            head(self.kind, self.about.design, self.seed, *self.packages)
            if self.computed
            else bare(self.kind)
        )
        given = {"calibrated": self.about.calibrated, **self.given}
        return first | record(self.schema, self.value, **given)

    def known(self, level: Level) -> dict[str, str]:
        """The facts that a form shows, by label; those without a text are left out."""
        kept = [fact for fact in self.facts if fact.level <= level]
        texts = {one.label: one.text if isinstance(one.text, str) else one.text() for one in kept}
        return {label: text for label, text in texts.items() if text}

    def rows(self, table: RecordTable) -> Sequence[Row]:
        """The rows of a table of this account."""
        if callable(table.rows):
            return table.rows()
        found = self.record[table.rows]
        return (table.pick(found) if table.pick else found) or ()
