"""What every new family does as much as those before it; SIMULATED tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import ks_2samp, kstest

from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge.shown import moved_of, nothing_of, shift_of, tables_of, with_speed

FAMILIES = (
    "observatory", "baths", "circus", "colliery", "granary", "icerink", "breadworks",
    "shipyard", "ropewalk", "planetarium", "cathedral", "distillery", "mint", "watermill",
    "gasworks", "lighthouse", "tramshed", "pottery",
)  # fmt: skip
DRAWS = ("error_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count")


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize(("mode", "most"), [("ranges", 600), ("CIR", 360)])
def test_twin_draws_of_which_none_hides_a_thing_differ_no_more_than_by_chance(
    family: str, mode: str, most: int
) -> None:
    """Over 20 seeds, p by Kolmogorov and Smirnov of a row each link are as even as chances are."""
    made = [nothing_of(family, seed, mode) for seed in range(20)]
    for column in DRAWS:
        p = []
        for one in made:
            sides = [t.groupby("link")[column].first() for t in (one.recorded, one.simulated)]
            p.append(ks_2samp(*sides).pvalue)
        assert np.mean(np.array(p) < 0.05) <= 0.2, column
        assert np.median(p) > 0.2, column
        assert kstest(p, "uniform", alternative="greater").pvalue > 0.003, column
    assert all(300 < len(one.recorded) < most for one in made)


OWN = {
    "observatory": "red-lamps-warm-their-sconces",
    "baths": "pumps-shake-their-arches",
    "circus": "gusts-rack-their-poles",
    "colliery": "tubs-hunt-on-their-rails",
    "granary": "sacks-rub-in-chutes",
    "icerink": "pairs-hold-gives-as-they-turn",
    "breadworks": "cams-worn-between-stands",
    "shipyard": "drums-roll-on-thinner-flanges",
    "ropewalk": "strands-harden-and-draw-sledges-sooner",
    "planetarium": "ushers-walk-a-heptagon",
    "cathedral": "labyrinth-laid-oval",
    "distillery": "chains-of-rummagers-fly-out",
    "mint": "coils-spring-open",
    "watermill": "buckets-slip-with-their-belt",
    "gasworks": "lamplighters-cut-their-eights",
    "lighthouse": "gulls-wheel-wider-than-told",
    "tramshed": "sweepers-weave-broader-than-told",
    "pottery": "dippers-reach-further-across",
}
ALIKE = [
    (family, name)
    for family in FAMILIES
    for name in (OWN[family], "clock-offset", "ground-bounce", "")
]


@pytest.mark.parametrize(("family", "name"), ALIKE)
def test_the_truth_is_what_was_recorded_drawn_once_more(family: str, name: str) -> None:
    world: Any = world_of(family)
    made = [world.tables(Draw((name,) if name else (), ratio=1), seed) for seed in range(6)]
    for column in ("error_m", "rx_power_dbm", "first_path_power_dbm"):
        both = [
            pd.concat([getattr(one, side).groupby("link")[column].first() for one in made])
            for side in ("recorded", "truth")
        ]
        assert ks_2samp(*both).pvalue > 0.01


SIZES_M = {
    "antenna-delay": (0.08, 0.3), "antenna-pattern": (0.02, 0.08), "clock-offset": (0.01, 0.06),
    "exchange-motion": (0.004, 0.02), "time-lag": (0.02, 0.09), "power-bias": (0.02, 0.06),
    "range-scale": (0.05, 0.25), "temperature-drift": (0.015, 0.08), "noise-floor": (0.003, 0.02),
    "timestamp-jitter": (0.02, 0.05), "range-rounding": (0.02, 0.06), "blocked-path": (0.2, 0.9),
    "material-delay": (0.03, 0.11), "diffraction": (0.008, 0.04), "ground-bounce": (0.006, 0.06),
}  # fmt: skip
"""Means of what effects do to ranges, about as in the families before."""


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("name", SIZES_M)
def test_effects_move_ranges_by_about_as_much_as_elsewhere(family: str, name: str) -> None:
    low, high = SIZES_M[name]
    world: Any = world_of(family)
    made = [world.tables(Draw((name,), ratio=1), seed).shifts_m[0] for seed in range(3)]
    assert low < np.mean([np.abs(one).mean() for one in made]) < high


LATE_PARTS = {
    "obstructed-path": (0.05, 0.3), "specular-reflections": (0.1, 0.4),
    "ground-bounce": (0.15, 0.5),
    "small-scale-fading": (0.15, 0.45), "diffuse-tail": (0.3, 0.8), "pulse-ringing": (0.15, 0.6),
    "narrowband-interference": (0.03, 0.1), "quantisation": (0.005, 0.06),
}  # fmt: skip
"""Parts by which effects change sizes after first paths, about as in the families before."""
OWN_PARTS = {
    "observatory": {
        "charges-trail-from-size-to-size": (0.08, 0.4), "wells-spill-to-both-sides": (0.15, 0.6),
        "faint-ones-clipped-by-sigmas": (0.08, 0.4),
    },
    "baths": {
        "every-fifth-size-skipped": (0.1, 0.5), "twelves-left-as-cosines": (0.1, 0.6),
        "late-part-averaged-with-its-mirror": (0.1, 0.6),
    },
    "circus": {
        "blocks-read-by-columns": (0.1, 0.6), "odd-ones-left-as-not-foretold": (0.1, 0.6),
        "tape-wows-in-late-part": (0.1, 0.6),
    },
    "colliery": {
        "late-sizes-left-as-steps-up-and-down": (0.1, 0.6),
        "halves-of-late-words-swapped": (0.1, 0.6),
        "strong-late-sizes-by-the-weak-channel": (0.1, 0.6),
    },
    "granary": {
        "eights-left-in-order-of-size": (0.1, 0.6), "late-sizes-evened-by-rank": (0.1, 0.6),
        "late-pairs-left-as-sums-and-differences": (0.1, 0.6),
    },
    "icerink": {
        "swept-gain-left-on": (0.1, 0.6), "late-words-left-as-exclusive-ors": (0.1, 0.6),
        "late-halves-riffled": (0.1, 0.6),
    },
    "breadworks": {
        "late-sizes-dealt-by-a-prime": (0.1, 0.6), "late-sizes-left-companded": (0.1, 0.6),
        "gain-pumps-in-late-part": (0.1, 0.6),
    },
    "shipyard": {
        "late-sizes-left-as-running-means": (0.1, 0.6),
        "late-ink-spreads-before-it-dries": (0.1, 0.6),
        "late-gain-tripped-up-and-down": (0.1, 0.6),
    },
    "ropewalk": {
        "late-sizes-laid-of-three-strands": (0.1, 0.6),
        "late-sizes-follow-at-a-winchs-pace": (0.1, 0.6),
        "late-sizes-left-as-places-among-sevens": (0.1, 0.6),
    },
    "planetarium": {
        "late-sizes-told-as-magnitudes-of-stars": (0.1, 0.6),
        "late-half-shown-before-the-other": (0.1, 0.6),
        "late-sizes-held-from-fibonacci-on": (0.1, 0.6),
    },
    "cathedral": {
        "late-sizes-rung-in-changes": (0.1, 0.6),
        "late-sizes-by-a-needle-that-falls-slowly": (0.1, 0.6),
        "late-counts-begun-anew-when-full": (0.1, 0.6),
    },
    "distillery": {
        "late-tens-lose-heads-and-tails": (0.1, 0.6),
        "late-sevens-told-backwards": (0.1, 0.6),
        "late-sizes-blended-with-those-half-way-on": (0.1, 0.6),
    },
    "mint": {
        "late-eights-told-with-bits-reversed": (0.1, 0.6),
        "late-sizes-evened-by-a-gain-that-follows": (0.1, 0.6),
        "late-sizes-dead-after-crests": (0.1, 0.6),
        "late-sizes-read-by-a-slower-clock": (0.1, 0.6),
        "late-sixes-told-by-size": (0.1, 0.6),
        "every-ninth-late-size-left-out": (0.1, 0.6),
        "grilles-disperse-what-comes-late": (0.1, 0.6),
    },
    "watermill": {
        "hollow-shaft-repeats-what-comes-late": (0.1, 0.6),
        "chaff-soaks-up-what-comes-late": (0.1, 0.6),
        "late-dozens-woven-from-halves": (0.1, 0.6),
        "late-sizes-told-by-a-bent-meter": (0.1, 0.6),
        "late-sizes-through-a-leaking-store": (0.1, 0.6),
        "late-sizes-as-large-as-those-beside": (0.1, 0.6),
        "every-other-late-size-bridged": (0.1, 0.6),
        "late-gain-hums": (0.1, 0.6),
        "late-sizes-folded-under-a-ceiling": (0.1, 0.6),
        "late-nines-told-from-amid": (0.1, 0.6),
    },
    "gasworks": {
        "pipe-sounds-on-with-what-comes-late": (0.1, 0.6),
        "tar-fog-scatters-what-comes-late": (0.1, 0.6),
        "flames-flicker-what-comes-late": (0.1, 0.6),
        "mains-guide-what-comes-late": (0.1, 0.6),
        "late-nines-told-by-thirds-backwards": (0.1, 0.6),
        "late-sizes-mingled-with-the-third-after": (0.1, 0.6),
        "late-sizes-cored-of-their-middle": (0.1, 0.6),
        "late-sizes-by-steps-of-logarithms": (0.1, 0.6),
        "late-fours-told-as-their-first": (0.1, 0.6),
        "late-gain-falls-by-stairs": (0.1, 0.6),
        "late-sizes-foreshown-by-a-needle": (0.1, 0.6),
    },
    "lighthouse": {
        "prisms-fan-out-what-comes-late": (0.1, 0.6),
        "tower-shadows-a-span-of-what-comes-late": (0.1, 0.6),
        "swell-washes-out-what-comes-late": (0.1, 0.6),
        "late-eights-told-odd-and-even": (0.1, 0.6),
        "late-sevens-told-from-ends-inward": (0.1, 0.6),
        "late-sizes-as-plates-blacken": (0.1, 0.6),
        "late-sizes-off-a-dipped-horizon": (0.1, 0.6),
        "late-sixths-joined-by-chords": (0.1, 0.6),
        "late-part-plotted-by-logarithms-of-time": (0.1, 0.6),
        "late-sizes-as-the-middle-of-five": (0.1, 0.6),
        "late-gain-flashes-in-groups": (0.1, 0.6),
        "late-gain-runs-down-like-a-clock": (0.1, 0.6),
    },
    "tramshed": {
        "twisted-wires-turn-what-comes-late": (0.1, 0.6),
        "late-part-keeps-a-ghost-of-the-row-before": (0.1, 0.6),
        "late-sevens-told-as-highest-so-far": (0.1, 0.6),
        "late-sizes-told-as-means-so-far": (0.1, 0.6),
        "late-elevens-turned-by-one-more-each": (0.1, 0.6),
        "late-squares-read-aslant": (0.1, 0.6),
        "late-dozens-carry-larger-ones-on": (0.1, 0.6),
        "late-sizes-by-a-gear-with-play": (0.1, 0.6),
        "late-gain-cut-by-a-breaker": (0.1, 0.6),
        "late-gain-sags-by-what-was-spent": (0.1, 0.6),
        "late-tens-told-as-what-is-left": (0.1, 0.6),
        "late-gain-notched-up-by-a-controller": (0.1, 0.6),
        "late-sizes-as-roots-of-two-off": (0.1, 0.6),
    },
    "pottery": {
        "chequers-of-brick-hold-back-what-comes-late": (0.1, 0.6),
        "spokes-pass-before-what-comes-late": (0.1, 0.6),
        "trays-return-what-comes-late": (0.1, 0.6),
        "late-sizes-fettled-to-the-least-of-three": (0.1, 0.6),
        "late-sizes-told-as-off-their-mean": (0.1, 0.6),
        "late-eights-brought-to-one-height": (0.1, 0.6),
        "late-dozens-wedged-as-clay-is": (0.1, 0.6),
        "late-sizes-by-a-cone-that-bends": (0.1, 0.6),
        "late-sizes-told-as-bends": (0.1, 0.6),
        "late-dozens-by-two-hands-in-turn": (0.1, 0.6),
        "late-gain-shaped-like-a-bottle-kiln": (0.1, 0.6),
        "late-sizes-sieved-by-a-mesh": (0.1, 0.6),
        "late-fours-told-from-both-ends": (0.1, 0.6),
    },
}  # fmt: skip
PARTS = [(f, name, part) for f in FAMILIES for name, part in (LATE_PARTS | OWN_PARTS[f]).items()]


@pytest.mark.parametrize(("family", "name", "part"), PARTS)
def test_effects_change_waveforms_by_about_as_much_as_elsewhere(
    family: str, name: str, part: tuple[float, float]
) -> None:
    made = tables_of(family, name, mode="CIR")
    found, plain = (np.stack([*t["cir"]])[:, 18:] for t in (made.recorded, made.clean))
    low, high = part
    assert low < np.abs(found - plain).mean() / plain.mean() < high


@pytest.mark.parametrize("family", FAMILIES)
def test_only_what_is_hidden_behind_things_is_late_by_far_in_waveforms(family: str) -> None:
    for name in ("specular-reflections", "diffuse-tail", "pulse-ringing", "noise-floor"):
        assert np.abs(shift_of(family, name, mode="CIR")).max() < 0.1, name
    for name in ("obstructed-path", "late-detection"):
        assert shift_of(family, name, mode="CIR").max() > 1.0, name


FAULTS = {
    "observatory": (
        "pole-set-for-another-city", "stairs-of-a-lower-rise", "red-lamps-warm-their-sconces",
        "north-wall-leans-out", "mist-comes-in-by-the-slit", "sconce-knocked-by-a-ladder",
    ),
    "baths": (
        "strokes-reach-less-far", "riders-ride-up-in-bends", "pumps-shake-their-arches",
        "deep-end-settles", "steam-room-left-ajar", "arch-struck-by-a-platform",
    ),
    "circus": (
        "trapezes-ropes-give", "wire-dips-under-walkers", "gusts-rack-their-poles",
        "poles-bow-under-canvas", "smoke-under-lamps", "pole-struck-by-a-lorry",
    ),
    "colliery": (
        "winding-rope-stretches", "tubs-hunt-on-their-rails", "haze-that-draught-clears",
        "drilling-shakes-booms", "traverse-turns-at-each-station", "prop-rammed-by-a-tub",
    ),
    "granary": (
        "sacks-rub-in-chutes", "elevator-racked-aside", "damp-wheat-heats", "augers-bend-back",
        "walls-bulge-when-filled", "spout-bent-by-a-lorry",
    ),
    "icerink": (
        "skaters-lean-in-more-than-told", "penguins-rub-on-wet-ice", "resurfacers-lap-further-in",
        "pairs-hold-gives-as-they-turn", "truss-sags-under-snow", "air-dews-above-ice",
        "tripod-melts-into-the-ice", "mullion-bent-by-a-check",
    ),
    "breadworks": (
        "belts-slip-round-coolers", "castors-clogged-with-dough", "porters-sway-wider-than-told",
        "cams-worn-between-stands", "flue-buckles-as-ovens-heat", "plan-fed-askew",
        "yeast-works-by-warmth-and-hours", "missed-answers-put-on-a-line",
        "corbel-rammed-by-a-rack",
    ),
    "shipyard": (
        "grease-stiffens-on-the-ways", "drums-roll-on-thinner-flanges", "punts-make-leeway",
        "pontoon-rides-the-tide", "hull-lists-with-its-ballast",
        "heights-told-above-a-raking-keel", "mist-lies-up-to-a-height", "medians-of-three-sent",
        "derrick-nudged-by-a-bowsprit",
    ),
    "ropewalk": (
        "yarn-taken-up-as-it-twists", "strands-harden-and-draw-sledges-sooner",
        "rope-laid-longer-than-told", "cradles-geared-by-another-wheel",
        "places-looked-up-at-nearest-beats", "walls-bow-out-under-snow",
        "annexe-rebuilt-askew-since-the-survey", "north-row-taped-from-the-outer-face",
        "answers-booked-to-who-answers-next", "hemp-dust-hangs-by-the-hackles",
        "strut-shoved-by-a-bale-truck",
    ),
    "planetarium": (
        "planets-driven-by-an-equant", "moons-slip-on-their-wheels", "ushers-walk-a-heptagon",
        "wires-sag-under-comets", "trolleys-roll-back", "places-read-off-a-tape-that-wows",
        "dome-swells-in-the-sun", "bearings-from-magnetic-north", "heights-taped-along-the-dome",
        "answers-smoothed-as-they-come", "weak-answers-told-as-the-last",
        "haze-gathers-under-the-dome", "cove-leant-on-by-a-ladder",
    ),
    "cathedral": (
        "thuribles-swing-wider-than-told", "vergers-halt-for-longer", "doves-sink-as-they-glide",
        "labyrinth-laid-oval", "winch-drum-fills-as-it-winds", "processions-cut-their-corners",
        "clock-of-places-set-right-each-quarter", "tower-leans-off-its-plumb",
        "cross-drawn-askew", "heights-told-in-whole-courses-of-stone",
        "places-told-as-middles-of-flags", "answers-kept-until-they-differ-enough",
        "longer-of-two-answers-told", "answers-no-longer-than-a-chain",
        "candles-warm-ways-that-pass-them", "boss-pushed-in-by-a-scaffold",
    ),
    "distillery": (
        "casks-skid-as-they-roll", "chains-of-rummagers-fly-out", "maltmen-tire-as-they-turn",
        "drays-sway-on-the-setts", "hoists-bob-on-their-chains", "cats-close-in-sooner",
        "places-queue-behind-answers", "loft-bends-under-barley", "tape-stretched-when-wet",
        "still-house-laid-out-off-the-square", "upper-lintels-levelled-from-the-loft",
        "answers-overshoot-by-what-they-rose", "answers-vatted-over-a-run",
        "gauge-narrows-past-a-mark", "spirit-vapour-fills-the-still-house",
        "door-between-halls-shut-by-turns", "lintel-shouldered-by-a-still",
    ),
    "mint": (
        "caged-passage-guides-what-passes", "seals-leak-by-what-pressures-differ",
        "presses-swing-further-than-told", "rails-bend-sooner-than-drawn",
        "warders-hurry-across", "coils-spring-open", "ladles-hang-back-as-they-gain",
        "couriers-cut-across-sooner", "places-smoothed-both-ways", "heights-told-by-a-barometer",
        "strongroom-door-swings-its-quoins", "circle-of-the-theodolite-off-centre",
        "levels-sighted-over-a-hot-floor", "batteries-sag-as-answers-crowd",
        "coarse-count-read-before-it-ripples", "bags-of-answers-opened-out-of-order",
        "answers-held-while-presses-strike", "ranges-told-along-the-floor",
        "quoin-barged-by-a-dray",
    ),
    "watermill": (
        "spray-hangs-in-the-wheel-house", "steam-of-damp-grain-by-warmth",
        "rods-of-the-governor-have-play", "wheel-runs-ahead-on-its-heavy-side",
        "sacks-sway-wider-than-told", "millers-round-their-corners",
        "drift-drags-behind-the-stream", "carts-wind-in-tighter", "buckets-slip-with-their-belt",
        "places-foretold-straight-on", "floors-sag-under-full-bins",
        "mill-twists-about-its-shaft", "chain-a-link-short-each-length",
        "storeys-drawn-all-alike", "answers-late-until-charged-again",
        "notch-stuck-in-the-tally-stick", "slips-hung-one-nail-behind",
        "changes-of-ranges-told-by-halves", "sag-of-a-line-taken-off", "hatch-shoved-by-ice",
    ),
    "gasworks": (
        "smoke-hangs-under-the-retort-roof",
        "steam-of-quenched-coke-drifts",
        "fires-glow-through-open-doors",
        "gauge-drags-behind-its-pressure",
        "stokers-reach-further-than-told",
        "barrows-veer-on-a-worn-wheel",
        "bells-turn-in-steeper-guides",
        "skips-surge-on-their-rope",
        "lamplighters-cut-their-eights",
        "rams-driven-by-a-shorter-rod",
        "places-told-at-the-last-tick",
        "yard-leans-towards-the-tank",
        "print-of-the-yard-has-shrunk",
        "made-ground-gives-under-coal",
        "retort-wall-bellies-as-it-heats",
        "answers-wait-for-the-exhausters-stroke",
        "third-answers-told-as-the-second",
        "answers-come-by-a-damped-float",
        "inches-booked-to-a-short-yard",
        "dial-hung-off-its-centre",
        "bracket-bent-by-a-ladder",
    ),
    "lighthouse": (
        "spray-hangs-over-the-weather-side",
        "warm-draught-rises-in-the-tower",
        "beam-heats-ways-that-it-sweeps",
        "tide-gauge-sticks-in-its-well",
        "keepers-cut-their-corners",
        "tenders-carry-their-way-longer",
        "gulls-wheel-wider-than-told",
        "cans-sway-wider-on-the-hoist",
        "lenses-stick-twice-a-turn",
        "donkeys-wind-rope-in-sooner",
        "places-told-by-a-losing-chronometer",
        "heights-sounded-by-a-stretched-line",
        "chart-of-the-rock-sheared",
        "tower-bends-in-the-gale",
        "rock-heaves-with-the-tide",
        "answers-late-until-the-clock-is-wound",
        "answers-booked-by-dead-reckoning",
        "answers-lean-to-the-watchs-first",
        "heaving-line-stretches-by-its-own-weight",
        "knots-of-the-line-counted-too-large",
        "vernier-read-from-its-wrong-end",
        "cresset-bent-by-a-sea",
    ),
    "tramshed": (
        "brake-dust-hangs-along-the-pits",
        "air-shimmers-about-the-drying-boiler",
        "feeder-sections-fed-by-turns",
        "relay-holds-between-two-pressures",
        "trams-turn-out-at-later-blades",
        "traversers-overrun-their-lever",
        "sweepers-weave-broader-than-told",
        "jacks-sink-between-strokes",
        "blocks-hang-on-longer-falls",
        "poles-trail-behind-their-rope",
        "places-drawn-to-the-middle-of-a-turn",
        "rosettes-hang-low-amid-their-spans",
        "survey-closed-without-its-misclosure",
        "girders-bow-under-lifted-cars",
        "setts-heave-with-frost",
        "answers-late-as-crews-change",
        "answers-merged-with-the-next",
        "first-answers-smeared-by-the-last-caller",
        "tape-spliced-past-a-mark",
        "ranges-told-as-chords-of-a-curve",
        "rosette-torn-by-a-dewired-pole",
    ),
    "pottery": (
        "flint-dust-hangs-in-the-glaze-shop",
        "kiln-warms-ways-that-pass-it",
        "wet-ware-steams-by-warmth",
        "slip-main-fills-and-empties",
        "heat-of-firings-stays-in-walls",
        "boards-turned-tighter-than-told",
        "trucks-roll-on-on-oiled-axles",
        "fettlers-step-further-out-each-round",
        "paddles-geared-by-another-pinion",
        "saggars-slip-on-a-greasy-rope",
        "dippers-reach-further-across",
        "tags-told-where-their-bearers-walk",
        "plan-photographed-by-a-bulging-lens",
        "heights-levelled-from-a-falling-floor",
        "kiln-shoulders-purlins-aside",
        "tags-ride-up-on-stacked-boards",
        "beams-creep-down-through-the-day",
        "answers-slow-after-each-meal",
        "answers-filed-shortest-first",
        "answers-drawn-to-their-links-mean",
        "loudest-answer-of-a-round-drags-the-rest",
        "folding-rule-gives-at-each-joint",
        "worn-end-of-the-rule",
        "purlin-knocked-by-a-falling-saggar",
    ),
}  # fmt: skip
RARER = {"tenders-carry-their-way-longer": 0.03}  # a tender is one in thirty rows beside waveforms
FAULTY = [(family, name) for family, names in FAULTS.items() for name in names]


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
@pytest.mark.parametrize(("family", "name"), FAULTY)
def test_faults_move_ranges_by_more_than_these_scatter(family: str, name: str, mode: str) -> None:
    share, times = moved_of(family, name, mode)
    assert share > RARER.get(name, 0.04)
    assert times > 1.5


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_or_short_meanwhile(family: str, name: str) -> None:
    assert with_speed(family, name) > 0.6
