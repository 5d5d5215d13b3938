"""Following the local minimum event by event: compiled kernels, and what they keep."""

# pyright: reportUnusedImport=false

from stepwell.statics.following import log
from stepwell.statics.following.branch import inverse_slope
from stepwell.statics.following.certificate import (
    ENERGY,
    EQUILIBRIUM,
    FORCE_SLACK,
    KEPT,
    STABILITY,
    STROKE,
    audit,
)
from stepwell.statics.following.follow import follow
from stepwell.statics.following.landing import LANDED, STOPPED
from stepwell.statics.following.pieces import (
    MOST_PIECES,
    NO_FORCE,
    Pieces,
    Room,
    cut,
    cut_into,
    find_piece,
    force_scale,
    invert,
    of_curve,
    resting_piece,
    room_for,
    room_of_pieces,
    sheets_of,
    stand_all_on,
    stand_on,
    travel_between,
    travels_between,
)
from stepwell.statics.following.rising import Rising, no_rising
from stepwell.statics.following.sample import Samples, count_samples, sample
from stepwell.statics.following.series import Segment, no_segment
from stepwell.statics.following.smooth import LOST, choose
from stepwell.statics.following.snap import COARSE, FINE, along_line, snap
from stepwell.statics.following.state import (
    DONE,
    DUE,
    FREE,
    GAVE_UP,
    GOES,
    GOES_ON,
    LOG_FULL,
    NOT_SETTLED,
    RUNS_AWAY,
    SENSE,
    SLIDES,
    STALLED,
    TRIGGER,
    Problem,
    Spare,
    State,
    blank_state,
    drive_of,
    held_range,
    hold,
    moved,
    set_snap,
    spare_room,
)
