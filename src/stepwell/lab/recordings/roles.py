"""Which columns of a table are stroke and force, decided by names, units and numbers."""

import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, Measure
from stepwell.lab.recordings.columns import FACTORS, UNIT_KIND, WEIGHTS, TableColumn, parted
from stepwell.lab.recordings.reading import Reading

TRAVELS = {Measure.TRAVEL: "stroke", Measure.VOLUME: "volume", Measure.ANGLE: "angle"}
FORCES = {Measure.TRAVEL: "force", Measure.VOLUME: "pressure", Measure.ANGLE: "torque"}
EXAMPLE = "Time (s), Displacement (mm), Force (N)"
PAIRS = "travel and force (mm, N), volume and pressure (mL, kPa) or angle and torque (deg, N mm)"

# Words in a name, and whole names.
_WORDS = {
    "time": "time zeit temps tiempo tempo elapsed 时间 時間",
    "stroke": "displacement stroke extension position crosshead travel weg deflection elongation "
    "deformation distance verschiebung traverse dehnung déplacement allongement course "
    "desplazamiento spostamento corsa compression disp indentation 位移 变形 行程 変位 ストローク",
    "force": "force load kraft effort fuerza forza carga carico 力 载荷 负荷 荷重",
    "volume": "volume volumen 体积",
    "pressure": "pressure druck pression presión pressione 压力 压强",
    "angle": "angle rotation twist winkel 角",
    "torque": "torque moment 扭矩",
}
_SYMBOLS = {
    "time": "t",
    "stroke": "x u d s z w δ δx dx dl Δx Δl ux uz",
    "force": "f p fz fx fy tension",
    "volume": "v δv Δv",
    "pressure": "p δp Δp",
    "angle": "θ φ theta phi",
    "torque": "m t τ",
}
_HOME = {"stroke": "length länge", "force": "weight mass gewicht masse"}
# Words of columns that are no measurement of the specimen, and what they are.
_OTHER = {
    r"set ?-?point|\bset\b|command|\bcmd\b|target|demand|desired|\bref(erence)?\b|\bsoll"
    r"|consigne|commande": "a command",
    r"\bmax|\bmin\b|minim|peak|\bpk\b|\bstd|deviation|\berr(or)?\b|uncertain|scatter"
    r"|noise": "a statistic",
    r"temp": "a temperature",
    r"transvers|lateral|width|breite|thick|dicke|diamet|radius|colou?r": "another direction "
    "or size",
    r"rate\b|veloc|speed|geschwind|vitesse": "a speed",
    r"count|cycle|index|\bno\b|number|step\b": "a count",
    r"limit|preload|pretension|threshold|gau?ge length|initial|grip": "a setting",
}
_LESS = re.compile(
    r"\braw\b|unfilter|uncorrect|absolu|\babs\b|machine|\bmean\b|average|\bavg\b|filter|smooth"
    r"|correct|strain|dehnung|deformation|compression|capteur|sensor|extensomet"
)
# Ranks of a column for a role, the best last.
_NEVER, _STILL, _BY_UNIT, _HOMEMADE, _LESSER, _NAMED = range(6)
_FEW = 4  # different values of a command that is kept


class Taken(NamedTuple):
    """Columns of one recording of a table, and why others are not."""

    measure: Measure
    travel: TableColumn
    force: TableColumn
    time: TableColumn | None
    notes: tuple[str, ...] = ()


class Unclear(InputError):
    """No reading of a table stands out.

    `rows` has the number, name, unit and range of each column, and what it may be.
    """

    def __init__(self, problem: str, rows: Sequence[tuple[str, ...]] = ()):
        super().__init__(problem)
        self.rows = tuple(rows)


def choose(
    columns: Sequence[TableColumn],
    given: dict[str, str],
    reading: Reading,
    measures: Iterable[Measure],
) -> list[Taken]:
    """The recordings of a table: one, or several with equal names beside each other.

    `given` are units by kind for columns without one.

    Raises:
        Unclear: no column, or several, may be the stroke or the force, or a unit is missing.
    """
    table = _Table([_with_unit(one, given) for one in columns], reading)
    try:
        return table.taken(list(measures))
    except InputError as error:
        weights = any("weight" in one.name.lower() or "mass" in one.name.lower() for one in columns)
        force = "g" if weights else "N"
        problem, command = str(error), f"; or give --stroke N --force N --unit mm,{force}."
        whole = problem if problem.endswith(".") else problem + command
        raise Unclear(whole, table.listed()) from None


