"""A first build beside its drawing: what it was seen to do, what it must be, what to move."""

from stepwell.lab.as_built.moves import Move
from stepwell.lab.as_built.observed import Observed, Pull, pulls_of
from stepwell.lab.as_built.rebuilt import FIRST_BUILD, AsBuilt, Known, as_built
from stepwell.lab.as_built.schema import KNOWN, MOVE, as_built_record
