"""The tables of a design file as values, and back."""

from stepwell.files.tables.arena_map import drawn
from stepwell.files.tables.cells import Shared, cells_of, chain_of
from stepwell.files.tables.design_text import chain_text, robot_text
from stepwell.files.tables.known import columns_of, known_keys, new_cells
from stepwell.files.tables.program import WrittenProgram, program_of
from stepwell.files.tables.robot import part_of, robot
from stepwell.files.tables.tree import is_number, leaves, set_leaf, sources, tree_of