def listed(
    columns: Sequence[TableColumn],
    given: dict[str, str],
    reading: Reading,
    measures: Iterable[Measure],
) -> list[tuple[str, ...]]:
    """Rows of a table of all columns as of `Unclear`, with the role of each that is taken."""
    table = _Table([_with_unit(one, given) for one in columns], reading)
    with suppress(InputError):
        table.name_roles(table.taken(list(measures)))
    return table.listed()


def _with_unit(column: TableColumn, given: dict[str, str]) -> TableColumn:
    """The column with the unit that the file gives elsewhere for what its name says."""
    for kind in () if column.unit else _WORDS:
        if kind in given and is_called(column.name, kind):
            return column._replace(unit=given[kind])
    return column


def is_called(name: str, kind: str) -> bool:
    """Whether a name has a word of this kind of quantity."""
    return _has_word(name, _WORDS[kind])


def _has_word(name: str, words: str) -> bool:
    lower = name.lower().replace("_", " ")
    return any(word in lower for word in words.split())


class _Side(NamedTuple):
    """The stroke or the force: its kinds of quantity, and the requested column and unit."""

    key: str
    kinds: dict[Measure, str]
    wanted: int | str | None
    unit: str | None

    def words(self, kind: str, measures: Sequence[Measure]) -> str:
        """What a column may be called: one kind, or all that these measures allow."""
        if len(measures) == 1:
            return kind
        kinds = (self.kinds[m] for m in measures)
        return " or ".join("travel" if one == "stroke" else one for one in kinds)


_Ranks = dict[int, list[TableColumn]]  # columns that may have a role, by rank


