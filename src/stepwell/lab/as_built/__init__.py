"""A first build beside its drawing: what it was seen to do, what it must be, what to move."""

from stepwell.lab.as_built.holes import WrongHole
from stepwell.lab.as_built.moves import Move, Step
from stepwell.lab.as_built.observed import Observed, Pull, pulls_of
from stepwell.lab.as_built.rebuilt import FIRST_BUILD, WRONG_HOLE, AsBuilt, Known, as_built
from stepwell.lab.as_built.schema import KNOWN, MOVE, as_built_record, holes_told
