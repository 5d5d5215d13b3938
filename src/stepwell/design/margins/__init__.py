"""How far a chain is from doing something else, and the nearest place where it does."""

from stepwell.design.margins.change import LONGEST_FOLLOWED, Change
from stepwell.design.margins.margin import Margin, margin, proved_margin
from stepwell.design.margins.reprogramming import WAY, Reprogramming, reprogram
from stepwell.design.margins.resistance import Resistance
from stepwell.design.margins.robustness import Robustness, RobustnessLimit, robustness
from stepwell.design.margins.worst import SIDES, Proof, extremes, farthest
