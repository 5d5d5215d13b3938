"""Formulas that run at once, and as machine code once that pays: the same bits either way.

A `kernel` is an ordinary function of numbers and arrays. An `entry` is one that the rest of the
program calls: it is interpreted while the work is small, compiled by a process of its own when
it is not, and what was compiled is kept on disk under the fingerprint of all that went into it.
"""

from stepwell.kernels.entry import WORTH_LOADING, entry, stay
from stepwell.kernels.fingerprint import kernel, leaf, record
from stepwell.kernels.store import kept
from stepwell.kernels.threads import (
    MOST,
    SPENT,
    UNLIMITED,
    beside,
    cores,
    end_early,
    in_blocks,
    overspent,
    watched,
)
