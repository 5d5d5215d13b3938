"""What the page can ask, one file a question: `answer(design, ask)` gives a `View`.

A panel is a module in a folder here, whose name is the type of its messages. `LONG = True` in it
has it run in a process of its own, from which `ask.tell` says how far it is and which can be ended.
"""

from stepwell.studio.panels._known import answer, is_long, types
from stepwell.studio.panels.motions import motion_of
from stepwell.studio.panels.robots import walked
from stepwell.studio.panels.studies import end_studies
