"""Recordings sorted into series: repeats of one mechanism, with their friction baseline."""

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import PurePath
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, ByValue, Floats, counted, grouped, to_unit
from stepwell.lab.recordings import recording as recorded
from stepwell.lab.recordings.curve import Curve, from_zero, mean_curve, rms
from stepwell.lab.recordings.read import natural
from stepwell.lab.recordings.recording import LabError, Recording, Setup
from stepwell.lab.recordings.recording_warnings import missing, recording_warnings, unlike, unusable
from stepwell.lab.rig import judged, path_of, predicted_force, quiet_zones
from stepwell.mechanism import Band, Cell, Chain
from stepwell.statics import Path

Geometry = tuple[float, float]

# Two readings count as different from this ratio of their errors on.
LEAST_ERROR_RATIO = 1.25
# Range of a baseline's stroke, over the stroke of the series.
_COVER = (0.97, 1.1)
# Bounds of a band's force over the model's force; near a bound the count of bands is doubtful.
_STRONG, _WEAK, _NEAR_BOTH = 1.4, 0.7, 0.1
# Repeats whose forces differ by more than this factor have different bands; the number of bands in
# a name of a file or folder, such as "2bands" or "2 bands".
_APART = 1.3
_SAID = re.compile(r"(?<![\d.])([1-9])[ _-]?bands?(?![a-z])", re.IGNORECASE)
TENSION_TEST = re.compile(r"band|rubber|samp", re.IGNORECASE)
# Bounds of a recording's stroke over the design's stroke. The last one is the least stroke of a
# repeat over the longest repeat: a mean curve ends where its shortest run ends.
_LEAST, _MOST, _REPEAT = 0.5, 1.5, 0.9
# With three repeats or more, a repeat is dropped if its deviation from the median curve exceeds 5
# times the median deviation and 10 % of the force range. In the recordings published with the
# paper the largest deviation is 7 times the median and 6 %: that is rubber, and is kept.
_REPEATS, _ODD, _ODD_SHARE = 3, 5.0, 0.1
_NAMED_CELLS = re.compile(r"([12])unit")


@dataclass(frozen=True, eq=False)
class Series(ByValue):
    """Repeats of one test: recordings, their baseline and the model of the tested chain.

    Attributes:
        name: configuration, number of bands, direction.
        code: the configuration, as in the file names.
        chain: the model of what was tested, one cell or two.
        bands: number of bands on each cell, where names leave it open; 1 for a design as given.
        unloading: whether the stroke falls.
        baseline: runs of the same rig without a band; empty without a baseline.
        notes: recordings that were used or dropped, and irregularities.
    """

    name: str
    code: str
    chain: Chain
    bands: int
    unloading: bool
    recordings: tuple[Recording, ...] = field(repr=False)
    baseline: tuple[Recording, ...] = field(repr=False)
    notes: tuple[str, ...] = field(repr=False)

    @cached_property
    def curve(self) -> Curve:
        """Mean of the repeats without `damaged` ones, strokes counted from state 0."""
        sound = [run for run in self.recordings if run.source not in self.damaged]
        return mean_curve(sound, self.chain.full_stroke)

    @cached_property
    def damaged(self) -> dict[str, str]:
        """Repeats that are left out of the mean, by source, with the reason.

        A single repeat far from the median of three or more has another cause: a slipped band or
        a jam.
        """
        if len(self.recordings) < _REPEATS:
            return {}
        each = mean_curve(self.recordings, self.chain.full_stroke).runs
        middle = np.median(each, axis=0)
        far = np.array([rms(force - middle) for force in each])
        usual = float(np.median(far))
        most = max(_ODD * usual, _ODD_SHARE * float(np.ptp(middle)))
        return {
            run.source: f"{off:.2g} N off the median of the repeats, theirs {usual:.2g} N"
            for run, off in zip(self.recordings, far, strict=True)
            if off > most
        }

    @cached_property
    def baseline_curve(self) -> Curve | None:
        """Mean of the baseline; None without a baseline."""
        return mean_curve(self.baseline, self.chain.full_stroke) if self.baseline else None

    @property
    def scale(self) -> float:
        """k r [N]: stiffness of all bands of the innermost cell, times its lever."""
        cell = self.chain.levers[0]
        return sum(band.stiffness for band in cell.bands) * cell.lever

    @property
    def geometry(self) -> Geometry:
        """d = q - p of the innermost cell [m], the same for all series of one geometry."""
        return geometry_of(self.chain.levers[0])

    @cached_property
    def path(self) -> Path:
        """Path of the chain over the full stroke, in the direction of the recordings."""
        return path_of(self.chain, self.unloading)

    @property
    def quiet(self) -> list[tuple[float, float]]:
        """Ranges of stroke at both ends where the force is that of the rig [m]."""
        return quiet_zones(self.chain.full_stroke, self.unloading)

    def placed(self, run: Recording) -> Floats:
        """Strokes of a run, counted from state 0 [m]."""
        return from_zero(run, self.chain.full_stroke)

    def net(self, stroke: Floats, force: Floats) -> Floats:
        """Forces (n,) less the baseline's [N], at strokes (n,) from state 0 on [m].

        The model of a single cell contains the weight of its design, so that weight is kept.
        """
        base = self.baseline_curve
        if base is None:
            return force
        single = len(self.chain) == 1 and not self.chain.elements
        weight = carried(self.chain.levers[0], stroke) if single else 0.0
        return force - base.at(stroke) + weight

    def judged(self) -> Bools:
        """Mask (n,) of the judged strokes in the mean curve of one cell."""
        return judged(self.curve.stroke, self.quiet)

    def __repr__(self):
        return f"Series({self.name}: {len(self.recordings)} runs)"


