"""What figures share: style, names, labels, marks."""

from stepwell.figures.common import legends, marks, told
from stepwell.figures.common.dimension import (
    along_x,
    along_y,
    arrow,
    limits,
    mm,
    mm_pair,
    plain,
    round_length,
    scale_bar,
)
from stepwell.figures.common.labels import Label, beside, inside
from stepwell.figures.common.names import literal
from stepwell.figures.common.reading import (
    curve,
    legs,
    path_of,
    phases,
    require_two_cells,
    snaps_of,
    span,
    vertices,
)
from stepwell.figures.common.sheet import (
    Draw,
    Panel,
    Size,
    blank,
    canvas,
    drawing,
    indent,
    keep_inside,
    measured,
    name_panel,
    page_width,
    place,
    root,
    sheet_of,
    size_of,
    text_at,
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
    PHASE,
    PURPLE,
    SKY,
    UNLOADING,
    VERMILLION,
    YELLOW,
    cell_colours,
    cell_dashes,
    direction_colour,
    hollow,
    name_rows,
    on_black,
    on_white,
    pale,
    styled,
)
from stepwell.figures.common.words import minus, sequence_words, shortened, wrapped
from stepwell.figures.common.write import PRINT_DPI, save, svg
