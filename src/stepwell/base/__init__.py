"""What every room stands on: values, checks, errors, limits, units, files written whole."""

from stepwell.base import check, limits, usual
from stepwell.base.advised import Advised
from stepwell.base.arrays import Bools, Floats, Ints
from stepwell.base.bisect import bisected
from stepwell.base.check import Vec2, finite, short
from stepwell.base.errors import ExtraError, InputError, SettingError, StepwellError
from stepwell.base.limits import content_of, most, problem, require
from stepwell.base.quantities import (
    Column,
    Columns,
    Quantity,
    Schema,
    number,
    plain,
    record,
    rows_of,
    shown,
    signed,
    told_in,
    variables,
    write_csv,
)
from stepwell.base.text import nearest_word, printable
from stepwell.base.usual import ONE_BY_ONE, QUICKLY, REACH
from stepwell.base.value import ByValue, ReadOnly, same
from stepwell.base.version import __version__, versions
from stepwell.base.write import (
    csv_text,
    draft_beside,
    naming,
    sync_folder,
    write_atomic,
    write_netcdf,
)