@dataclass(frozen=True, eq=False)
class Sorted(ByValue):
    """All series of a batch in the order of their files, and a note for each unused recording."""

    series: tuple[Series, ...]
    notes: tuple[str, ...]


def geometry_of(cell: Cell) -> Geometry:
    """d = q - p of a cell [m], rounded so that equal geometries compare equal."""
    dx, dy = cell.bands[0].d
    return round(dx, 9), round(dy, 9)


def carried(cell: Cell, travel: Floats) -> Floats:
    """Load of a cell [N] at travels (n,) [m], held to its stops; zero without a load."""
    if cell.load is None:
        return np.zeros(len(travel))
    return np.interp(np.clip(travel, 0.0, cell.full_travel), cell.load.travel, cell.load.force)


def over_geometries(errors: Iterable[tuple[Geometry, float]]) -> float:
    """Mean over the geometries of the mean of each one's errors; NaN for none."""
    each = grouped(errors).values()
    return float(np.mean([np.mean(v) for v in each])) if each else math.nan


def paper_cell(bands: int = 1) -> Cell:
    """The paper's unit cell with its published stiffness and rest length."""
    return Cell(Band(p=(-0.010, 0.0), q=(0.010, 0.0), stiffness=28.5 * bands))


def sort_series(
    recordings: Sequence[Recording],
    designs: Sequence[Chain] = (),
    *,
    baseline: Sequence[Recording] | None = None,
    as_designed: bool = False,
) -> Sorted:
    """Sort recordings into series.

    A name such as 1unit_MLT_3 or 2unit_TMTBM_5 gives the anchors. The design with that number of
    cells gives the rest; without one, the paper's cell does. The number of bands is that in the
    name of the file or its folder ("2 bands"), or else estimated from the force over that of the
    design with its own number. Other names need one design, which is used unchanged; repeats with
    a clearly different force are then a series apart.

    Args:
        recordings: loading or unloading tests, baselines and others among them.
        designs: the tested chains, or what the names leave open.
        baseline: runs without a band; empty for none. By default they are found by name, with about
            the same stroke and the same direction, from the same folder where possible.
        as_designed: use the design unchanged and ignore the names, as for a design of elements.

    Raises:
        LabError: there is no series, or several designs for recordings without a configuration.
    """
    as_designed = as_designed or any(chain.elements for chain in designs)
    own, tests = _baselines_and_tests(recordings, baseline)
    gaps = missing(recordings)
    groups, notes = _grouped(tests, designs, as_designed)
    series: list[Series] = []
    for (_, stem, unloading), runs in groups.items():
        setup = None if as_designed else recorded.setup_of(stem + "_1")
        sorted_series, lines = _series(_Group(stem, setup, unloading, runs, own, gaps), designs)
        series += sorted_series
        notes += lines
    if not series:
        why = "; ".join(notes[:3]) or "no recording in it"
        raise LabError("data", f"no series to compare: {why}.")
    return Sorted(tuple(series), (*notes, *_baseline_lines(series, own, gaps)))


