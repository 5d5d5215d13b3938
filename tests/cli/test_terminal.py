"""What a name holds never steers the terminal, and what cannot be shown is said."""

import os
import subprocess
import sys

import pytest

from sizes import cases
from stepwell.cli import screen

# Letters that move the cursor, turn the text round, hide it, or end a line.
CONTROLS = [
    *map(chr, [0x07, 0x08, 0x1B, 0x7F, 0x85, 0x9B, 0xAD, 0x200B, 0x200E, 0x200F, 0x2028, 0x2029]),
    *map(chr, range(0x202A, 0x202F)),
    *map(chr, range(0x2066, 0x206A)),
    "\ufeff",
    "\U000e0041",
]


@pytest.mark.parametrize("terminal", [False, True])
def test_no_letter_of_a_name_that_steers_a_terminal_reaches_it(monkeypatch, capsys, terminal):
    monkeypatch.setattr(screen, "styled", lambda: terminal)
    monkeypatch.setenv("TERM", "dumb")
    for letter in CONTROLS:
        name = f"a{letter}b"
        screen.show_lines(name)
        screen.show_text(name)
        screen.show_table(name, [name], [[name]])
        screen.show_json({"name": name})
        screen.warn(name)
        shown = capsys.readouterr()
        assert letter not in shown.out + shown.err
        assert shown.out.count(ascii(letter)[1:-1]) >= 5, ascii(letter)
        assert ascii(letter)[1:-1] in shown.err


def test_markup_in_a_name_is_text(monkeypatch, capsys):
    monkeypatch.setattr(screen, "styled", lambda: True)
    for name in ("[red]a[/red]", "[/]", "[bold", "[link=x]y[/link]"):
        screen.show_table(name, [name], [[name]])
        assert capsys.readouterr().out.count(name) == 3


def test_commands_escape_names_in_results_and_in_errors(stepwell, tmp_path):
    design = (tmp_path / "forward.toml").read_text("utf-8")
    (tmp_path / "a\u202eb.toml").write_text(
        f'title = "a\\u202Eb[red]"\n{design}'.replace(design.splitlines()[0], ""), "utf-8"
    )
    for arguments in (
        ("graph", "a\u202eb.toml"),
        ("graph", "a\u202eb\x1b.toml"),
        ("graph", "forward.toml", "--from", "a\u202e\x1b"),
        ("graph", "forward.toml", "-o", "a\u202e\x1b"),
        ("new", "a\u202e\x1b"),
        ("design", "a\u202e\x1b"),
        ("a\u202e\x1b",),
        ("lab", "read", "a\u202e\x1b"),
        ("run", "forward.toml", "--out", "forward.toml/\u202e\x1b"),
    ):
        result = stepwell(*arguments)
        assert "u202e" in result.output.lower(), (arguments, result.output)
        assert not {"\u202e", "\x1b"} & set(result.output), arguments


posix = pytest.mark.skipif(os.name != "posix", reason="redirections of a POSIX shell")
RUN = f"{sys.executable} -c 'import stepwell.cli as c; c.main()' presets "


@pytest.mark.slow
@posix
@pytest.mark.parametrize("option", cases(["", "--json"], ["--json"]))
def test_a_closed_standard_output_is_one_line(tmp_path, option):
    result = subprocess.run(
        ["sh", "-c", RUN + option + " >&-"], cwd=tmp_path, text=True, capture_output=True
    )
    assert result.returncode == 1
    assert result.stderr.startswith("standard output: is closed, so there is no output: redirect")
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="/dev/full")
def test_a_full_disk_behind_standard_output_is_one_line(tmp_path):
    result = subprocess.run(
        ["sh", "-c", RUN + "> /dev/full"], cwd=tmp_path, text=True, capture_output=True
    )
    assert result.returncode == 1
    assert result.stderr == "standard output: No space left on device\n"
