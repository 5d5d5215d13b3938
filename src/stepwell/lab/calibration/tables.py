"""Laws of bands as tension tests show them, for a fit to scale."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from stepwell.lab.bands import band_test
from stepwell.lab.mechanisms import TENSION_TEST
from stepwell.lab.recordings import LabError, Recording, setup_of
from stepwell.mechanism import Table

_POINTS, _ROWS = 201, 25
_TAUT = 0.02  # of the largest force, below which a band counts as slack


def tension_tables(recordings: Iterable[Recording]) -> dict[str, Table]:
    """The law of each set of tension tests: the mean loading curve of its usual bands.

    Args:
        recordings: of any kind; tension tests are told by their names.

    Returns:
        By the name of a folder of tests its law, tension over the stiffness at the largest
        extension; where its bands are not of one kind, by the names of the runs. What gives no band
        is left out.
    """
    groups: dict[str, list[Recording]] = defaultdict(list)
    for one in recordings:
        if setup_of(one.name) is None and TENSION_TEST.search(one.name):
            groups[one.group].append(one)
    found: dict[str, Table] = {}
    for group, runs in groups.items():
        name = group.replace("\\", "/").rpartition("/")[2].partition(".")[0]
        try:
            table = _table(runs)
        except LabError:
            # Bands of several kinds, or a run that cannot be used: each by itself.
            for run in runs:
                with suppress(LabError):
                    found[run.name] = _table([run])
        else:
            found[name] = table
    return found


def _table(runs: Sequence[Recording]) -> Table:
    """The mean loading curve of the usual bands, from where they are taut to where all reach."""
    test = band_test(runs)
    reach = min(float(np.max(loop.stroke)) for loop in test.used)
    test = replace(test, window=(0.0, reach))
    curves = [test.curve(sample) for sample in test.samples]
    stroke = np.linspace(0.0, reach, _POINTS)
    force = np.mean([np.interp(stroke, *curve) for curve in curves], axis=0)
    force = np.maximum.accumulate(force - force[0])
    slack = int(np.flatnonzero(force > _TAUT * force[-1])[0]) - 1
    extension = np.linspace(0.0, reach - stroke[slack], _ROWS)
    tension = np.interp(extension, stroke[slack:] - stroke[slack], force[slack:])
    tension[0] = 0.0
    shape = tension * extension[-1] / tension[-1]
    return Table(tuple(extension.tolist()), tuple(shape.tolist()))
