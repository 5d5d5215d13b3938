"""What counts as the same output and what does not."""

import pytest

from golden.comparing import EXACT, FITTED, SIMULATED, alike, differences


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
        assert not alike(frozen, found, tolerance, rounded=True)


@pytest.mark.parametrize(
    ("frozen", "found"),
    [
        ("Peak force 0.6476 N", "Peak force 0.6477 N"),
        ("margin  9.999 mm", "margin 10.000 mm"),
        ("1.2e-05 ± 0.3", "1.3e-05 ± 0.4"),
        ("F1 −0.3898", "F1 −0.3897"),
    ],
)
def test_a_number_for_people_may_be_rounded_the_other_way_and_one_for_programs_not(frozen, found):
    assert alike(frozen, found, EXACT, rounded=True)
    assert not alike(frozen, found, EXACT, rounded=False)


def test_numbers_for_programs_may_be_off_by_a_part_of_themselves():
    assert alike("force_N: 0.389750173370", "force_N: 0.389750173371", EXACT, rounded=False)
    assert not alike("force_N: 0.389750173", "force_N: 0.389750273", EXACT, rounded=False)
    assert alike("error: 4.7e-15", "error: -1e-16", EXACT, rounded=False)
    assert not alike("length: 20.0", "length: 20.1", EXACT, rounded=False)


def test_what_a_line_is_compared_as_hangs_on_the_section_it_stands_in():
    shown = "$ stepwell run\n--- shown\nforce 0.6476 N\n--- out/result.json\n(JSON)\nforce: {}"
    assert differences(shown.format(0.5), shown.format(0.5 + 1e-12), EXACT) == []
    assert differences(shown.format(0.5), shown.format(0.6), EXACT)
    assert not differences(shown, shown.replace("0.6476", "0.6477"), EXACT)
    assert differences(shown, shown + "\nmore", EXACT)
    assert differences(shown, shown.replace("force: {}", ""), EXACT)
