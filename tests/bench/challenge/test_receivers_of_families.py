"""What the last families have in common: noise as measured, pulses that come later, cases again."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from bench.challenge.cases import make_case
from bench.challenge.families import (
    aviary_listener,
    baths_probe,
    bowls_dial,
    breadworks_balance,
    brickworks_reader,
    canal_staff,
    cathedral_lectern,
    circus_lamp,
    colliery_geophone,
    distillery_safe,
    gasworks_meter,
    granary_sieve,
    icerink_timer,
    laundry_meter,
    lighthouse_lens,
    manege_handset,
    mint_assay,
    observatory_plate,
    opera_console,
    planetarium_almanac,
    pottery_cone,
    ropewalk_telltale,
    roundhouse_recorder,
    saltworks_gauge,
    sawmill_decoder,
    shipyard_lookout,
    tramshed_bell,
    watermill_hopper,
)
from bench.challenge.families.case import SCHEDULE, turn_of

OF_ITS_OWN = {
    "manege": {"mid_x", "pace", "into_s"},
    "opera": {"arm_m", "turn_rad", "into_s"},
    "brickworks": {"gait", "slew_rad", "into_s"},
    "roundhouse": {"from_r", "go_rad", "into_s"},
    "aviary": {"heads", "wheel", "into_s"},
    "sawmill": {"pace", "curl", "into_s"},
    "laundry": {"lever", "gap_s", "into_s"},
    "bowls": {"bias", "wide", "into_s"},
    "canal": {"craft", "reach", "done_s"},
    "saltworks": {"gang", "swing", "done_s"},
    "observatory": {"sort", "arm", "into_s"},
    "baths": {"beat", "wears", "into_s"},
    "circus": {"throw", "girth", "into_s"},
    "colliery": {"begins", "phase", "into_s"},
    "granary": {"craft", "outset", "into_s"},
    "icerink": {"sort", "heads", "into_s"},
    "breadworks": {"kind", "toward", "into_s"},
    "shipyard": {"bears", "begins", "into_s"},
    "ropewalk": {"heads", "turn", "into_s"},
    "planetarium": {"bears", "sense", "into_s"},
    "cathedral": {"gait", "broad", "into_s"},
    "distillery": {"sort", "aim", "into_s"},
    "mint": {"way", "bears", "into_s"},
    "watermill": {"gang", "faces", "into_s"},
    "gasworks": {"trade", "works", "into_s"},
    "lighthouse": {"calling", "stirs", "into_s"},
    "tramshed": {"duty", "goes", "into_s"},
    "pottery": {"trade", "stirs", "into_s"},
}
"""Columns that a world works with and no recording has."""
Draws = Callable[[np.random.Generator, int], np.ndarray]
Pulses = Callable[[np.ndarray], np.ndarray]
Later = Callable[[np.ndarray, np.ndarray], np.ndarray]


@pytest.mark.parametrize(
    ("noise_of", "of_sizes", "last"),
    [
        (manege_handset.hiss, manege_handset.OF_SIZES, -0.17),
        (opera_console.hiss, opera_console.OF_SIZES, -0.2),
        (brickworks_reader.rustle, brickworks_reader.OF_SIZES, -0.2),
        (roundhouse_recorder.crackle, roundhouse_recorder.OF_SIZES, -0.2),
        (aviary_listener.murmur, aviary_listener.OF_SIZES, -0.2),
        (sawmill_decoder.rasp, sawmill_decoder.OF_SIZES, -0.2),
        (laundry_meter.sizzle, laundry_meter.OF_SIZES, -0.2),
        (bowls_dial.rush, bowls_dial.OF_SIZES, -0.2),
        (canal_staff.swash, canal_staff.OF_SIZES, -0.2),
        (saltworks_gauge.lapping, saltworks_gauge.OF_SIZES, -0.2),
        (observatory_plate.sky, observatory_plate.OF_SIZES, -0.2),
        (baths_probe.gurgle, baths_probe.OF_SIZES, -0.2),
        (circus_lamp.applause, circus_lamp.OF_SIZES, -0.2),
        (colliery_geophone.trickling, colliery_geophone.OF_SIZES, -0.2),
        (granary_sieve.pouring, granary_sieve.OF_SIZES, -0.2),
        (icerink_timer.scraping, icerink_timer.OF_SIZES, -0.2),
        (breadworks_balance.kneading, breadworks_balance.OF_SIZES, -0.2),
        (shipyard_lookout.surf, shipyard_lookout.OF_SIZES, -0.2),
        (ropewalk_telltale.creaking, ropewalk_telltale.OF_SIZES, -0.2),
        (planetarium_almanac.starlight, planetarium_almanac.OF_SIZES, -0.2),
        (cathedral_lectern.sough, cathedral_lectern.OF_SIZES, -0.2),
        (distillery_safe.seething, distillery_safe.OF_SIZES, -0.2),
        (mint_assay.jingling, mint_assay.OF_SIZES, -0.2),
        (watermill_hopper.trundling, watermill_hopper.OF_SIZES, -0.2),
        (gasworks_meter.hissing, gasworks_meter.OF_SIZES, -0.2),
        (lighthouse_lens.breaking, lighthouse_lens.OF_SIZES, -0.2),
        (tramshed_bell.arcing, tramshed_bell.OF_SIZES, -0.2),
        (pottery_cone.blunging, pottery_cone.OF_SIZES, -0.2),
    ],
)
def test_noise_is_alike_from_sample_to_sample_as_measured(
    noise_of: Draws, of_sizes: float, last: float
) -> None:
    """In a DW1000 by .32, -.17 and -.20 after one, two and three samples."""
    noise = noise_of(np.random.default_rng(3), 900)
    assert np.abs(noise).std() == pytest.approx(of_sizes, rel=0.01)
    alike = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 2 for k in range(4)]
    assert np.allclose(alike, [1.0, 0.32, -0.17, last], atol=0.015)


@pytest.mark.parametrize(
    ("pulses", "later", "within"),
    [
        (manege_handset.pulses, manege_handset.put_off, 0.03),
        (opera_console.struck, opera_console.later, 0.02),
        (brickworks_reader.pulses, brickworks_reader.delayed, 0.02),
        (roundhouse_recorder.pulses, roundhouse_recorder.held_back, 0.02),
        (aviary_listener.calls, aviary_listener.deferred, 0.02),
        (sawmill_decoder.humps, sawmill_decoder.held, 0.02),
        (laundry_meter.lobes, laundry_meter.belated, 0.02),
        (bowls_dial.pulses, bowls_dial.retarded, 0.02),
        (canal_staff.splines, canal_staff.detained, 0.02),
        (saltworks_gauge.humps, saltworks_gauge.lagged, 0.02),
        (observatory_plate.stars, observatory_plate.exposed_later, 0.02),
        (baths_probe.ripples, baths_probe.held_under, 0.02),
        (circus_lamp.flashes, circus_lamp.encored, 0.02),
        (colliery_geophone.booms, colliery_geophone.hauled_back, 0.02),
        (granary_sieve.swells, granary_sieve.trickled_later, 0.02),
        (icerink_timer.shouts, icerink_timer.skated_late, 0.02),
        (breadworks_balance.loaves, breadworks_balance.proved_later, 0.02),
        (shipyard_lookout.combers, shipyard_lookout.hove_to, 0.02),
        (ropewalk_telltale.tufts, ropewalk_telltale.strung_out, 0.02),
        (planetarium_almanac.glows, planetarium_almanac.set_later, 0.02),
        (cathedral_lectern.chimes, cathedral_lectern.lingered, 0.02),
        (distillery_safe.drops, distillery_safe.run_later, 0.02),
        (mint_assay.coins, mint_assay.rolled_later, 0.02),
        (watermill_hopper.grains, watermill_hopper.ground_later, 0.02),
        (gasworks_meter.puffs, gasworks_meter.piped_later, 0.02),
        (lighthouse_lens.gleams, lighthouse_lens.ebbed, 0.02),
        (tramshed_bell.peals, tramshed_bell.tolled_later, 0.02),
        (pottery_cone.thuds, pottery_cone.cast_later, 0.02),
    ],
)
def test_what_comes_later_keeps_its_size_and_falls_off_at_the_end(
    pulses: Pulses, later: Later, within: float
) -> None:
    wave = pulses(np.full(4, 60.0)).astype(np.complex128)
    late = np.array([0.0, 3.0, 10.4, 400.0])
    moved = np.abs(later(wave, late))
    assert np.allclose(moved[:3], pulses(60.0 + late[:3]), atol=within)
    assert moved[3].max() < 1e-9


@pytest.mark.parametrize(
    ("family", "mode"), sorted({(one, mode) for mode, one in SCHEDULE if one in OF_ITS_OWN})
)
def test_cases_are_the_same_again_and_know_all_that_they_tell(family: str, mode: str) -> None:
    turns = (n for n in range(60) if turn_of(n, (family,)).mode == mode)
    number = [next(turns) for _ in range(2)][1]  # the first hides nothing
    case, again = (make_case(number, 4, (family,)) for _ in range(2))
    assert case.drawn == again.drawn
    assert case.drawn.hidden
    for one, other in ((case.recorded, again.recorded), (case.truth, again.truth)):
        assert one.frame["range_m"].equals(other.frame["range_m"])
        told = one.frame.drop(columns=["cir", "obstacles"], errors="ignore")
        assert not told.isna().any(axis=None)
        assert not OF_ITS_OWN[family] & {*told}