def _baselines_and_tests(
    recordings: Sequence[Recording], given: Sequence[Recording] | None
) -> tuple[list[Recording], list[Recording]]:
    """Halves of the baselines, by default of those named so, and the other recordings."""
    named = [r for r in recordings if recorded.is_baseline(r.name)]
    own = [part for recording in (named if given is None else given) for part in _parts(recording)]
    used = {recording.source for recording in own}
    return own, [r for r in recordings if not (r.source in used or recorded.is_baseline(r.name))]


def _grouped(
    recordings: Sequence[Recording], designs: Sequence[Chain], as_designed: bool
) -> tuple[dict[tuple[str, str, bool], list[Recording]], list[str]]:
    """Halves of recordings by folder, stem and direction, and reasons for the ones left out."""
    groups: dict[tuple[str, str, bool], list[Recording]] = defaultdict(list)
    notes: list[str] = []
    tension: dict[str, int] = defaultdict(int)
    for recording in recordings:
        setup = None if as_designed else recorded.setup_of(recording.name)
        nameless = setup is None and not as_designed
        if nameless and TENSION_TEST.search(recording.name):
            tension[recording.group] += 1
        elif nameless and _NAMED_CELLS.match(recording.name):
            notes.append(f"{recording.source}: left out, its name has unknown letters")
        elif nameless and not designs:
            why = "its name contains no configuration: give a design"
            notes.append(f"{recording.source}: left out, {why}")
        elif setup is not None and setup.marked:
            notes.append(f"{recording.source}: left out, it is marked {setup.marked!r} in its name")
        elif why := unusable(recording):
            notes.append(f"{recording.source}: left out, {why}")
        else:
            for part in _parts(recording):
                way = part.direction == "unloading"
                groups[recording.group, recorded.stem_of(recording.name), way].append(part)
    read = "tension tests left out; `stepwell lab band` reads them"
    return groups, notes + [f"{group}: {count} {read}" for group, count in tension.items()]


def _baseline_lines(
    series: Sequence[Series], own: Sequence[Recording], gaps: dict[str, str]
) -> list[str]:
    """Irregularities of the baselines of series, and baselines that no series uses."""
    families = {tuple(run.source for run in one.baseline): one.baseline for one in series}
    odd = [f"baseline {line}" for runs in families.values() for line in _odd_lines(runs, gaps)]
    taken = {recording.source for one in series for recording in one.baseline}
    return odd + [
        f"{source}: a baseline that no series uses (other stroke or direction)"
        for source in dict.fromkeys(r.source for r in own if r.source not in taken)
    ]


class _Group(NamedTuple):
    """Runs of one stem and one direction, the setup in their names, and all baselines."""

    stem: str
    setup: Setup | None
    unloading: bool
    runs: list[Recording]
    baselines: list[Recording]
    gaps: dict[str, str]

    def base(self, run: Recording) -> list[Recording]:
        """The best matching group of baselines: same direction, about the same stroke."""
        span = float(np.ptp(run.stroke))
        families: dict[tuple[str, str], list[Recording]] = defaultdict(list)
        for other in self.baselines:
            ratio = float(np.ptp(other.stroke)) / span if span else 0.0
            falls = other.direction == "unloading"
            if falls == self.unloading and _COVER[0] <= ratio <= _COVER[1]:
                families[other.group, recorded.stem_of(other.name)].append(other)

        def far(family: list[Recording]) -> tuple[bool, float]:
            elsewhere = PurePath(family[0].group).parent != PurePath(run.group).parent
            return elsewhere, abs(float(np.mean([np.ptp(r.stroke) for r in family])) / span - 1)

        return min(families.values(), key=far, default=[])

    def series(
        self,
        name: str,
        chain: Chain,
        bands: int,
        mine: list[Recording],
        base: list[Recording],
        notes: Sequence[str] = (),
    ) -> Series:
        names = ", ".join(run.name for run in base) or "none found, so friction is not subtracted"
        series = Series(
            f"{name}, {'unloading' if self.unloading else 'loading'}",
            self.stem if self.setup is None else self.setup.code,
            chain,
            bands,
            self.unloading,
            tuple(mine),
            tuple(base),
            (),
        )
        lines = [
            f"runs: {', '.join(run.name for run in mine)}",
            f"baseline: {names}",
            *_odd_lines(mine, self.gaps),
            *(
                f"{PurePath(source).stem}: not in the mean, its force is {why}"
                for source, why in series.damaged.items()
            ),
        ]
        return replace(series, notes=(*lines, *notes))


