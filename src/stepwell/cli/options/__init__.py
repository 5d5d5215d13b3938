"""Options that commands share, and how they are read."""

from stepwell.cli.options import ranges, tolerances
from stepwell.cli.options.common import Design, Force, ForceFile, Json, Out
from stepwell.cli.options.drive import Drive, NewDrive, stiffness_of
from stepwell.cli.options.folders import free, free_file
from stepwell.cli.options.grid import Grid, cell_of, grid, marks
from stepwell.cli.options.parameter import EXAMPLE, ParameterRange, parameter_range
from stepwell.cli.options.programs import From, To, own, planned
from stepwell.cli.options.robots import NoVideo, Robot, named, usable
from stepwell.cli.options.wishes import Span, span, stock, wish
