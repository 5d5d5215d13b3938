"""Searches of chains for state machines, and when their answer is a proof."""

import random

import pytest

import stepwell as sw
from facts import refuses, says
from stepwell.design import Draws, design_machine
from stepwell.sequences import Machine

LAST = "(up | down)* up"
PARITY = "(zero* one zero* one)* zero*"


def test_a_search_finds_a_chain_that_the_engine_confirms():
    machine = Machine.of_language(LAST)
    made = design_machine(machine, cells=2, turns=1, chains=3, steps=0, samples=5)
    way = made.realisation
    inputs = random.Random(0).choices(way.machine.inputs, k=20)
    assert way.simulate(inputs) == machine.run(inputs)
    assert made.successes == sum(
        way.holds_in(Draws(made.chain, made.tolerances, 0).sample(k)) for k in range(5)
    )
    says(str(made).splitlines(), "3 random chains")


def test_a_search_without_a_result_is_not_decided():
    with refuses(sw.Impossible, "not decided", "3 random chains", "one program exchanges") as why:
        design_machine(Machine.of_language(PARITY), cells=2, chains=3)
    assert not why.value.proved


def test_under_a_prescribed_force_a_parity_is_impossible_and_proved():
    with refuses(sw.Impossible, "impossible", "'one'", "acts once") as why:
        design_machine(Machine.of_language(PARITY), actuator_stiffness=0.0)
    assert why.value.proved
    # The advice: a machine without such a word is searched.
    made = design_machine(
        Machine.of_language(LAST), actuator_stiffness=0.0, chains=2, steps=0, samples=2, turns=1
    )
    assert made.chain.actuator_stiffness == 0


@pytest.mark.parametrize(
    "wrong", [{"cells": 0}, {"cells": 7}, {"turns": 3}, {"chains": 0}, {"samples": 0}]
)
def test_sizes_of_a_search_are_checked(wrong):
    with refuses(sw.InputError, f"{next(iter(wrong))} = {next(iter(wrong.values()))}"):
        design_machine(Machine.of_language(LAST), **wrong)
