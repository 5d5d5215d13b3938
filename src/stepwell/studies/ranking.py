"""The order of designs from the best to the worst."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepwell.base import Floats


def ranked(columns: Mapping[str, Floats], by: Sequence[str]) -> list[int]:
    """Designs from the best to the worst.

    Args:
        columns: by name, (n,) each.
        by: names, each for its largest values first or, with - before it, its least; the next
            decides where one has ties, and at last who stands first.

    Returns:
        Their numbers from 0; a design without a value in the first of `by` is none of them.
    """
    keys = [columns[one[1:]] if one.startswith("-") else -np.asarray(columns[one]) for one in by]
    # A value that is missing sorts behind all others.
    order = np.lexsort(keys[::-1])
    return [int(k) for k in order if not np.isnan(keys[0][k])]
