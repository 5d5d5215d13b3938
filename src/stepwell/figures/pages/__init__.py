"""Pages of a paper: several figures as the panels of one."""

from stepwell.figures.pages.compose import compose
from stepwell.figures.pages.journals import WIDTHS, JournalWidth, length
