"""What counts as the same output and what does not."""

import pytest

from golden.comparing import EXACT, FITTED, SIMULATED, alike, differences, text_differences
from golden.reducing import brief, laid_out, read, reduced


@pytest.mark.parametrize(
    ("frozen", "found"),
    [
        ("Snaps 2", "Snaps 3"),
        ("00>10>11", "00>01>11"),
        ('"-00" -> "-01"', '"-00" -> "-10"'),
        ("Peak force 0.6476 N", "Peak force 0.6478 N"),
        ("Peak force 0.6476 N", "Peak force 0.6476 mN"),
        ("Peak force 0.6476 N", "Peak force 647.6 mN"),
        ("q by (−6.288, −4.949) mm", "q by (−6.288, +4.949) mm"),
        ("a  0.5", "a   0.5"),
        ("4 numbers; sum 0.5", "5 numbers; sum 0.5"),
        ("margin 8.002 mm", "margin nan mm"),
    ],
)
def test_words_counts_states_units_and_columns_are_held_exactly(frozen, found):
    for tolerance in (EXACT, FITTED, SIMULATED):
        assert not alike(frozen, found, tolerance)


@pytest.mark.parametrize(
    ("frozen", "found"),
    [
        ("Peak force 0.6476 N", "Peak force 0.6477 N"),
        ("margin  9.999 mm", "margin 10.000 mm"),
        ("1.2e-05 ± 0.3", "1.3e-05 ± 0.4"),
        ("F1 −0.3898", "F1 −0.3897"),
    ],
)
def test_a_number_in_a_text_may_be_rounded_the_other_way(frozen, found):
    assert alike(frozen, found, EXACT)


def test_only_lines_that_differ_are_in_the_diff_of_a_text():
    shown = "$ stepwell run\nforce {} N\nsnaps 2"
    assert text_differences(shown.format(0.6476), shown.format(0.6477), EXACT) == []
    assert text_differences(shown.format(0.6476), shown.format(0.7), EXACT)[-3:] == [
        "-force 0.6476 N", "+force 0.7 N", " snaps 2",
    ]  # fmt: skip
    assert text_differences(shown, f"{shown}\nmore", EXACT)


@pytest.mark.parametrize(
    ("frozen", "found", "at"),
    [
        ({"force_N": 0.38975017337}, {"force_N": 0.38975017437}, "force_N"),
        ({"a": [{"b": 20.0}]}, {"a": [{"b": 20.1}]}, "a[0].b"),
        ({"a": 1.0}, {"a": 1}, "a"),
        ({"a": 1}, {"a": True}, "a"),
        ({"a": None}, {"a": 0.0}, "a"),
        ({"a": None}, {}, "a"),
        ({}, {"a": None}, "a"),
        ({"a": [1, 2]}, {"a": [1, 2, 3]}, "a"),
        ({"unit": "mm"}, {"unit": "m"}, "unit"),
    ],
)
def test_a_result_that_differs_is_named_by_its_place(frozen, found, at):
    (line,) = differences(frozen, found, EXACT)
    assert line.startswith(f"{at}: ")


def test_numbers_of_a_result_may_be_off_by_a_part_of_themselves():
    for one, other in ((0.389750173370, 0.389750173371), (4.7e-15, -1e-16)):
        assert [*differences({"a": one}, {"a": other}, EXACT)] == []
    assert [*differences({"b": 1.0, "a": 2}, {"a": 2, "b": 1.0}, EXACT)] == []


def test_what_is_frozen_has_more_digits_than_are_compared():
    for tolerance in (EXACT, FITTED, SIMULATED):
        value = 0.123456789012345
        kept = reduced(value, tolerance.digits)
        assert abs(kept - value) < 0.1 * tolerance.relative * value


def test_a_sentence_is_kept_as_its_numbers_with_their_units():
    text = "works: 96.4 % of 100 built lie within ±0.3 mm and 5 N/m of it"
    assert brief(text) == "works:¶ 96.4 % 100 ±0.3 mm 5 N/m"
    assert brief("one of these words is before: 1 mm") == "¶ 1 mm"
    name = "out/a_long_name_of_a_file.csv"
    assert brief(name) == name
    assert brief("00>10>11>01>00") == "00>10>11>01>00"
    assert brief("inner, outer") == "inner, outer"


def test_what_is_laid_out_is_read_again():
    rows = [{"name": f"cell {k}", "force_N": 0.1 * k, "at_mm": [1.0, 2.0 * k]} for k in range(30)]
    value = {"a": rows, "b": {"c": [], "d": None}, "e": [1, "x" * 300, [{"f": 1}, {"g": 2}]]}
    text = laid_out(value)
    assert read(text) == value
    assert len(text.split("\n")) < 60
