"""Formulas in Python, compiled with Numba on repeated use; both give the same bits.

A `kernel` is an ordinary function of numbers and arrays. An `entry` is a kernel that Python code
calls: it is interpreted while the work is small, and compiled by a separate process otherwise.
Machine code is stored on disk under the fingerprint of its source and its environment.
"""

from stepwell.kernels.entry import WORTH_LOADING, entry, interpret, stay
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
