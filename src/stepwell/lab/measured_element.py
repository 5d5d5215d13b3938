"""An element from a recording of a test machine: its phases, friction, noise and error band."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import (
    ByValue,
    Drawn,
    Floats,
    InputError,
    Measure,
    Quantity,
    amount,
    check,
    display_unit,
    write_csv,
)
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.lab.recordings.signs import UnclearSigns
from stepwell.mechanism import Chain, Element, Fit, fitted, sizes

# Halves of one recording describe one curve if it turns at the same travels, within this fraction
# of the travel.
_APART = 0.1
# A half shorter than this fraction of the longest one is preload or settling.
_WHOLE = 0.8
# Fewer rows do not show their noise.
_FEWEST = 12
# An element has up to ten phases.
_MOST_TURNS = 19
# Standard deviations of noise that a drop over all its rows must have to be seen in 95 % of curves.
_SEEN = 24.0


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredElement(ByValue, Drawn):
    """An element, and what the recording of its test shows of it.

    Attributes:
        element: the smooth curve with friction and error band, in the measure of the recording:
            [m] and [N] below are [rad] and [N m], or [m³] and [Pa], of another measure.
        recording: of the test.
        half: "loading", "unloading", or "both" for the mean of both.
        curve: (n, 2) travel [m] and force [N] of the points through which the curve passes.
        loading, unloading: (n, 2) travel [m] and force [N] of the used rows, with the signs and the
            zero of force of the element; empty if that half is not used.
        noise: standard deviation of the forces about the curve [N].
        step: resolution of the forces [N]; 0 if none is recognised.
        correlated: number of rows over which the noise is correlated; 0 for white noise.
        smallest_drop: of the drops that would be seen over a tenth of the travel in 95 % of
            recordings [N].
        outliers: number of replaced forces.
        approach: travel without contact that was left out [m].
        notes: what was changed, left out, or is uncertain, a sentence each.
    """

    element: Element
    recording: Recording
    half: str
    curve: Floats = field(repr=False)
    loading: Floats = field(repr=False)
    unloading: Floats = field(repr=False)
    noise: float
    step: float
    correlated: int
    smallest_drop: float
    outliers: int
    approach: float
    notes: tuple[str, ...]

    @property
    def error_band(self) -> float:
        """Largest error of the curve [N], in 95 % of curves of known shape."""
        return self.element.error_band

    @property
    def friction(self) -> float:
        """Coulomb friction [N]: half the difference between loading and unloading."""
        return self.element.friction

    @property
    def rows(self) -> int:
        """Number of used rows."""
        return len(self.loading) + len(self.unloading)

    @property
    def phases(self) -> tuple[tuple[float, float], ...]:
        """Ends of each phase [m], within the recorded travel."""
        one = self.element
        return tuple((max(p.low, one.low), min(p.high, one.high)) for p in one.phases)

    @property
    def chain(self) -> Chain:
        """The element as a chain of one cell, which a design file can hold."""
        return Chain([self.element], title=self.element.name)

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the curve as CSV in the units of reports, which `load_element` reads."""
        measure = self.element.measure
        pairs = (measure.travel, measure.travel_unit), (measure.force, measure.force_unit)
        named = [Quantity(name, display_unit(unit)[0]) for name, unit in pairs]
        write_csv(file, [*zip(named, self.curve.T, strict=True)], 10)

    def __str__(self):
        measure = self.element.measure
        unit, factor = display_unit(measure.travel_unit)
        ends = [f"{a * factor:.3g} to {b * factor:.3g} {unit}" for a, b in self.phases]
        phases = f"{len(ends)} phases: {', '.join(ends)}"
        if len(ends) == 1:
            rises = f"the {measure.force} only rises (monotone), so no snap-through"
            phases = f"1 phase, {ends[0]}: {rises}"
        noise, band = (amount(x, measure.force_unit, 2) for x in (self.noise, self.error_band))
        return f"{phases}; noise {noise}; error band {band}"

    def __repr__(self):
        return f"MeasuredElement({self.element.name!r}, {self})"


