"""No screen is wider than the terminal, and none loses a number for it."""

import random
import re
import sys

import pytest

from sizes import SIZE, cases
from stepwell.accounts.rendering import terminal as fold
from stepwell.cli import screen

# Narrower and wider terminals, and what the pages and a pipe have; that no screen of a golden case
# is wider than 80 letters, those cases hold (tests/golden).
WIDTHS = cases((40, 60, 72, 80, 100), (40, 60, 100))


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ("run", "preset:three-wave"),
        ("program", "preset:paper-forward", "--target", "01"),
        ("map", "preset:paper-forward", "--x", "0:20:3", "--y", "-15:15:3"),
        *([("robot", "show", "robot-left")] if SIZE == "full" else []),
        ("presets",),
        ("doctor",),
    ],
)
def test_a_screen_fits_the_terminal_and_tells_the_same_numbers(stepwell, monkeypatch, command):
    screens, full = {}, [] if command == ("presets",) else ["--full"]
    for width in WIDTHS[1:]:
        monkeypatch.setenv("COLUMNS", str(width))
        screens[width] = stepwell(*command, *full).stdout
        lines = screens[width].split("\n")
        assert [line for line in lines if len(line) > width and " " in line.strip()] == []
    # In a table of several blocks the first columns are there again.
    numbers = [set(re.findall(r"\d+\.\d+", text)) for text in screens.values()]
    assert all(other == numbers[0] for other in numbers)


@pytest.mark.slow
@pytest.mark.parametrize("width", WIDTHS)
def test_a_table_of_any_shape_fits_and_keeps_every_word(monkeypatch, width):
    monkeypatch.setenv("COLUMNS", str(width))
    draw = random.Random(width)
    words = ["snap", "0.3898", "-1.2e-05", "20 → 17.23,", "00>10>11>01>00", "by +66.17 %", "outer"]
    for _ in range(300):
        columns, rows = draw.randint(1, 9), draw.randint(1, 5)
        table = [
            [" ".join(draw.choices(words, k=draw.randint(0, 4))) for _ in range(columns)]
            for _ in range(rows)
        ]
        head = [" ".join(draw.choices(words, k=draw.randint(1, 2))) for _ in range(columns)]
        blocks = fold.blocks(head, table, {k for k in range(columns) if draw.random() < 0.5})
        lines = [line for named, rest in blocks for line in (*named, *rest)]
        assert max(map(len, lines)) <= width
        bare = "".join("".join(lines).split())
        assert len(bare) >= sum(len("".join(text.split())) for row in table for text in row)


def test_what_follows_a_name_stands_under_the_words_and_not_under_the_name(monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    lines = fold.folded("Margin      8.002 mm of an anchor or 39.82 % of a stiffness")
    assert lines == ["Margin      8.002 mm of an anchor or", "            39.82 % of a stiffness"]


def test_a_sequence_is_folded_between_states_and_a_number_stays_with_its_unit(monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    states = ">".join(["01010"] * 12)
    parts = fold.folded(f"Sequence  {states}")
    assert all(len(part) <= 40 and part.endswith((">", "01010")) for part in parts)
    assert "".join(part.replace("Sequence", "").strip() for part in parts) == states
    assert "12 mm" in " | ".join(fold.folded("this is quite a long sentence up to 12 mm long."))


def test_a_message_is_one_line_in_a_log_and_folded_at_a_terminal(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "40")
    message = "file.toml: chain.cell[1].q_mmm: unknown key. Did you mean q_mm?"
    screen.warn(message)
    assert capsys.readouterr().err == f"{message}\n"
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    screen.warn(message)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2 and max(map(len, lines)) <= 40
