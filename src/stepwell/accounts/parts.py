"""An account: the content of a report on a result, before any renderer gives it a form."""

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
    TERMINAL = 1  # If there is room on a screen.
    FULL = 2  # On a terminal with --full.
    PAGE = 3


CARD, TERMINAL, FULL, PAGE = Level


@dataclass(frozen=True)
class Fact:
    """A number or a phrase with its label, a noun without the unit; shown if it has a text."""

    label: str
    text: str | Callable[[], str]
    level: Level = CARD


@dataclass(frozen=True)
class Text:
    """A paragraph, or a function that returns it; shown if it has a text."""

    text: str | Callable[[], str]
    level: Level = TERMINAL


@dataclass(frozen=True)
class Notes:
    """Sentences as a list, or in `short` on a terminal without --full; shown if there are any."""

    lines: Sequence[str]
    level: Level = TERMINAL
    short: Sequence[str] = ()


@dataclass(frozen=True)
class RecordTable:
    """Records as a table; the rows are computed when it is shown."""

    columns: Columns  # Quantities without a head are not shown.
    rows: str | Callable[[], Sequence[Row]]  # A function, or the key in the account's record.
    about: str = ""  # How to read the table; pages have it, and terminals with --full.
    wide: Columns = ()  # Further columns of pages, and of terminals with --full.
    more: str = "rows"  # A noun for the rows, where a table is cut.
    level: Level = TERMINAL
    # Returns the rows, given the value of the key in the record.
    pick: Callable[[Any], Sequence[Row]] | None = None


@dataclass(frozen=True)
class Picture:
    """A figure by the name of its files: pages show it if it was drawn."""

    name: str
    caption: str
    level: Level = PAGE


@dataclass(frozen=True)
class Replay:
    """The motion of the result as a replay; pages show it, or `instead` without a replay."""

    title: str
    instead: str = ""
    level: Level = PAGE


@dataclass(frozen=True)
class Verbatim:
    """Text that is copied as it is, such as TOML, and a noun for it."""

    text: str
    about: str
    level: Level = TERMINAL


Part = Text | Notes | RecordTable | Picture | Replay | Verbatim
# Parts by their heading, in the order in which they are read.
Sections = Mapping[str, Part | Sequence[Part]]


@dataclass(frozen=True)
class Warned:
    """A warning: every form shows it before the numbers, if it has lines."""

    heading: str
    text: str
    lines: Sequence[str]


@dataclass(frozen=True, eq=False)
class Account:
    """The report on a result.

    Args:
        value: the result.
        title: of the report.
        kind: of the record, with its version, such as "check/1"; "" without a record.
        answer: the main result, in one sentence.
        facts: the main numbers.
        sections: the rest by heading; a section is shown if one of its parts is.
        warnings: shown before the numbers.
        origin: the input of the computation, in sentences.
        hints: next steps on the command line; the terminal alone has them.
        about: the design file and the recordings from which it was computed.
        seed: of the draws; None without draws.
        packages: used packages besides NumPy, SciPy and Numba.
        computed: whether it was computed from a design; else its record has no provenance.
        given: quantities by name that are no attributes of the value.
        schema: of its record; by default `account` sets the one of its kind.
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
        """The JSON object: provenance first, then the quantities of the schema."""
        first = bare(self.kind)
        if self.computed:
            first = head(self.kind, self.about.design, self.seed, *self.packages)
        names = "calibrated", "data_sha256", "designs_sha256"
        given = {name: getattr(self.about, name) for name in names}
        return first | record(self.schema, self.value, **{**given, **self.given})

    def known(self, level: Level) -> dict[str, str]:
        """The facts that a form shows, by label; those without a text are left out."""
        texts = ((one.label, text_of(one)) for one in self.facts if one.level <= level)
        return {label: text for label, text in texts if text}

    def within(self, level: Level) -> Iterator[tuple[str, list[Part]]]:
        """The parts of each section that a form shows, with its heading."""
        for heading, parts in self.sections.items():
            every = [parts] if isinstance(parts, Part) else parts
            yield heading, [part for part in every if part.level <= level]

    def rows(self, table: RecordTable) -> Sequence[Row]:
        """The rows of a table of this account."""
        if callable(table.rows):
            return table.rows()
        value = self.record[table.rows]
        return (table.pick(value) if table.pick else value) or ()


def text_of(part: Fact | Text) -> str:
    """The text of a fact or a paragraph."""
    return part.text if isinstance(part.text, str) else part.text()


def lines_of(part: Part) -> list[str]:
    """The sentences of a paragraph or a list; none of another part."""
    lines = [text_of(part)] if isinstance(part, Text) else getattr(part, "lines", ())
    return [line for line in lines if line]
