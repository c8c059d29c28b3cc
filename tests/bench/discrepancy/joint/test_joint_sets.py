"""Sets of waveform effects: what is hidden is named, nothing where nothing is, no nearest name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.checkpoint.codec import from_plain, to_plain
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.likelihood import fitness
from bench.discrepancy.joint.polish import fitted, polished, shares, with_shares
from bench.discrepancy.joint.rows import fewer
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.sizes import Sizes, estimates
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.unformed import beside_unformed
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.effects.receiver.quantisation import Quantisation
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40
KINDS = (PulseRinging, NoiseFloor, PathLoss)
RINGING = PulseRinging(ring_db=-14.0, ring_delay_ns=5.0)


def recordings(hidden: Added = (), seed: int = 3) -> pd.DataFrame:
    """Return rows of 40 links with CIRs; SIMULATED."""
    rng = np.random.default_rng(seed)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": [f"t{i % 3}" for i in range(LINKS)],
            "rx": [f"r{i % 4}" for i in range(LINKS)],
        }
    )
    made = Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77)
    return made.table(frame)


def compared(frame: pd.DataFrame) -> tuple[Resimulation, View]:
    """Return rows beside a simulator that hides nothing."""
    window = window_of(frame)
    codes = link_codes(frame)
    rows = view(frame, codes, np.arange(len(frame)), window)
    return Resimulation(Simulator(Base(), (), 11, "test"), window), rows


def choice_of(frame: pd.DataFrame) -> WaveChoice:
    """Return what the sets of three kinds say."""
    comparison, rows = compared(frame)
    return Sets(comparison, rows, rows, KINDS).chosen()


def names(choice: WaveChoice) -> set[str]:
    """Return the names of a choice."""
    return {effect.name for effect in choice.named}


def test_what_is_hidden_is_named_with_its_size_and_nothing_beside_it():
    found = choice_of(recordings((RINGING,)))
    assert names(found) == {"pulse-ringing"}
    assert not found.unexplained
    (made,) = found.added
    assert isinstance(made, PulseRinging)
    assert made.ring_delay_ns == pytest.approx(5.0, abs=0.7)
    assert from_plain(to_plain(found, {}), {}) == found  # the journal keeps it


def test_nothing_is_named_where_nothing_is_hidden():
    found = choice_of(recordings())
    assert names(found) == set()
    assert not found.unexplained


def test_two_that_are_hidden_are_both_named():
    found = choice_of(recordings((RINGING, NoiseFloor(level_db=2.0))))
    assert names(found) == {"pulse-ringing", "noise-floor"}


def test_what_no_effect_does_is_no_nearest_name():
    frame = recordings()
    turned = [np.roll(cir, 9) * 0.5 + cir for cir in frame["cir"]]  # an echo of no known effect
    lost = [cir * (1 + 0.5 * np.sin(np.arange(len(cir)))) for cir in turned]
    comparison, rows = compared(frame.assign(cir=lost))
    found = Sets(comparison, rows, rows, (NoiseFloor, PathLoss)).chosen()
    assert found.unexplained
    assert names(found) == set()


def test_no_name_is_sure_where_links_are_far_off_beside_it():
    """Every link has an echo of its own beside the ringing: no smooth form of anything."""
    rng = np.random.default_rng(8)
    frame = recordings((RINGING,))
    late = rng.integers(15, 60, LINKS).repeat(len(frame) // LINKS)
    echoed = [cir + 0.6 * np.roll(cir, by) for cir, by in zip(frame["cir"], late, strict=True)]
    found = choice_of(frame.assign(cir=echoed).drop(columns="noise_std"))
    assert found.unlisted
    assert names(found) == {RINGING.name}  # which is there, and alike in all rows
    assert "looks most like" in found.likeness()
    assert "noise" in found.likeness()  # which a log of the noise, the same as ever, would deny
    denied = choice_of(frame.assign(cir=echoed))
    assert denied.unexplained
    assert "noise" not in denied.likeness()


def test_a_fit_of_all_parameters_at_once_is_likelier_than_where_it_began():
    comparison, rows = compared(recordings((RINGING,)))
    given = Statistics(comparison, rows)
    begun = replace(RINGING, ring_db=-20.0, ring_delay_ns=5.6)
    first, last = fitted(given, (begun,)), polished(given, (begun,))
    assert first is not None
    assert last is not None
    assert last.nats > first.nats + 10
    again = fitness(given, last.moments, last.moments.left, last.responses, last.parameters)
    assert again == last.nats


def test_shares_of_bounds_lead_back_to_the_values():
    (made,) = with_shares((RINGING,), shares((RINGING,)))
    assert vars(made) == pytest.approx(vars(RINGING))


@pytest.mark.parametrize(("listed", "needed"), [(True, True), (False, False)])
def test_a_form_that_is_right_is_needed_beside_something_without_one(
    listed: bool, needed: bool
) -> None:
    frame = recordings((RINGING,))
    if not listed:  # all of it once more, later than any ringing
        frame = recordings()
        frame = frame.assign(cir=[cir + 0.5 * np.roll(cir, 9) for cir in frame["cir"]])
    comparison, rows = compared(frame)
    given = Statistics(comparison, rows)
    bare, named = fitted(given, ()), polished(given, (RINGING,))
    assert bare is not None
    assert named is not None
    brings = beside_unformed(given, named) - beside_unformed(given, bare)
    assert (brings > 0) is needed
    assert named.nats > bare.nats + NAME_NATS  # by itself it brings much


def test_sizes_hold_what_is_hidden_and_say_what_nothing_tells():
    frame = recordings((RINGING,))
    comparison, rows = compared(frame)
    fit = polished(Statistics(comparison, rows), (replace(RINGING, ring_db=-16.0),))
    assert fit is not None
    sizes = Sizes(Statistics(comparison, rows, members=8))
    found = {one.name: one for one in sizes(comparison, rows, (), fit.effects[0])}
    for name in ("ring_db", "ring_delay_ns"):
        assert found[name].determined
        assert found[name].low <= getattr(RINGING, name) <= found[name].high
    assert not found["ring_offset_mhz"].determined  # what does not ring on does not turn


def test_how_fast_a_tone_turns_is_not_told_by_powers() -> None:
    """Of 37, 45, 62 and 90 MHz a user read 95, 108, 124 and 97, three outside their intervals."""
    tone = NarrowbandInterference(level_db=8.0)
    found = {one.name: one for one in estimates(tone, np.full((2, 4), 0.02))}
    assert found["level_db"].determined
    assert not found["offset_mhz"].determined


def test_a_rounding_that_leaves_nothing_of_weak_samples_is_compared_by_the_rest() -> None:
    coarse = Quantisation(step_counts=900.0)
    comparison, rows = compared(recordings((coarse,)))
    made = Sets(comparison, rows, fewer(rows, 10), (PathLoss,), ((coarse,),))
    assert made.start.names == (coarse.name,)
    assert list(made.screen.points) == [PathLoss.name]