def measure_element(
    recording: Recording,
    name: str = "",
    *,
    half: str | None = None,
    noise: float | None = None,
    least_drop: float | None = None,
    stops: bool | tuple[bool, bool] = False,
) -> MeasuredElement:
    """The element in a recording of its test under displacement control.

    The noise is estimated from the recording; rises and falls that noise could have made are no
    phases. Travel before contact is left out, and its force is taken as zero. Of several cycles
    the first is used.

    Args:
        recording: travel as stroke [m], and force [N]; or volume and pressure, or angle and torque,
            of which the units below are then.
        name: of the element; by default that of the recording.
        half: "loading" or "unloading" for one of them; by default the mean of both, and friction
            from their difference, if both are recorded.
        noise: least standard deviation of the forces [N]; by default as estimated.
        least_drop: smallest drop of the force that counts as the end of a phase [N]; necessary if
            the noise is correlated, as with drift or vibration.
        stops: whether the element has stops at the low and at the high end of its curve.

    Raises:
        LabError: signs that the work does not decide, a constant stroke, a half that is not
            recorded, halves that belong to different curves, noise that could make or hide every
            phase, or a curve that is no element.
        ValueError: a number out of range, or `half` is another word.

    Source: ours (theory page, "Elements"); see `stepwell.mechanism.fitted`.
    """
    if half not in (None, "loading", "unloading"):
        raise InputError(f"half = {half!r}: must be 'loading', 'unloading' or None for both.")
    measure = recording.measure
    unit = measure.force_unit
    least = 0.0 if noise is None else check.positive("noise", noise, unit)
    drop = 0.0 if least_drop is None else check.positive("least_drop", least_drop, unit)
    _refuse_few(recording, least)
    _refuse_open_signs(recording)
    trim = not (stops if isinstance(stops, bool) else stops[0])
    try:
        halves, notes = _halves(recording, half)
        fit, friction = _fit(halves, (least, drop, trim), measure, notes)
        _refuse_many(fit, unit)
        _refuse_falling(fit, stops, measure)
        curve = _curve(fit)
        x, y = curve.T.tolist()
        named = name or recording.name
        options = {"stops": stops, "friction": friction, "measure": measure, "unusual": True}
        element = Element.from_table(x, y, named, **options)
        for slip in sizes.of_element(element):
            raise InputError(f"{slip} Check the units in the header of the file.")
    except LabError:
        raise
    except InputError as error:
        raise LabError(recording.source, str(error), flips=getattr(error, "flips", ())) from None
    begin = min(float(np.min(x)) for x, _ in halves.values())
    approach = element.low - begin if fit.offset is not None else 0.0
    notes += _remarks(fit, approach, recording)
    empty = np.zeros((0, 2))
    shown = {way: np.column_stack([x, y - (fit.offset or 0.0)]) for way, (x, y) in halves.items()}
    rows = sum(map(len, shown.values()))
    return MeasuredElement(
        replace(element, error_band=float(f"{fit.band:.3g}")),
        recording,
        "both" if len(halves) == 2 else next(iter(halves)),
        curve,
        shown.get("loading", empty),
        shown.get("unloading", empty),
        max(fit.scatter.sd, least),
        fit.scatter.step,
        fit.scatter.rows,
        _SEEN * fit.scatter.ratio * max(fit.scatter.sd, least) / max(0.1 * rows, 1.0) ** 0.5,
        fit.outliers,
        approach,
        tuple(notes),
    )


_Rows = tuple[Floats, Floats]


def _refuse_open_signs(recording: Recording) -> None:
    if other := recording.other_flip:
        why = next((line for line in recording.reading if line.startswith("signs")), "signs: open")
        raise LabError(
            recording.source,
            f"the work does not decide the signs, on which phases and energies depend ({why}): "
            f"give flip = 'none' or '{other}' (--flip none or --flip {other}).",
            flips=("none", other),
        )


def _curve(fit: Fit) -> Floats:
    """(n, 2) travel [m] and force [N] of the points of a fit, rounded."""
    force = fit.force - (fit.offset or 0.0)
    far, most = (7 - int(np.floor(np.log10(np.max(np.abs(x))))) for x in (fit.travel, force))
    return np.column_stack([np.round(fit.travel, max(far, 9)), np.round(force, most)])


