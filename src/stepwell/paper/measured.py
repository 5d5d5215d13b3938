"""Claims decided by recordings, which are not part of Stepwell."""

import math
import os
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path

from stepwell import lab
from stepwell.base import to_unit
from stepwell.paper.claims import Claim, Finding, Judgement, claim, finding_of

MISSING = (
    "Decided by the authors' recordings, which are not part of Stepwell: "
    "`stepwell paper --data PATH`."
)
_K, _K_ROBOT = 28.5, 47.0
# Half a unit of the last digit printed in the paper.
_ROUNDING, _ROUNDING_ROBOT = 0.05, 0.5
# A seventh of F0 of the paper's reference cell, 0.967 k r.
_CLOSE = 0.15


class Recorded:
    """The authors' recordings, read on first access."""

    def __init__(self, folder: str | os.PathLike[str]):
        self.folder = Path(folder)

    @cached_property
    def comparison(self) -> lab.Comparison:
        """Comparison of unit cells and pairs with the paper's model."""
        pairs = "2unit_00_11", "2unit_2_00_11", "2unit_11_00"
        return lab.compare(self.read("1unit", "1unit_2", *pairs))

    def read(self, *folders: str) -> list[lab.Recording]:
        """All recordings in these subfolders; raises LabError if there is none."""
        paths = [self.folder / name for name in folders if (self.folder / name).is_dir()]
        batch = lab.read_all(paths)
        if not batch.recordings:
            raise lab.LabError(
                str(self.folder),
                f"holds no recording under {' or '.join(folders)}: give a clone of the authors' "
                f"repository, or a folder laid out like it.",
            )
        return list(batch.recordings)


@claim("band tests published with the paper", "28.5 N/m", "0.05 N/m")
def measured_stiffness(data: Recorded) -> Finding:
    """The rubber bands of the unit cells have k = 28.5 N/m."""
    k = lab.stiffness(lab.band_test(data.read("Rubber_bands"), window=(0.005, 0.035)))
    note = (
        f"Line through 5 to 35 mm, loading, cycles 5 to 9 of {len(k.each)} bands. Rubber is not "
        f"linear, so k is that of this window; ± is a 95 % interval with the scatter between bands."
    )
    ours = f"{k.value:.3f} ± {k.value - k.low:.2f} N/m"
    return finding_of(abs(k.value - _K) <= _ROUNDING, ours, note=note)


@claim("robot band tests published with the paper", "47 N/m", "0.5 N/m")
def measured_robot_stiffness(data: Recorded) -> Finding:
    """The rubber bands of the robot with antennas have k = 47 N/m."""
    options = {"window": (0.010, 0.020), "cycles": (2, 5), "cycles_per_sample": 5}
    bands = data.read("Rubber_bands_robot")
    three = lab.stiffness(lab.band_test(bands, drop=(2,), **options))
    four = lab.stiffness(lab.band_test(bands, **options))
    ours = f"{three.value:.2f} N/m of three bands, {four.value:.2f} of all four"
    note = (
        f"Line through 10 to 20 mm, loading, cycles 2 to 5. The paper leaves out the second band, "
        f"which has {four.each[2]:.2f} N/m."
    )
    if abs(four.value - _K_ROBOT) > _ROUNDING_ROBOT:
        note += " With it the mean is outside the tolerance."
    return finding_of(abs(three.value - _K_ROBOT) <= _ROUNDING_ROBOT, ours, note=note)


@claim("unit-cell tests published with the paper", "all", "every series")
def measured_class(data: Recorded) -> Finding:
    """Measured unit cells are bistable or monostable as the model says."""
    tests = data.comparison.cells
    wrong = [test.series.name for test in tests if not test.right_class]
    ours = f"{len(tests) - len(wrong)} of {len(tests)} series"
    return finding_of(not wrong and bool(tests), ours, otherwise=f"Not so: {'; '.join(wrong)}.")


@claim("Fig. 1D, unit-cell tests", "all", "0.005 k r")
def measured_falling(data: Recorded) -> Finding:
    """The measured force of a unit cell falls from state 0 to state 1."""
    tests = data.comparison.cells
    rising = [
        f"{test.series.name} by {to_unit(height, 'mN'):.0f} mN from {to_unit(start, 'mm'):.1f} to "
        f"{to_unit(end, 'mm'):.1f} mm"
        for test in tests
        for start, end, height in test.rises
    ]
    ours = f"{sum(not test.rises for test in tests)} of {len(tests)} series"
    note = "Means of repeats over half a millimetre, without the first half millimetre of stroke."
    otherwise = f"It rises in {'; '.join(rising)}. {note}"
    return finding_of(not rising and bool(tests), ours, note=note, otherwise=otherwise)


