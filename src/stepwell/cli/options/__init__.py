"""Options that commands share, and how they are read."""

from stepwell.cli.options import completing, tolerances
from stepwell.cli.options.common import (
    Arena,
    Design,
    Force,
    ForceFile,
    Json,
    MobilityRatio,
    NoVideo,
    Out,
    Robot,
    Robust,
    free,
    free_file,
    local,
    read_chain,
    read_design,
    read_robot,
)
from stepwell.cli.options.data import Data, calibrated_on, recordings_in
from stepwell.cli.options.driving import (
    Drive,
    From,
    NewDrive,
    To,
    drive_of,
    own,
    planned,
    stiffness_of,
)
from stepwell.cli.options.ranges import (
    EXAMPLE,
    Range,
    grid,
    parameter_range,
    read_range,
    span,
    window,
)