def _series(group: _Group, designs: Sequence[Chain]) -> tuple[list[Series], list[str]]:
    """Series of one stem, and a note for every unused run."""
    if group.setup is not None:
        return _series_of_names(group, group.setup, designs)
    if len(designs) != 1:
        raise LabError(
            group.runs[0].source,
            f"its name contains no configuration, and {len(designs)} designs are given: give only "
            f"the tested design.",
        )
    whole, left_out = _over_stroke(group.runs, designs[0])
    if not whole:
        return [], left_out
    base = group.base(whole[0])
    single = group.series("", designs[0], 1, whole, base)
    own, *others = _design_first([(_ratio(single, run), run) for run in whole])
    kept = [run for run in whole if any(run is mine for _, mine in own)]
    notes = ["configuration: that of the design"]
    series = [group.series(group.stem, designs[0], 1, kept, base, notes)]
    for cluster in others:
        times = f"{_median(cluster):.2f} times the force"
        apart = (
            f"{times} of the design, the other repeats {_median(own):.2f} times: check the number "
            "of bands"
        )
        name, runs = f"{group.stem}, {times}", [run for _, run in cluster]
        series.append(group.series(name, designs[0], 1, runs, base, [*notes, apart]))
    return series, left_out


def _series_of_names(
    group: _Group, setup: Setup, designs: Sequence[Chain]
) -> tuple[list[Series], list[str]]:
    """Series of one stem with anchors in its names, one for each number of bands."""
    cells = [
        cell.with_anchors(p, q)
        for cell, (p, q) in zip(_template(len(setup.anchors), designs), setup.anchors, strict=True)
    ]
    slack = [k for k, cell in enumerate(cells, 1) if all(np.allclose(b.d, 0.0) for b in cell.bands)]
    if slack:
        listed = ", ".join(map(str, slack))
        rather = _best_anchor_text(cells, slack[0] - 1, group.unloading, group.runs)
        return [], [
            f"{run.source}: left out, by its name p and q of cell {listed} coincide, so a band has "
            f"no effect{rather}: rename the file, or give the design and --as-designed"
            for run in group.runs
        ]
    runs, left_out = _over_stroke(group.runs, Chain(cells))
    if not runs:
        return [], left_out
    base = group.base(runs[0])
    single = group.series("", Chain(cells), 1, runs, base)
    own = max(len(cell.bands) for cell in cells)
    ratios = [(own * _ratio(single, run), run) for run in runs]
    series: list[Series] = []
    for bands, mine, ratio in _by_bands(ratios):
        chain = Chain([_with_bands(cell, bands / own) for cell in cells])
        said = sum(_said(run) == bands for run in mine) == len(mine)
        lines = [f"{counted(bands, 'band')}, by the names"] if said else _band_lines(bands, ratio)
        name = f"{setup.code}, {counted(bands, 'band')}"
        series.append(group.series(name, chain, bands, mine, base, lines))
    return series, left_out


