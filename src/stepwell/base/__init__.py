"""What every room stands on: values, checks, errors, limits, units, files written whole."""

from typing import TYPE_CHECKING, Any

from stepwell.base import check, limits, usual
from stepwell.base.bisect import bisected
from stepwell.base.check import Vec2, finite, short
from stepwell.base.errors import ExtraError, InputError, SettingError, StepwellError
from stepwell.base.extras import EXTRAS, Extra, have, missing, need
from stepwell.base.limits import content_of, most, problem, require
from stepwell.base.quantities import (
    Column,
    Columns,
    Measure,
    Quantity,
    Schema,
    amount,
    counted,
    headed,
    in_measure,
    number,
    percent,
    percent_at_most,
    plain,
    record,
    rows_of,
    shown,
    signed,
    told_in,
    variables,
    write_csv,
)
from stepwell.base.showing import Drawn, Shown, bar, brief, of_kind, on_terminal
from stepwell.base.text import Advised, described, nearest_word, printable
from stepwell.base.usual import ONE_BY_ONE, QUICKLY, REACH
from stepwell.base.value import ByValue, ReadOnly, same
from stepwell.base.version import __version__, versions
from stepwell.base.write import (
    csv_text,
    draft_beside,
    naming,
    refuse_address,
    sync_folder,
    write_atomic,
    write_netcdf,
)

if TYPE_CHECKING:
    from stepwell.base.arrays import Bools, Floats, Ints


# With NumPy, which takes longer to open than `stepwell --help` to answer.
def __getattr__(name: str) -> Any:
    if name in ("Bools", "Floats", "Ints"):
        from stepwell.base import arrays

        return getattr(arrays, name)
    raise AttributeError(f"module 'stepwell.base' has no attribute {name!r}")
