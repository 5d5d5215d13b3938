"""The text of design files: TOML, key paths, units, errors."""

from stepwell.files.text import units
from stepwell.files.text.errors import (
    MOST_LINES,
    DesignError,
    did_you_mean,
    key_path,
    value_text,
)
from stepwell.files.text.paths import Item, Steps, find, spelled
from stepwell.files.text.toml import Written, array, inline, lines, parsed, quoted
from stepwell.files.text.values import in_decimals, in_floats
