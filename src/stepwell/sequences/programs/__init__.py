"""Stroke programs: the turning points that bring a chain to a state."""

from stepwell.sequences.programs.plan import program
from stepwell.sequences.programs.program import (
    Program,
    ProgramMethod,
    Turn,
    Unreachable,
    turn_schema,
)