@claim("Fig. 1D, unit-cell tests", "they agree", "0.15 k r, mean over geometries")
def measured_unit_cell(data: Recorded) -> Finding:
    """Measured forces of the unit cells follow the model with k = 28.5 N/m."""
    comparison = data.comparison
    one, two = comparison.mean_rmse(1), comparison.mean_rmse(2)
    known = [error for error in (one, two) if not math.isnan(error)]
    far = [test.series.name for test in comparison.cells if not test.agrees]
    fitted = lab.calibrate(lab.prepare([test.series for test in comparison.cells]))
    note = (
        f"On the mean; by themselves {len(far)} of {len(comparison.cells)} series are farther off "
        f"({'; '.join(far)}). Bands going back pull less, and those of the tests with one band "
        f"were softer than those with two. Calibrated for both, the mean error of a geometry "
        f"predicted from the others is {fitted.mean_error(1):.3f} k r with one band and "
        f"{fitted.mean_error(2):.3f} with two (`stepwell lab calibrate`)."
    )
    ours = f"{one:.3f} k r with one band, {two:.3f} with two"
    return finding_of(bool(known) and max(known) <= _CLOSE, ours, note=note)


@claim("Fig. 2, two-cell tests", "they do", "every series that is no tie")
def measured_order(data: Recorded) -> Finding:
    """Two cells on the test machine load and unload in the predicted order."""
    pairs = data.comparison.pairs
    clear = [test for test in pairs if not test.tie]
    right = [test for test in clear if test.right_order]
    ties = [test.series.name for test in pairs if test.tie]
    ratios = [test.ratio for test in right]
    ours = f"{len(right)} of {len(clear)} series"
    if ratios:
        ours += f", error ratio {min(ratios):.1f} to {max(ratios):.1f}"
    note = f"Ties, which no model decides: {'; '.join(ties)}." if ties else ""
    wrong = "; ".join(test.series.name for test in clear if not test.right_order)
    return finding_of(len(right) == len(clear) > 0, ours, note=note, otherwise=f"Not so: {wrong}.")


@claim("Fig. 2D and 2E, two-cell tests", "they snap", "every run of every series")
def measured_snaps(data: Recorded) -> Finding:
    """Pairs on directed pathways snap on the test machine."""
    pairs = [test for test in data.comparison.pairs if test.snaps_predicted and not test.tie]
    right = sum(bool(test.right_snaps) for test in pairs)
    text = "; ".join(f"{test.series.name}: {test.snaps_told}" for test in pairs)
    return finding_of(right == len(pairs) > 0, f"{right} of {len(pairs)} series", note=f"{text}.")


@claim("Fig. 2F and 2G, two-cell tests", "no snap", "every run of every series")
def measured_undirected(data: Recorded) -> Finding:
    """Pairs on undirected pathways do not snap on the test machine."""
    pairs = [test for test in data.comparison.pairs if not test.snaps_predicted]
    wrong = [test.series.name for test in pairs if not test.right_snaps]
    ours = f"no snap in {len(pairs) - len(wrong)} of {len(pairs)} series"
    return finding_of(not wrong and bool(pairs), ours, otherwise=f"Snaps in {'; '.join(wrong)}.")


CLAIMS = (
    measured_stiffness,
    measured_robot_stiffness,
    measured_class,
    measured_falling,
    measured_unit_cell,
    measured_order,
    measured_snaps,
    measured_undirected,
)
IDS = tuple(one.id for one in CLAIMS)


def claims(data: str | os.PathLike[str] | None = None) -> tuple[Claim, ...]:
    """The claims; without the folder of the recordings they need data."""
    if data is None:
        missing = Finding("", Judgement.NEEDS_DATA, MISSING)
        return tuple(replace(one, find=lambda: missing) for one in CLAIMS)
    recorded = Recorded(data)
    return tuple(replace(one, find=partial(one.find, recorded)) for one in CLAIMS)