def _band_lines(bands: int, ratio: float) -> list[str]:
    """Notes on the number of bands, estimated from the force over that of one band."""
    lines = [f"{counted(bands, 'band')}, estimated from the force: {ratio:.2f} times that of one"]
    if ratio < 0:
        lines.append("the force pushes where the model pulls: check the sign of the force")
    for other, most in ((bands - 1, bands - 1), (bands + 1, bands)):
        # Near where one more or one less would be taken.
        if other and abs(ratio / (_STRONG * most) - 1.0) < _NEAR_BOTH:
            lines.append(f"{counted(other, 'band')} is possible too: check how many were mounted")
    if 0 <= ratio < _WEAK:
        lines.append("that is weak for a band: check which band was mounted")
    return lines


def _best_anchor_text(cells: list[Cell], odd: int, unloading: bool, runs: list[Recording]) -> str:
    """Text on the anchor q of a cell that fits the forces best, of all that names can encode."""
    chain = Chain(cells)
    usable = [run for run in _over_stroke(runs, chain)[0] if not unusable(run)]
    if not usable:
        return ""
    curve = mean_curve(usable, chain.full_stroke)
    use = judged(curve.stroke, quiet_zones(chain.full_stroke, unloading))
    p = cells[odd].bands[0].p
    errors: list[tuple[float, tuple[float, float]]] = []
    for q in recorded.PLACES:
        if np.allclose(p, q):
            continue
        tried = [cell.with_anchors(p, q) if k == odd else cell for k, cell in enumerate(cells)]
        model = predicted_force(Chain(tried), unloading, curve.stroke[use])
        columns = np.stack([model, np.ones(len(model))], axis=1)
        scale_and_offset = np.linalg.lstsq(columns, curve.force[use], rcond=None)[0]
        if scale_and_offset[0] > 0:
            errors.append((rms(columns @ scale_and_offset - curve.force[use]), q))
    if len(errors) < 2:
        return ""
    (best, at), (next_best, at_next) = sorted(errors)[:2]
    one, other = (f"({to_unit(x, 'mm'):g}, {to_unit(y, 'mm'):g})" for x, y in (at, at_next))
    times = next_best / max(best, 1e-9)
    if times < LEAST_ERROR_RATIO:
        return f" (its forces fit q at {one} or at {other} mm, {times:.2f} to 1)"
    return (
        f" (its forces fit q at {one} mm best, with an error of {best:.2g} N; the next, {other}, "
        f"has {times:.3g} times that error)"
    )


def _over_stroke(runs: list[Recording], chain: Chain) -> tuple[list[Recording], list[str]]:
    """Runs over about the full stroke of a chain, and a note for each other run."""
    full = chain.full_stroke
    covering: list[tuple[Recording, float]] = []
    notes: list[str] = []
    for run in runs:
        stroke = from_zero(run, full)
        low, high = float(np.min(stroke)), float(np.max(stroke))
        covered = min(high, full) - max(low, 0.0)
        if covered >= _LEAST * full and high - low <= _MOST * full:
            covering.append((run, covered))
        else:
            notes.append(
                f"{run.source}: left out, its stroke goes from {to_unit(low, 'mm'):.4g} to "
                f"{to_unit(high, 'mm'):.4g} mm and that of the design from 0 to "
                f"{to_unit(full, 'mm'):.4g} mm: check the unit in the header, and that this design "
                "was tested"
            )
    longest = max((covered for _, covered in covering), default=0.0)
    notes += [
        f"{run.source}: left out, it covers {to_unit(covered, 'mm'):.4g} mm where another repeat "
        f"has {to_unit(longest, 'mm'):.4g} mm"
        for run, covered in covering
        if covered < _REPEAT * longest
    ]
    return [run for run, covered in covering if covered >= _REPEAT * longest], notes


def _ratio(series: Series, run: Recording) -> float:
    """Force of a run over the force of the model, by least squares."""
    stroke = from_zero(run, series.chain.full_stroke)
    force = series.net(stroke, run.force)
    # Several cells follow one path for all runs.
    path = series.path if len(series.chain) > 1 else None
    model = predicted_force(series.chain, series.unloading, stroke, path)
    size = float(model @ model)
    return float(model @ force) / size if size > 0 else 1.0


