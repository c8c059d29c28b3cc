"""Links struck at random, seen in waveforms: which, by what, and that chance alone tells which."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.mixture import Found, Mixture, mixed, of_each
from bench.discrepancy.joint.settings import CLASS_NATS, NAME_NATS, NAME_SHARE
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.straight import straight_nats
from bench.discrepancy.joint.strikes import (
    _known,
    as_often_short,
    but_devices,
    by_one,
    enough,
    is_longer,
    least_nats,
    predicted,
    read_long,
    rows_jump,
    strike_beside,
    told,
    told_of_both,
    told_which,
)
from bench.discrepancy.select.link_mixture import Strike
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 60
KINDS: tuple[type[Effect], ...] = (ObstructedPath, BlockedPath, PulseRinging)
STRUCK = ObstructedPath(share=0.3, loss_db=18.0, delay_m=0.3)


def recordings(hidden: Added, seed: int = 3) -> pd.DataFrame:
    """Return rows of 60 links with CIRs; SIMULATED."""
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
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Resimulation(Simulator(Base(), (), 11, "test"), window), rows


def found_in(frame: pd.DataFrame, added: Added = ()) -> Strike | None:
    """Return what strikes links beside `added`."""
    return strike_beside(*compared(frame), KINDS, added)


def test_an_obstruction_of_some_links_is_found_with_the_links_and_their_share():
    frame = recordings((STRUCK,))
    found = found_in(frame)
    assert found is not None
    assert found.effect.name == "obstructed-path"
    assert found.evidence.value > NAME_NATS
    share = found.parameters[0]
    assert share.low <= STRUCK.share <= share.high
    late = frame.groupby(link_codes(frame))["error_m"].median()
    assert late[found.struck].median() > late.drop(found.struck).median() + STRUCK.delay_m / 2


@pytest.mark.parametrize("hidden", [(), (PathLoss(shadowing_db=4.0),), (PulseRinging(),)])
def test_what_strikes_no_links_is_no_obstruction(hidden: Added):
    assert found_in(recordings(hidden)) is None


def test_an_obstruction_beside_what_all_links_share_is_found_beside_it():
    ringing = PulseRinging(ring_db=-10.0, ring_delay_ns=5.0)
    found = found_in(recordings((ringing, STRUCK)), (ringing,))
    assert found is not None
    assert found.effect.name == "obstructed-path"


def test_an_obstruction_of_most_links_is_found_beside_what_all_links_share():
    """Effects are fitted to the links it spares, which are the fewer ones."""
    ringing = PulseRinging(ring_db=-10.0, ring_delay_ns=5.0)
    found = found_in(recordings((ringing, replace(STRUCK, share=0.7))), (ringing,))
    assert found is not None
    assert found.effect.name == "obstructed-path"
    assert found.parameters[0].low <= 0.7 <= found.parameters[0].high


def test_what_strikes_simulated_links_alike_is_none_left_out():
    """The simulator has its own obstructions: links far off are on both sides."""
    frame = recordings((STRUCK,))
    comparison, rows = compared(frame)
    alike = Resimulation(Simulator(Base(), (STRUCK,), 11, "test"), window_of(frame))
    for simulator, there in ((comparison, True), (alike, False)):
        mixture = Mixture(Statistics(simulator, rows), (), ObstructedPath)
        best = mixture.fitted()
        brought = best.best - mixture.spared.sum() if best else 0.0
        by_chance = mixture.by_chance(best) if best else 0.0
        assert bool(brought - by_chance > NAME_NATS) is there


def test_the_mixture_has_the_share_of_links_that_are_likelier_struck():
    more = np.where(np.arange(100) < 25, 50.0, -50.0)
    found = mixed({}, np.zeros(100), more)
    assert found.share == pytest.approx(0.25)
    assert ((found.odds > 0) == (more > 0)).all()
    assert found.best == pytest.approx(25 * (50 + np.log(0.25)) + 75 * np.log(0.75))


def test_struck_links_must_read_longer_and_by_chance():
    rng = np.random.default_rng(4)
    struck = np.arange(80) < 20
    offset_m = rng.normal(0, 0.02, 80)
    assert is_longer(offset_m + 0.3 * struck, struck)
    assert not is_longer(offset_m - 0.3 * struck, struck)
    assert not is_longer(offset_m, struck)


@pytest.mark.parametrize(("short", "often"), [(0, False), (3, False), (8, True)])
def test_what_makes_as_many_ways_shorter_strikes_none(short: int, often: bool) -> None:
    """Two nodes hang at each other's place: links of theirs read long, others short, by metres."""
    rng = np.random.default_rng(3)
    offset_m, struck = rng.normal(0, 0.05, 80), np.arange(80) < 9
    offset_m[struck] += rng.uniform(2, 4, 9)
    offset_m[40 : 40 + short] -= rng.uniform(0.5, 4, short)
    assert as_often_short(offset_m, struck) is often
    known = rng.normal(size=(80, 3))
    assert not predicted(known, struck)
    known[:, 1] += 2 * struck
    assert predicted(known, struck)
    weakly = np.corrcoef(known[:, 1], struck)[0, 1] ** 2
    assert predicted(known, struck, 0.9 * weakly)
    assert not predicted(known, struck, 1.1 * weakly)