class _Table:
    def __init__(self, columns: Sequence[TableColumn], reading: Reading):
        self._columns = list(columns)
        unit, force_unit = reading.units or (None, None)
        self._sides = (
            _Side("stroke", TRAVELS, reading.stroke, unit),
            _Side("force", FORCES, reading.force, force_unit),
        )
        self._why: dict[int, str] = {}

    def listed(self) -> list[tuple[str, ...]]:
        """Rows of a table of all columns."""
        return [
            (f"{c.number}", c.name[:40], c.unit[:20], c.range, self._why.get(c.number, ""))
            for c in self._columns
        ]

    def name_roles(self, taken: Iterable[Taken]) -> None:
        """Name the roles of the columns that are taken."""
        for one in taken:
            roles = {one.measure.stroke: one.travel, one.measure.force: one.force, "time": one.time}
            for role, column in roles.items():
                if column is not None:
                    self._why[column.number] = f"the {role}"

    def taken(self, measures: list[Measure]) -> list[Taken]:
        """The recordings; raises ValueError."""
        stroke, force = self._sides
        if stroke.unit or None not in (stroke.wanted, force.wanted):
            measures = self._apply(measures)
        roles = [(side, side.kinds[m]) for m in measures for side in self._sides]
        ranks = {kind: self._ranks(side, kind) for side, kind in roles}
        measure = self._measure(measures, ranks)
        found = [_best(ranks[side.kinds[measure]]) for side in self._sides]
        pairs = _pairs(*found)
        if not pairs:
            found = [self._alike(side, some) for side, some in zip(self._sides, found, strict=True)]
            pairs = _pairs(*found)
        if not pairs:
            side, several = next(
                one for one in zip(self._sides, found, strict=True) if len(one[1]) > 1
            )
            words = side.words(side.kinds[measure], measures)
            raise InputError(self._both(side.kinds[measure], words, several))
        times = _times_of(pairs, self._times())
        return [Taken(measure, x, y, time) for (x, y), time in zip(pairs, times, strict=True)]

    def _measure(self, measures: Sequence[Measure], ranks: dict[str, _Ranks]) -> Measure:
        """The one measure of which both columns exist."""
        whole = [m for m in measures if all(ranks[side.kinds[m]] for side in self._sides)]
        if not whole:
            raise InputError(self._absent(measures, ranks))
        named = [m for m in whole if max(ranks[TRAVELS[m]]) >= _HOMEMADE] or whole
        if len(named) > 1:
            raise InputError(
                "it has columns of "
                + " and of ".join(f"{TRAVELS[m]} and {FORCES[m]}" for m in named)
                + ": leave out one pair"
            )
        return named[0]

    def _both(self, kind: str, words: str, several: Sequence[TableColumn]) -> str:
        shown = ", ".join(repr(c.label[:40]) if c.label else f"{c.number}" for c in several)
        for column in several:
            self._why[column.number] = f"may be the {kind}"
        return f"columns {shown} could both be the {words}: leave out one of them"

    def _apply(self, measures: list[Measure]) -> list[Measure]:
        """Set requested units, and leave only the measures of the requested columns."""
        for side in self._sides:
            self._set_unit(side, [side.kinds[m] for m in measures])
        for side in self._sides:
            if side.wanted is not None:
                measures = _measures_of(self._requested(side.wanted), side, measures)
        return measures

    def _set_unit(self, side: _Side, kinds: Sequence[str]) -> None:
        """Set the requested unit of the requested column, else of columns named without a unit."""
        if side.wanted is not None:
            columns = [self._requested(side.wanted)]
        else:
            blank = [c for c in self._columns if not c.kind]
            columns = [c for c in blank if any(is_called(c.name, kind) for kind in kinds)]
        if side.unit is None:
            return
        for column in columns:
            if column.kind not in ("", UNIT_KIND[side.unit]):
                raise InputError(
                    f"{column} is requested as the {side.key} in {side.unit}: give another column"
                )
            self._columns[column.number - 1] = column._replace(unit=side.unit)

    def _requested(self, wanted: int | str) -> TableColumn:
        """The column of a number or a name."""
        if isinstance(wanted, int):
            if wanted > len(self._columns):
                raise InputError(
                    f"column {wanted} is requested, and the file has {len(self._columns)}."
                )
            return self._columns[wanted - 1]
        name = wanted.strip().lower()
        exact = [c for c in self._columns if name in (c.name.lower(), c.label.strip().lower())]
        if len(exact) != 1:
            count = "no column" if not exact else f"{len(exact)} columns"
            raise InputError(f"{count} with the name {wanted[:40]!r}: give its number")
        return exact[0]

    def _ranks(self, side: _Side, kind: str) -> _Ranks:
        """Columns that may have this role, by rank."""
        if side.wanted is not None:
            column = self._requested(side.wanted)
            return {_NAMED: [column]} if column.kind == kind else {}
        taken = {self._requested(s.wanted).number for s in self._sides if s.wanted is not None}
        ranks: _Ranks = {}
        same = [c for c in self._columns if c.kind == kind and c.values is not None]
        for column in same:
            if column.number in taken:
                continue
            rank, why = _rank(column, kind, same)
            self._why[column.number] = why or f"may be the {kind}"
            if rank > _NEVER:
                ranks.setdefault(rank, []).append(column)
        return ranks

    def _alike(self, side: _Side, several: list[TableColumn]) -> list[TableColumn]:
        """Columns without copies of others: strokes may differ by their zero and sign."""
        kept: list[TableColumn] = []
        travels = side.key == "stroke"
        for column in several:
            twin = next((c for c in kept if _same(c.si, column.si, travels)), None)
            if twin is None:
                kept.append(column)
                continue
            first, second = twin, column
            if travels and _start(column.si) < 0.5 * _start(twin.si):
                kept[kept.index(twin)] = column
                first, second = column, twin
            self._why[second.number] = f"the same as column {first.number}"
        return kept

    def _times(self) -> list[TableColumn]:
        """Columns of time, the best: if possible named, and never falling."""
        every = [c for c in self._columns if c.kind == "time" and c.values is not None]
        some = [c for c in every if c.values is not None and _rises(c.values)] or every
        named = [c for c in some if is_called(c.name, "time") or c.name.lower() == "t"] or some
        plain = [c for c in named if "cycle" not in c.name.lower()]
        return plain or named

    def _absent(self, measures: Sequence[Measure], ranks: dict[str, _Ranks]) -> str:
        """Why there is no pair: no names, no unit, other units, or no such column."""
        if not any(c.name or c.unit for c in self._columns):
            return (
                f"no line above the numbers names the {len(self._columns)} columns: add one, as in "
                f"{EXAMPLE}"
            )
        kinds = [[side.kinds[m] for m in measures if ranks[side.kinds[m]]] for side in self._sides]
        if all(kinds):
            a, b = (_best(ranks[some[0]])[0] for some in kinds)
            return (
                f"columns {a.label[:40]!r} in {a.unit} and {b.label[:40]!r} in {b.unit} do not "
                f"belong together: must be {PAIRS}"
            )
        side = self._sides[1 if kinds[0] else 0]
        return (
            self._of_other_unit(side.kinds[m] for m in measures)
            or self._of_other_pair(measures)
            or self._of_other_names(side, measures)
        )

    def _of_other_unit(self, kinds: Iterable[str]) -> str:
        """The problem of the first column whose name is that of such a kind; empty for none."""
        for kind in dict.fromkeys(kinds):
            words = f"{_WORDS[kind]} {_HOME.get(kind, '')}"
            for column in self._columns:
                if _has_word(column.name, words) and not _is_other(column.name):
                    if column.kind == kind:
                        return f"{column} holds no numbers: export it again."
                    return _unit_problem(column, [kind])
        return ""

    def _of_other_pair(self, measures: Sequence[Measure]) -> str:
        """The problem of a table of another pair of quantities; empty if it is none."""
        kinds = {c.kind for c in self._columns if c.values is not None}
        pair = next((m for m in Measure if {TRAVELS[m], FORCES[m]} <= kinds), None)
        if pair is None or pair in measures:
            return ""
        has = f"has {pair.travel} and {pair.force}, not stroke and force"
        return (
            f"{has}: read it as an element, with `stepwell lab element` and the name of this file."
        )

    def _of_other_names(self, side: _Side, measures: Sequence[Measure]) -> str:
        shown = ", ".join(c.name[:40] for c in self._columns if c.name) or "none"
        words = side.words(side.kinds[measures[0]], measures)
        example = f"{EXAMPLE}, or {PAIRS}" if len(measures) > 1 else EXAMPLE
        return (
            f"no column for the {words} (columns: {shown}): name the columns and units as in "
            f"{example}"
        )


