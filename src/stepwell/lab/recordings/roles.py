"""Which columns of a table are stroke and force, decided by names, units and numbers."""

import re
from collections.abc import Iterable, Sequence
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
        problem, command = str(error), "; or give --stroke N --force N --unit mm,N."
        whole = problem if problem.endswith(".") else problem + command
        raise Unclear(whole, table.listed()) from None


def _with_unit(column: TableColumn, given: dict[str, str]) -> TableColumn:
    """The column with the unit that the file gives elsewhere for what its name says."""
    for kind in () if column.unit else _WORDS:
        if kind in given and is_called(column.name, kind):
            return column._replace(unit=given[kind])
    return column


def is_called(name: str, kind: str) -> bool:
    """Whether a name has a word of this kind of quantity."""
    lower = name.lower().replace("_", " ")
    return any(word in lower for word in _WORDS[kind].split())


class _Table:
    def __init__(self, columns: Sequence[TableColumn], reading: Reading):
        self._columns, self._reading = list(columns), reading
        self._why: dict[int, str] = {}

    def listed(self) -> list[tuple[str, ...]]:
        """Rows of a table of all columns."""
        return [
            (f"{c.number}", c.name[:40], c.unit[:20], c.range, self._why.get(c.number, ""))
            for c in self._columns
        ]

    def taken(self, measures: list[Measure]) -> list[Taken]:
        """The recordings; raises ValueError."""
        if self._reading.units or None not in (self._reading.stroke, self._reading.force):
            measures = self._apply(measures)
        ranks = {
            kind: self._ranks(kind) for one in measures for kind in (TRAVELS[one], FORCES[one])
        }
        whole = [m for m in measures if ranks[TRAVELS[m]] and ranks[FORCES[m]]]
        if not whole:
            raise InputError(self._absent(measures, ranks))
        named = [m for m in whole if _best(ranks[TRAVELS[m]])[0] >= _HOMEMADE] or whole
        if len(named) > 1:
            raise InputError(
                "it has columns of "
                + " and of ".join(f"{TRAVELS[m]} and {FORCES[m]}" for m in named)
                + ": leave out one pair"
            )
        (measure,) = named
        kinds = TRAVELS[measure], FORCES[measure]
        travels, forces = (_best(ranks[kind])[1] for kind in kinds)
        pairs = _pairs(travels, forces)
        if not pairs:
            travels, forces = (
                self._alike(kind, some) for kind, some in zip(kinds, (travels, forces), strict=True)
            )
            pairs = _pairs(travels, forces)
        if not pairs:
            for kind, several in zip(kinds, (travels, forces), strict=True):
                if len(several) > 1:
                    raise InputError(self._both(kind, several, measures))
        times = self._times()
        # Of specimens beside each other, each may have a time of its own, to the left of it.
        before = [[t for t in times if t.number < max(x.number, y.number)] for x, y in pairs]
        own = [one[-1:] if len(pairs) > 1 else times for one in before]
        return [
            Taken(measure, x, y, next(iter(one or times), None))
            for (x, y), one in zip(pairs, own, strict=True)
        ]

    def _both(self, kind: str, several: Sequence[TableColumn], measures: Sequence[Measure]) -> str:
        words = _words(kind, measures, TRAVELS if kind in TRAVELS.values() else FORCES)
        shown = ", ".join(repr(c.label[:40]) if c.label else f"{c.number}" for c in several)
        for column in several:
            self._why[column.number] = f"may be the {kind}"
        return f"columns {shown} could both be the {words}: leave out one of them"

    def _apply(self, measures: list[Measure]) -> list[Measure]:
        """Set requested units, and leave only the measures of the requested columns."""
        reading, units = self._reading, self._reading.units
        for key, unit in (("stroke", units and units[0]), ("force", units and units[1])):
            wanted = getattr(reading, key)
            kinds = [t[m] for m in measures for t in ((TRAVELS if key == "stroke" else FORCES),)]
            for k, column in enumerate(self._columns):
                asked = wanted is not None and column is self._requested(wanted)
                blank = not column.kind and any(is_called(column.name, kind) for kind in kinds)
                if unit and (asked or (wanted is None and blank)):
                    if column.kind not in ("", UNIT_KIND[unit]):
                        raise InputError(
                            f"{column} is requested as the {key} in {unit}: give another column"
                        )
                    self._columns[k] = column._replace(unit=unit)
        allowed = list(measures)
        for key, kinds in (("stroke", TRAVELS), ("force", FORCES)):
            wanted = getattr(reading, key)
            if wanted is not None:
                column = self._requested(wanted)
                if column.values is None or not np.any(np.isfinite(column.values)):
                    raise InputError(f"{column} holds no numbers: give another one.")
                fit = [m for m in allowed if column.kind == kinds[m]]
                if not fit:
                    raise InputError(_unit_problem(column, [kinds[m] for m in allowed]))
                allowed = fit
        return allowed

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

    def _ranks(self, kind: str) -> dict[int, list[TableColumn]]:
        """Columns that may have this role, by rank."""
        key = "stroke" if kind in TRAVELS.values() else "force"
        wanted = getattr(self._reading, key)
        if wanted is not None:
            column = self._requested(wanted)
            return {_NAMED: [column]} if column.kind == kind else {}
        other = self._reading.force if key == "stroke" else self._reading.stroke
        taken = None if other is None else self._requested(other)
        ranks: dict[int, list[TableColumn]] = {}
        same = [c for c in self._columns if c.kind == kind and c.values is not None]
        for column in same:
            if column is taken:
                continue
            rank, why = _rank(column, kind, same)
            self._why[column.number] = why or f"may be the {kind}"
            if rank > _NEVER:
                ranks.setdefault(rank, []).append(column)
        return ranks

    def _alike(self, kind: str, several: list[TableColumn]) -> list[TableColumn]:
        """Columns without copies of others: strokes may differ by their zero and sign."""
        kept: list[TableColumn] = []
        travels = kind in TRAVELS.values()
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

    def _absent(
        self, measures: list[Measure], ranks: dict[str, dict[int, list[TableColumn]]]
    ) -> str:
        """Why there is no pair: no names, no unit, other units, or no such column."""
        if not any(c.name or c.unit for c in self._columns):
            return (
                f"no line above the numbers names the {len(self._columns)} columns: add one, as in "
                f"{EXAMPLE}"
            )
        x = [m for m in measures if ranks[TRAVELS[m]]]
        y = [m for m in measures if ranks[FORCES[m]]]
        if x and y:
            a, b = (_best(ranks[t[m]])[1][0] for t, m in ((TRAVELS, x[0]), (FORCES, y[0])))
            return (
                f"columns {a.label[:40]!r} in {a.unit} and {b.label[:40]!r} in {b.unit} do not "
                f"belong together: must be {PAIRS}"
            )
        missing = TRAVELS if not x else FORCES
        for kind in dict.fromkeys(missing[m] for m in measures):
            words = _HOME.get(kind, "").split()
            for column in self._columns:
                named = is_called(column.name, kind) or any(w in column.name.lower() for w in words)
                if named and not _is_other(column.name):
                    if column.kind == kind:
                        return f"{column} holds no numbers: export it again."
                    return _unit_problem(column, [kind])
        pair = next((m for m in Measure if _has(self._columns, m)), None)
        if pair is not None and pair not in measures:
            has = f"has {pair.travel} and {pair.force}, not stroke and force"
            return f"{has}: read it as an element (`load_element`, table_csv in a design file)."
        shown = ", ".join(c.name[:40] for c in self._columns if c.name) or "none"
        words = _words(missing[measures[0]], measures, missing)
        example = f"{EXAMPLE}, or {PAIRS}" if len(measures) > 1 else EXAMPLE
        return (
            f"no column for the {words} (columns: {shown}): name the columns and units as in "
            f"{example}"
        )


