"""One actuator, eight states: where to turn is worked out, and every way is followed."""

import stepwell as sw

nested = sw.Chain(
    [sw.Cell(sw.Band(p=(-0.010, 0.0), q=(q, 0.0))) for q in (0.0, 0.010, 0.020)], title="nested"
)
most = 0
for state in ("100", "110", "111", "010", "011", "001", "101"):
    program = nested.program(state)
    print(program)
    assert program.sequence[-1] == state
    most = max(most, program.strokes)