def with_lead(hidden: Added, seed: int) -> pd.DataFrame:
    """Return four rows of each of 80 links, whose CIRs begin well before the path; SIMULATED."""
    rng = np.random.default_rng(seed)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(80)] * 4,
            "true_range_m": np.tile(rng.uniform(2, 15, 80), 4),
        }
    )
    made = Simulator(Base(cir_lead=12), (DiffuseTail(), *hidden), seed, "test").observe(
        scene(frame), seed, 77
    )
    return made.table(frame)


def nats_of_straight(hidden: Effect, seed: int) -> float:
    """Return how sure a straight path is seen in the links that `hidden` makes read longer."""
    late = 0.3
    frame = with_lead((hidden,), seed)
    rows = compared(frame)[1]
    longer_m = (frame["error_m"] - with_lead((), seed)["error_m"]).to_numpy()
    struck = pd.Series(longer_m).groupby(rows.links).median().to_numpy() > late
    return straight_nats(rows, struck, longer_m)


def test_a_weakened_straight_path_is_seen_before_the_detour_and_a_blocked_one_is_not():
    """It stays under the threshold of detection, as all rows of the struck links tell together."""
    weak = ObstructedPath(0.4, loss_db=34.0, loss_spread_db=2.0, common=0.0, detour_m=2.0)
    gone = BlockedPath(0.4, detour_m=2.0)
    for seed in range(3):
        assert nats_of_straight(weak, seed) > CLASS_NATS > nats_of_straight(gone, seed)


def test_where_straight_paths_are_seen_nothing_is_blocked():
    given = Statistics(*compared(recordings((STRUCK,))))
    mixtures = [Mixture(given, (), kind) for kind in (BlockedPath, ObstructedPath)]
    alike = [Found(one, one.begun, 50.0) for one in mixtures if one.begun]
    assert told_kinds(alike, CLASS_NATS + 1) == ["obstructed-path"]
    assert told_kinds(alike, CLASS_NATS - 1) == ["blocked-path", "obstructed-path"]
    assert least_nats(1000.0, alike[1], NAME_NATS - 1) > 1000 * NAME_SHARE - 1
    assert least_nats(1000.0, alike[1], NAME_NATS + 1) < 1000 * NAME_SHARE


def test_straight_paths_that_are_seen_say_nothing_for_a_blocked_path():
    given = Statistics(*compared(recordings((STRUCK,))))
    mixtures = [Mixture(given, (), kind) for kind in (BlockedPath, ObstructedPath)]
    blocked, weakened = (Found(one, one.begun, 0.0) for one in mixtures if one.begun)
    for one, is_enough in ((blocked, False), (weakened, True)):
        least = least_nats(0.0, one, 0.0)
        assert enough(replace(one, nats=least + 1), 0.0, 0.0, 0.0)
        assert enough(replace(one, nats=least - 1), 0.0, 0.0, NAME_NATS) is is_enough


def told_kinds(alike: list[Found], seen: float) -> list[str]:
    """Return the names of the kinds that are left."""
    return [one.mixture.kind.name for one in told(alike, seen)]


