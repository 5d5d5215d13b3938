"""Names of the authors' files, those that are shared with us and those that are not."""

import pytest

from stepwell.lab.recordings.recording import is_baseline, run_number, sample_number, setup_of

M, T = (-10, 0), (0, 0)


@pytest.mark.parametrize(
    ("name", "anchors"),
    [
        ("1unit_MB_1", [(M, (0, 0))]),
        ("1unit_MM_2", [(M, (10, 0))]),
        ("1unit_MT_3", [(M, (20, 0))]),
        ("1unit_ML_7", [(M, (10, 15))]),
        ("1unit_MR_1", [(M, (10, -15))]),
        ("1unit_MLB_1", [(M, (0, 15))]),
        ("1unit_MLT_3", [(M, (20, 15))]),
        ("1unit_MRT_12", [(M, (20, -15))]),
        ("1unit_TL_1", [(T, (10, 15))]),
        ("1unit_TTR_1", [(T, (20, -15))]),
        ("2unit_MMB_1", [(M, (10, 0)), (M, (0, 0))]),
        ("2unit_MML_1", [(M, (10, 0)), (M, (10, 15))]),
        ("2unit_TMTL_1", [(T, (10, 0)), (T, (10, 15))]),
        ("2unit_TMTBM_1", [(T, (10, 0)), (T, (0, 0))]),
        ("2unit_TMTTL_1", [(T, (10, 0)), (T, (20, 15))]),
    ],
)
def test_letters_are_anchors(name, anchors):
    setup = setup_of(name)
    assert setup is not None
    found = [
        tuple(tuple(round(1e3 * x) for x in point) for point in pair) for pair in setup.anchors
    ]
    assert found == anchors
    assert setup.marked == ""


def test_a_mark_behind_the_letters_is_kept():
    setup = setup_of("2unit_MMM_bad_3")
    assert setup is not None
    assert (setup.code, setup.marked) == ("MMM_bad", "bad")


@pytest.mark.parametrize(
    "name",
    ["1unit_bands_1", "1unit_MLR_1", "1unit_M_1", "1unit_MMMM_1", "pull_3", "3unit_MMB_1", ""],
)
def test_a_name_that_says_no_configuration_is_not_guessed(name):
    assert setup_of(name) is None


def test_baselines_samples_and_numbers_are_known_by_name():
    assert is_baseline("2unit_Friction_1") and is_baseline("friction_3")
    assert not is_baseline("1unit_MB_1")
    assert sample_number("Samp2_45mm_7") == 2
    assert sample_number("robot_rubbers_7") is None
    assert run_number("Samp2_45mm_7") == 7
    assert run_number("pull") is None
