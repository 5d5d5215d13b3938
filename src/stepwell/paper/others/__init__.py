"""Claims of others about chains of bistable elements."""

from stepwell.paper.others.balloons import CLAIMS as BALLOONS
from stepwell.paper.others.countersnapping import CLAIMS as COUNTERSNAPPING
from stepwell.paper.others.kresling import CLAIMS as KRESLING
from stepwell.paper.others.pairs import CLAIMS as PAIRS
from stepwell.paper.others.trilinear import CLAIMS as TRILINEAR