def _halves(recording: Recording, half: str | None) -> tuple[dict[str, _Rows], list[str]]:
    """Travel and force of the first loading and unloading, and notes."""
    whole, notes = _whole_halves(recording), list[str]()
    if _counts_loading_negative(recording, whole[0]):
        recording = replace(recording, stroke=-recording.stroke, force=-recording.force)
        notes.append("Stroke and force are counted negative while loading: both signs are turned.")
    ways: dict[str, list[slice]] = {}
    for one in whole:
        ways.setdefault(recording.direction_of(one), []).append(one)
    if half is not None and half not in ways:
        raise LabError(
            recording.source,
            f"half = {half!r}: the recording has no such half; it has {' and '.join(ways)}.",
        )
    cycles = max(map(len, ways.values()))
    if cycles > 1:
        notes.append(f"{cycles} cycles are recorded: the first is used.")
    left = len(recording.halves) - len(whole)
    if left:
        notes.append(f"{left} shorter strokes are left out, such as preload.")
    wanted = [half] if half else sorted(ways)
    chosen = {way: ways[way][0] for way in wanted}
    # Halves share the row at which the stroke turns: it belongs to the first of them.
    rows = {way: slice(one.start + (one.start > 0), one.stop) for way, one in chosen.items()}
    return {way: (recording.stroke[one], recording.force[one]) for way, one in rows.items()}, notes


def _whole_halves(recording: Recording) -> list[slice]:
    """The halves of a recording that are about as long as its longest one."""
    spans = [float(np.ptp(recording.stroke[one])) for one in recording.halves]
    if max(spans) == 0.0:
        raise LabError(recording.source, "the stroke is constant: an element is moved.")
    both = zip(recording.halves, spans, strict=True)
    return [one for one, span in both if span >= _WHOLE * max(spans)]


def _counts_loading_negative(recording: Recording, half: slice) -> bool:
    """Whether the stroke falls in this half while work on the element is positive."""
    travel, force = recording.stroke[half], recording.force[half]
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(travel)))
    return recording.direction_of(half) == "unloading" and work > 0.0


def _fit(
    halves: dict[str, _Rows], options: tuple[float, float, bool], measure: Measure, notes: list[str]
) -> tuple[Fit, float]:
    """The curve of one half or of the mean of both, and the friction; may add notes."""
    least, drop, trim = options
    alone = trim and len(halves) == 1
    fits = {way: fitted(x, y, least, drop, alone, measure) for way, (x, y) in halves.items()}
    if len(fits) == 2:
        return _mean(halves, fits, options, measure, notes)
    return next(iter(fits.values())), 0.0


def _mean(
    halves: dict[str, _Rows],
    fits: dict[str, Fit],
    options: tuple[float, float, bool],
    measure: Measure,
    notes: list[str],
) -> tuple[Fit, float]:
    """The mean of loading and unloading, and the friction; may add notes."""
    up, down = fits["loading"], fits["unloading"]
    _refuse_unlike(up, down, measure)
    unit, force = measure.force_unit, measure.force
    low, high = max(up.travel[0], down.travel[0]), min(up.travel[-1], down.travel[-1])

    def apart(x: Floats) -> Floats:
        return 0.5 * (np.interp(x, up.travel, up.force) - np.interp(x, down.travel, down.force))

    # Force turns back over some travel at both ends.
    inner = apart(np.linspace(low + 0.1 * (high - low), high - 0.1 * (high - low), 161))
    least, friction, most = (float(q) for q in np.quantile(inner, (0.1, 0.5, 0.9)))
    error = max(up.band, down.band)
    if friction < -error:
        notes.append(
            f"Unloading is {amount(-2 * friction, unit, 2)} above loading: the {force} drifts, or "
            f"the halves are of different tests. Friction is taken as 0."
        )
    elif most - least > max(2.0 * error, 0.5 * abs(friction)):
        low_end, high_end = (amount(x, unit, 2) for x in (least, most))
        notes.append(
            f"Half the difference of loading and unloading is {low_end} to {high_end}: it is no "
            f"constant friction. The median is used; the rest is not in the element."
        )
    both: list[_Rows] = []
    for sign, way in ((1.0, "loading"), (-1.0, "unloading")):
        x, y = halves[way]
        inside = (x >= low) & (x <= high)
        both.append((x[inside], y[inside] - sign * apart(x[inside])))
    travel, mean = (np.concatenate(column) for column in zip(*both, strict=True))
    joined = fitted(travel, mean, *options, measure)
    drift = float(down.force[0] - up.force[0])
    if joined.offset is not None and abs(drift) > error:
        off = amount(drift, unit, 2)
        notes.append(f"Before contact unloading is {off} from loading: drift, or friction.")
    return joined, float(f"{friction:.3g}") if friction > 0.5 * error else 0.0