def _measures_of(column: TableColumn, side: _Side, measures: list[Measure]) -> list[Measure]:
    """The measures of a requested column, of which there must be one."""
    if column.values is None or not np.any(np.isfinite(column.values)):
        raise InputError(f"{column} holds no numbers: give another one.")
    fit = [m for m in measures if column.kind == side.kinds[m]]
    if not fit:
        raise InputError(_unit_problem(column, [side.kinds[m] for m in measures]))
    return fit


def names_columns(fields: Sequence[str]) -> bool:
    """Whether the fields of a line are a header: two or more have a known unit or a usual name."""
    parts = [parted(field) for field in fields]
    known = [
        bool(unit in UNIT_KIND or any(is_called(name, k) for k in _WORDS)) for name, unit in parts
    ]
    return sum(known) >= 2


def _unit_problem(column: TableColumn, kinds: Sequence[str]) -> str:
    came = f"is in {column.unit[:30]!r}" if column.unit else "has no unit"
    allowed = ", ".join(unit for kind in dict.fromkeys(kinds) for unit in FACTORS[kind])
    name = repr(column.label[:40]) if column.label else f"{column.number}"
    return (
        f"column {name} {came}: must be one of {allowed}; write it into the header or export the "
        f"data again"
    )


def _best(ranks: _Ranks) -> list[TableColumn]:
    return ranks[max(ranks)]


def _is_other(name: str) -> str:
    lower = name.lower().replace("_", " ")
    return next((what for words, what in _OTHER.items() if re.search(words, lower)), "")


