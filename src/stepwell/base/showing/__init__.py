"""How values show themselves: by a card, by a figure, and long work by a bar."""

from stepwell.base.showing.bar import bar, on_terminal
from stepwell.base.showing.shown import Drawn, Shown, brief, of_kind