def _refuse_few(recording: Recording, noise: float) -> None:
    """Raise LabError for too few rows to show their noise, if none [N] is given."""
    if len(recording) < _FEWEST and not noise:
        raise LabError(
            recording.source,
            f"{len(recording)} rows are too few to show their noise: must be {_FEWEST} or more. "
            f"Give noise= in {recording.measure.force_unit} (--noise), or write the points into a "
            f"table.",
        )


def _refuse_many(fit: Fit, unit: str) -> None:
    """Raise ValueError for more turns than an element has: vibration."""
    if len(fit.turns) > _MOST_TURNS:
        raise InputError(
            f"the force rises and falls {len(fit.turns) + 1} times: vibration or hum is likely. "
            f"Give the smallest drop that counts as a snap, as least_drop= in {unit} "
            f"(--least-drop in {display_unit(unit)[0]})."
        )


def _refuse_falling(fit: Fit, stops: bool | tuple[bool, bool], measure: Measure) -> None:
    """Raise ValueError where the force falls at an end that has no stop."""
    given = (stops, stops) if isinstance(stops, bool) else stops
    falls = not fit.rises, fit.rises == bool(len(fit.turns) % 2)
    needed = [falls[k] or given[k] for k in (0, 1)]
    if needed != [*given]:
        ends = " and ".join(
            f"at the {word} end" for k, word in enumerate(("low", "high")) if falls[k]
        )
        word = "both" if all(needed) else ("high", "low")[needed[0]]
        named = measure.force
        other = f"else test over more {measure.travel}, or check the sign of the {named}."
        if all(falls):
            other = f"if the {named} is counted negative, give flip = 'force' (--flip force)."
        raise UnclearSigns(
            f"the {named} falls {ends} of the {measure.travel}, where an element needs a stop. If "
            f"there are stops, give stops={tuple(needed)} (--stops {word}); {other}",
            ("force",) if all(falls) else (),
        )


def _refuse_unlike(up: Fit, down: Fit, measure: Measure) -> None:
    """Raise ValueError where loading and unloading have other turns: a snap during the test."""
    places = [fit.travel[list(fit.turns)] for fit in (up, down)]
    span = float(np.ptp(up.travel))
    if len(places[0]) != len(places[1]) or np.any(np.abs(places[0] - places[1]) > _APART * span):
        each = [_listed(one, measure) for one in places]
        raise InputError(
            f"loading turns at {each[0]}, unloading at {each[1]}: their mean is no curve of one "
            f"element. It probably snapped during the test, or a half is disturbed. Use one of "
            f"them: half='loading' (--half loading)."
        )


def _listed(travels: Floats, measure: Measure) -> str:
    unit, factor = display_unit(measure.travel_unit)
    texts = [f"{one * factor:.3g}" for one in travels]
    return f"{', '.join(texts)} {unit}" if texts else f"no {measure.travel}"


def _remarks(fit: Fit, approach: float, recording: Recording) -> Sequence[str]:
    notes: list[str] = []
    measure = recording.measure
    unit, force = measure.force_unit, measure.force
    least = float(np.min(fit.changes)) if fit.turns else np.inf
    if least < 2.0 * fit.band:
        notes.append(
            f"The smallest change of {force} between turns, {amount(least, unit, 2)}, is less than "
            f"twice the error band: its phase is uncertain. Measure with less noise or more rows."
        )
    if fit.is_exact:
        notes.append(
            f"The {force} shows no noise: it is computed, or was filtered. A filter can hide a "
            f"snap."
        )
    if fit.offset is not None:
        notes.append(
            f"{amount(approach, measure.travel_unit, 3)} without contact are left out; the "
            f"{force} there, {amount(fit.offset, unit, 2)}, is taken as zero."
        )
    if fit.outliers:
        notes.append(f"Outliers of the {force}, replaced by their neighbours: {fit.outliers}.")
    if fit.scatter.step > 2.0 * fit.scatter.sd:
        notes.append(
            f"Values of {force} are multiples of {amount(fit.scatter.step, unit, 3)}, which limits "
            f"the accuracy."
        )
    if fit.scatter.rows:
        notes.append(
            f"The noise is correlated over about {fit.scatter.rows} rows (drift, vibration or a "
            f"filter): its long-run size is {fit.scatter.ratio:.2g} times that of white noise."
        )
    if not fit.rises:
        notes.append(
            f"The {force} falls first: the element begins between two phases, or the machine "
            f"counts this {force} as negative."
        )
    return [*notes, *recording.remarks]
