"""Sequences and pathways: what the motion means."""

import pytest

import stepwell as sw
from stepwell import Pathway

INNER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))


def pair(qx, qy):
    return sw.Chain([INNER, INNER.with_anchors(q=(qx * 1e-3, qy * 1e-3))])


@pytest.mark.parametrize(
    ("q", "pathway", "snaps"),
    [
        # Kamp et al. 2024, Fig. 2: outer anchors beside an inner d = (20, 0) mm.
        ((20, 0), Pathway.CLOCKWISE, 2),
        ((0, 0), Pathway.COUNTERCLOCKWISE, 2),
        ((10, -15), Pathway.VIA_01, 0),
        ((20, 15), Pathway.VIA_10, 0),
        ((0, -15), Pathway.COUNTERCLOCKWISE, 2),
    ],
)
def test_the_four_pathways_have_the_designs_of_the_paper(q, pathway, snaps):
    cycle = pair(*q).cycle()
    assert cycle.pathway is pathway
    assert str(cycle.sequence) == pathway.value
    assert len(cycle.snaps) == snaps
    assert pathway.is_directed == (snaps > 0)


def test_a_sequence_is_a_sequence_of_states():
    sequence = pair(20, 0).cycle().sequence
    assert list(sequence) == ["00", "10", "11", "01", "00"]
    assert len(sequence) == 5 and sequence[2] == "11"
    assert sequence == "00>10>11>01>00" and sequence != "00>01>11>10>00"
    assert repr(sequence) == "Sequence('00>10>11>01>00')"
    assert len({sequence, pair(21, 0).cycle().sequence}) == 1


def test_only_two_cells_have_a_pathway():
    assert sw.Chain([INNER]).cycle().pathway is None
    assert sw.Chain([INNER] * 3).cycle().pathway is None


def test_cells_that_share_the_motion_take_no_named_pathway():
    spring = sw.Cell(sw.Band((0, 0), (-0.030, 0.0), rest_length=0.001))
    stiffer = sw.Cell(sw.Band((0, 0), (-0.030, 0.0), rest_length=0.001, stiffness=30))
    cycle = sw.Chain([spring, stiffer]).cycle()
    assert not cycle.snaps
    assert cycle.pathway is Pathway.OTHER


def test_a_path_that_starts_between_the_stops_begins_with_its_first_vertex():
    from stepwell.sequences.cycles import sequence_of

    chain = pair(20, 0)
    assert str(sequence_of(chain.path([0.005, 0.040], start=[0.005, 0.0]))) == "10>11"
    assert str(sequence_of(chain.path([0.005, 0.010], start=[0.005, 0.0]))) == "-0"


def test_a_sequence_is_read_from_the_text_it_prints():
    sequence = sw.Sequence.parse("000 > 010>011>111>101>001>000")
    assert str(sequence) == "000>010>011>111>101>001>000"
    assert sequence.orders == ((1, 2, 0), (1, 0, 2))
    assert sw.Sequence.parse("00>11>00").orders is None
    assert sw.Sequence.parse("00>10>00>01>00").orders is None


@pytest.mark.parametrize("text", ["", "0>", "00>1", "00>1x>00", "inner"])
def test_a_text_that_is_no_sequence_is_refused_with_an_example(text):
    with pytest.raises(ValueError, match="as in 00>10>11>01>00"):
        sw.Sequence.parse(text)