def _rank(column: TableColumn, kind: str, same: Sequence[TableColumn]) -> tuple[int, str]:
    """How well a column with the unit of a role fits, and what it may be instead."""
    values = column.values
    assert values is not None
    good = values[np.isfinite(values)]
    others = [c for c in same if c is not column]
    if len(good) < 1:
        return _NEVER, "no numbers"
    if what := _is_other(column.name):
        return _NEVER, f"{what} by its name"
    if len(good) > 2 and np.ptp(good) == 0:
        return _STILL, "constant"
    if what := _by_numbers(good, column, others):
        return _STILL, what
    return _rank_by_name(column, kind, alone=not others)


def _rank_by_name(column: TableColumn, kind: str, alone: bool) -> tuple[int, str]:
    """The same for a column of measured numbers, by its name."""
    if _has_word(column.name, _HOME.get(kind, "")):
        return _HOMEMADE, ""
    called = is_called(column.name, kind)
    if not called and kind != "time" and is_called(column.name, "time"):
        return _NEVER, "a time by its name"
    if column.unit in WEIGHTS and not called:
        return _NEVER, "a mass that is not called a weight"
    lower = column.name.lower().replace("_", " ").strip()
    if not called and lower not in _SYMBOLS[kind].split():
        return _BY_UNIT, ""
    return (_NAMED if alone or not _LESS.search(lower) else _LESSER), ""


def _by_numbers(good: Floats, column: TableColumn, others: Sequence[TableColumn]) -> str:
    """What a column may be if its numbers are no measurement: a command, a maximum."""
    if not others or len(good) < 20:
        return ""
    if (
        len(np.unique(good))
        <= _FEW
        < max(len(np.unique(c.values)) for c in others if c.values is not None)
    ):
        return "steps of a command"
    for other in others:
        if other.values is None or len(other.values) != len(good):
            continue
        most = np.maximum.accumulate(np.nan_to_num(other.si))
        if not np.array_equal(column.si, other.si) and np.allclose(
            column.si, most, rtol=1e-9, atol=0
        ):
            return f"the maximum so far of column {other.number}"
    return ""


def _start(values: Floats) -> float:
    good = values[np.isfinite(values)]
    return abs(float(good[0])) if len(good) else 0.0


def _rises(values: Floats) -> bool:
    good = values[np.isfinite(values)]
    return len(good) > 0 and bool(np.all(np.diff(good) >= 0))


def _same(a: Floats, b: Floats, moved: bool) -> bool:
    """Whether two columns are equal; with `moved` to 0.5 % after a shift or a change of sign."""
    good = np.isfinite(a) & np.isfinite(b)
    if not np.any(good) or np.count_nonzero(good) < 0.9 * max(
        np.count_nonzero(np.isfinite(a)), np.count_nonzero(np.isfinite(b))
    ):
        return False
    a, b = a[good], b[good]
    if not moved:
        return bool(np.allclose(a, b, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(a), initial=0))))
    near = 0.005 * float(np.ptp(a))
    return any(np.ptp(a - sign * b) <= near for sign in (1, -1))


def _pairs(
    travels: Sequence[TableColumn], forces: Sequence[TableColumn]
) -> list[tuple[TableColumn, TableColumn]]:
    """The one pair, or the pairs of equal names beside each other; empty if neither."""
    if len(travels) == len(forces) == 1:
        return [(travels[0], forces[0])]
    if len(travels) != len(forces):
        return []
    pairs = [(x, y) for x, y in zip(travels, forces, strict=True)]
    ordered = [min(x.number, y.number) for x, y in pairs] + [10**9]
    apart = all(
        max(x.number, y.number) < after
        for (x, y), (_, after) in zip(pairs, pairwise(ordered), strict=True)
    )
    names = [
        {re.sub(r"[\W_]*\d*$", "", c.name.lower()) for c in some} for some in (travels, forces)
    ]
    return pairs if apart and all(len(one) == 1 for one in names) else []


def _times_of(
    pairs: Sequence[tuple[TableColumn, TableColumn]], times: Sequence[TableColumn]
) -> list[TableColumn | None]:
    """The time of each pair: of pairs beside each other, the last one to the left of it."""
    best = next(iter(times), None)
    if len(pairs) == 1:
        return [best]
    before = ([t for t in times if t.number < max(x.number, y.number)] for x, y in pairs)
    return [one[-1] if one else best for one in before]
