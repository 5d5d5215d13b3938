"""What figures share: style, names, labels, marks."""

from stepwell.figures.common import marks
from stepwell.figures.common.dimension import (
    along_x,
    along_y,
    arrow,
    limits,
    mm,
    plain,
    round_length,
    scale_bar,
)
from stepwell.figures.common.labels import Label, beside
from stepwell.figures.common.names import literal
from stepwell.figures.common.reading import (
    curve,
    legs,
    path_of,
    require_two_cells,
    snaps_of,
    vertices,
)
from stepwell.figures.common.style import (
    BLACK,
    BLOCK,
    BLUE,
    COLUMN,
    FAINT,
    FIXED_BLOCK,
    GREEN,
    INK,
    LOADING,
    MJ,
    MM,
    ORANGE,
    PAGE,
    PATHWAY,
    PURPLE,
    SKY,
    UNLOADING,
    VERMILLION,
    YELLOW,
    blank,
    canvas,
    cell_colours,
    direction_colour,
    keep_inside,
    name_panel,
    pale,
    place,
    root,
    styled,
)
from stepwell.figures.common.words import sequence_words, shortened, wrapped
from stepwell.figures.common.write import save, svg