def _by_bands(runs: list[tuple[float, Recording]]) -> list[tuple[int, list[Recording], float]]:
    """Groups of runs by number of bands: the number, the runs, their median force ratio.

    The number is that in the names of file or folder, or else follows from the force. Repeats with
    clearly different forces have different numbers, so that softer bands are not taken for fewer.
    """
    ordered = sorted(runs, key=lambda one: natural(one[1].source))
    counts = {one[1].source: _said(one[1]) for one in ordered}
    unsaid = [one for one in ordered if not counts[one[1].source]]
    below, weaker = 0, math.nan
    for cluster in _by_force(unsaid):
        ratio = _median(cluster)
        count = max(1, math.ceil(ratio / _STRONG))
        if not _is_odd(cluster, unsaid):
            # Soft bands are not taken for fewer: more force means more bands.
            if count == below and weaker > 0 and round(below * ratio / weaker) > below:
                count += 1
            below, weaker = count, ratio
        counts |= dict.fromkeys((run.source for _, run in cluster), count)
    groups = grouped((counts[one[1].source] or 1, one) for one in ordered)
    return [
        (count, [run for _, run in group], _median(group))
        for count, group in sorted(groups.items())
    ]


def _by_force(runs: list[tuple[float, Recording]]) -> list[list[tuple[float, Recording]]]:
    """Runs with their force ratios in clusters of similar forces, the weakest first."""
    clusters: list[list[tuple[float, Recording]]] = []
    for one in sorted(runs, key=lambda one: one[0]):
        if clusters and (clusters[-1][-1][0] <= 0 or one[0] <= _APART * clusters[-1][-1][0]):
            clusters[-1].append(one)
        else:
            clusters.append([one])
    return clusters


def _design_first(runs: list[tuple[float, Recording]]) -> list[list[tuple[float, Recording]]]:
    """Clusters of runs by force: first those nearest to the design, with single odd repeats."""
    clusters = _by_force(runs)
    odd = [cluster for cluster in clusters if _is_odd(cluster, runs)]
    if len(odd) == len(clusters):
        return [runs]
    sound = [cluster for cluster in clusters if not _is_odd(cluster, runs)]
    own = min(sound, key=lambda cluster: abs(math.log(max(_median(cluster), 1e-9))))
    others = [cluster for cluster in sound if cluster is not own]
    return [own + [one for cluster in odd for one in cluster], *others]


def _is_odd(cluster: Sequence[object], every: Sequence[object]) -> bool:
    """Whether a cluster is one repeat of three or more, which may be damaged."""
    return len(cluster) == 1 and len(every) >= _REPEATS


def _median(cluster: list[tuple[float, Recording]]) -> float:
    return float(np.median([ratio for ratio, _ in cluster]))


def _said(run: Recording) -> int:
    """The number of bands in the name of the file or its folder; 0 if there is none."""
    folder, _, name = run.source.replace("\\", "/").rpartition("/")
    found = _SAID.search(name) or _SAID.search(folder.rpartition("/")[2])
    return int(found[1]) if found else 0


def _with_bands(cell: Cell, factor: float) -> Cell:
    bands = tuple(replace(band, stiffness=band.stiffness * factor) for band in cell.bands)
    return replace(cell, band=bands)


def _template(count: int, designs: Sequence[Chain]) -> tuple[Cell, ...]:
    fitting = [chain for chain in designs if len(chain) == count]
    if len(fitting) > 1:
        raise LabError(
            "designs",
            f"{len(fitting)} of them have {counted(count, 'cell')}: give one design, with the "
            f"anchors in the file names; or compare each design with its own recordings.",
        )
    return fitting[0].levers if fitting else (paper_cell(),) * count


def _parts(recording: Recording) -> list[Recording]:
    """Parts of the recording between its turning points."""
    return [
        replace(
            recording, time=recording.time[h], stroke=recording.stroke[h], force=recording.force[h]
        )
        for h in recording.halves
    ]


def _odd_lines(repeats: Sequence[Recording], gaps: dict[str, str]) -> list[str]:
    """Irregularities of repeats, one line each, with the names of the affected runs."""
    by_source = grouped([*gaps.items(), *unlike(repeats)])
    names_of = grouped(
        (line, run.name)
        for run in repeats
        for line in (*recording_warnings(run), *by_source.get(run.source, ()))
    )
    return [f"{', '.join(names)}: {line}" for line, names in names_of.items()]
