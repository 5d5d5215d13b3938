"""Chains designed for a wish, or the proof or the search that found none."""

from stepwell.design.synthesis.designed import Design
from stepwell.design.synthesis.impossible import Impossible
from stepwell.design.synthesis.inverse import design
