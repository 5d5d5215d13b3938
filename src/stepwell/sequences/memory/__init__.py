"""What a transition graph means in the words of the field: loops, memory, counting."""

from stepwell.sequences.memory.counting import Accumulator, Counting
from stepwell.sequences.memory.latches import Latch
from stepwell.sequences.memory.loops import Loop
from stepwell.sequences.memory.reading import MemoryReading, read_memory
from stepwell.sequences.memory.return_point import Forgetting, ReturnPointMemory
from stepwell.sequences.memory.scrambling import Scrambling
