"""A story in seven steps of what springs can be told to do, and the page that shows it moving."""

from stepwell.reports.story.page import write_story
from stepwell.reports.story.steps import OPENING, STEPS, Step, Telling
