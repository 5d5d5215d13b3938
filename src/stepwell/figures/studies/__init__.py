"""What a study found of many designs, and which number decides it."""

from stepwell.figures.studies.influences import influences
from stepwell.figures.studies.machines import machines
from stepwell.figures.studies.outcomes import outcomes