def test_struck_links_may_gather_at_a_device_but_not_over_what_else_is_known() -> None:
    """What stands in the way stands near some device; a device that is off is off in all links."""
    device, number = (np.arange(80) % 8 == 0).astype(float), np.linspace(-1.7, 1.7, 80)
    standard = (device - device.mean()) / device.std()
    given = SimpleNamespace(known=np.stack([number, standard], axis=1), devices=device[:, None])
    every = np.ones(80, bool)
    some = np.isin(np.arange(80), [0, 8, 16, 24, 32, 5, 21, 37, 53, 62, 77])
    assert but_devices(given).shape == (80, 1)
    assert predicted(given.known, some)
    assert not told_which(given, some, every, False)
    assert told_which(given, device > 0, every, False)
    far = np.isin(np.arange(80), [79, 77, 75, 73, 71, 66, 61, 55, 50, 45, 33])
    assert told_which(given, far, every, False)


def test_what_tells_which_struck_links_are_found_sooner_does_not_tell_which_are_struck() -> None:
    rng = np.random.default_rng(5)
    metal, hit = (
        np.arange(80) % 5 == 0,
        np.arange(80) % 4 == 0,
    )  # struck whether behind metal or not
    offset = np.where(hit, 0.4, 0.0) + 0.01 * rng.standard_normal(80)
    found = hit & (metal | (np.arange(80) % 16 == 0))
    known = metal[:, None].astype(np.float64)
    given = SimpleNamespace(known=known, devices=np.zeros((80, 0)))
    every = np.ones(80, bool)
    long = read_long(offset, found)
    np.testing.assert_array_equal(long, hit)
    assert told_of_both(given, metal, metal, every, False)
    assert not told_of_both(given, metal, long, every, False)


def test_links_that_read_long_are_struck_though_waveforms_find_few_of_them() -> None:
    links = np.repeat(np.arange(30), 3)
    ranges = 0.01 * np.random.default_rng(2).normal(size=(3, 90))
    ranges[0, links < 9] += 0.6
    ranges[0, 88] += 0.6  # one row in ninety jumps off its link
    made = Ensemble(("error_m",), ("m",), ranges[..., None], links)
    few, all_long = np.arange(30) < 1, np.arange(30) < 9
    assert rows_jump(made, few)
    assert not rows_jump(made, few | all_long)


def test_rows_of_struck_links_may_jump_as_noise_finds_weak_first_paths_late() -> None:
    rng, links = np.random.default_rng(2), np.repeat(np.arange(30), 5)
    struck = np.arange(30) < 9
    ranges = 0.01 * rng.normal(size=(3, 150))
    ranges[0] += np.where(struck[links], 0.4 + rng.exponential(0.4, 150), 0.0)
    assert not rows_jump(Ensemble(("error_m",), ("m",), ranges[..., None], links), struck)
    ranges[0] += np.where(rng.random(150) < 0.2, 0.6, 0.0)  # rows of all links do
    assert rows_jump(Ensemble(("error_m",), ("m",), ranges[..., None], links), struck)


def test_strikes_are_weighed_by_what_is_known_beside_effects_too() -> None:
    """A coarse quantisation loses the weak paths of struck links, and with them an observable."""
    coarse: Added = (PathLoss(),)
    asked: set[Added] = set()

    class Given:
        def knowing(self, added: tuple[Effect, ...]) -> Given:
            asked.add(added[:-1])
            assert isinstance(added[-1], ObstructedPath)
            return self

    _known(Given(), [ObstructedPath], [(), coarse])  # type: ignore[arg-type]
    assert asked == {(), coarse}


def test_one_odd_link_strikes_no_others() -> None:
    mixture = Mixture(Statistics(*compared(recordings(()))), (), ObstructedPath)
    assert mixture.begun
    chance = mixture.by_chance(mixture.begun)
    for odds, alone in (([82.0, 1.0, 2.0], True), ([30.0, 30.0 + chance, 25.0], False)):
        best = replace(mixture.begun, odds=np.array([*odds, *[-20.0] * (LINKS - 3)]))
        found = Found(mixture, best, 0.0)
        found = replace(found, nats=float(of_each(found.best).sum()))
        assert by_one(found, 0.0, 0.0) is alone
        assert not by_one(found, 0.0, 200.0)  # straight paths that are seen speak for more
