"""Lowest layer: values, checks, errors, limits, units, atomic writing of files."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.base import check, limits
from stepwell.base.bar import Progress, Shows, bar, in_lines, notify, on_terminal, tracked
from stepwell.base.check import (
    ONE_BY_ONE,
    QUICKLY,
    REACH,
    USUAL_ANCHOR,
    USUAL_STIFFNESS,
    Vec2,
    bisected,
    finite,
    short,
)
from stepwell.base.errors import (
    Advised,
    ExtraError,
    InputError,
    SettingError,
    StepwellError,
    described,
    nearest_word,
    printable,
)
from stepwell.base.extras import IN_CLONE, SOURCE, have, install, late, missing, need
from stepwell.base.limits import content_of, most, problem, require
from stepwell.base.quantities import (
    Column,
    Columns,
    Measure,
    Quantity,
    Schema,
    amount,
    counted,
    grouped,
    headed,
    in_measure,
    join_first,
    keys,
    number,
    percent,
    percent_at_most,
    plain,
    read_off,
    record,
    rows_of,
    shown,
    signed,
    variables,
    write_csv,
)
from stepwell.base.shown import Drawn, Shown, brief, of_kind
from stepwell.base.units import (
    GRAVITY,
    UNITS,
    display_unit,
    from_unit,
    in_names,
    spellings,
    to_unit,
)
from stepwell.base.value import ByValue, ReadOnly, deep_equal
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
    import numpy as np
    from numpy.typing import NDArray

    Bools = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Ints = NDArray[np.int64]

    from stepwell.base.installed import Installation, installation


# They import NumPy or read package versions, which takes longer than `stepwell --help`.
def __getattr__(name: str) -> Any:
    if name in ("Installation", "installation"):
        return getattr(import_module("stepwell.base.installed"), name)
    if name in ("Bools", "Floats", "Ints"):
        import numpy as np
        from numpy.typing import NDArray

        return NDArray[{"Bools": np.bool_, "Floats": np.float64, "Ints": np.int64}[name]]
    raise AttributeError(f"module 'stepwell.base' has no attribute {name!r}")
