"""What figures say: names that are safe to draw, numbers with their units, sequences in lines."""

from stepwell.figures.common.words import told
from stepwell.figures.common.words.names import families, literal
from stepwell.figures.common.words.wording import minus, sequence_words, shortened, wrapped