def _has(columns: Sequence[TableColumn], measure: Measure) -> bool:
    kinds = {c.kind for c in columns if c.values is not None}
    return {TRAVELS[measure], FORCES[measure]} <= kinds


def names_columns(fields: Sequence[str]) -> bool:
    """Whether the fields of a line are a header: two or more have a known unit or a usual name."""
    parts = [parted(field) for field in fields]
    known = [
        bool(unit in UNIT_KIND or any(is_called(name, k) for k in _WORDS)) for name, unit in parts
    ]
    return sum(known) >= 2


def _words(kind: str, measures: Sequence[Measure], table: dict[Measure, str]) -> str:
    if len(measures) == 1:
        return kind
    return " or ".join("travel" if table[m] == "stroke" else table[m] for m in measures)


def _unit_problem(column: TableColumn, kinds: Sequence[str]) -> str:
    came = f"is in {column.unit[:30]!r}" if column.unit else "has no unit"
    allowed = ", ".join(unit for kind in dict.fromkeys(kinds) for unit in FACTORS[kind])
    name = repr(column.label[:40]) if column.label else f"{column.number}"
    return (
        f"column {name} {came}: must be one of {allowed}; write it into the header or export the "
        f"data again"
    )


def _best(ranks: dict[int, list[TableColumn]]) -> tuple[int, list[TableColumn]]:
    rank = max(ranks)
    return rank, ranks[rank]


def _is_other(name: str) -> str:
    lower = name.lower().replace("_", " ")
    return next((what for words, what in _OTHER.items() if re.search(words, lower)), "")


def _rank(column: TableColumn, kind: str, same: Sequence[TableColumn]) -> tuple[int, str]:
    """How well a column with the unit of a role fits, and what it may be instead."""
    values = column.values
    assert values is not None
    good = values[np.isfinite(values)]
    if len(good) < 1:
        return _NEVER, "no numbers"
    if what := _is_other(column.name):
        return _NEVER, f"{what} by its name"
    if len(good) > 2 and np.ptp(good) == 0:
        return _STILL, "constant"
    others = [c for c in same if c is not column]
    if what := _by_numbers(good, column, others):
        return _STILL, what
    lower = column.name.lower().replace("_", " ").strip()
    if any(word in lower for word in _HOME.get(kind, "").split()):
        return _HOMEMADE, ""
    if column.unit in WEIGHTS and not is_called(column.name, kind):
        return _NEVER, "a mass that is not called a weight"
    if not is_called(column.name, kind) and lower not in _SYMBOLS[kind].split():
        return _BY_UNIT, ""
    return (_LESSER if _LESS.search(lower) and others else _NAMED), ""


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
