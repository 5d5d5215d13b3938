"""Snaps with masses: the motion of the blocks at a fixed drive, from contact to contact."""

# pyright: reportUnusedImport=false

from stepwell.statics.inertia.ride import (
    DAMPED,
    GOES_ON,
    JUMPED,
    PEAK,
    RESTS,
    RUBBED,
    STEP,
    STRUCK,
    TIME,
    Body,
    Motion,
    ride,
)
