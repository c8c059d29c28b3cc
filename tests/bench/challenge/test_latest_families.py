"""The families written last: a world each, and laws that are what they are said to be."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge import families
from bench.challenge.cases import make_case
from bench.challenge.families.case import (
    KEPT,
    SCHEDULE,
    WITH_WAVES,
    Draw,
    Law,
    Tables,
    turn_of,
    world_of,
)
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LAST = (
    "garage",
    "manege", "opera", "brickworks", "roundhouse", "aviary", "sawmill",
    "laundry", "bowls", "canal", "saltworks", "observatory", "baths", "circus",
    "colliery", "granary", "icerink", "breadworks", "shipyard", "ropewalk",
    "planetarium", "cathedral", "distillery", "mint", "watermill", "gasworks",
    "lighthouse", "tramshed", *KEPT,
)  # fmt: skip
MODES = [(family, mode) for family in LAST for mode in ("ranges", "CIR")]
PERIOD_OF = {
    "drum-off-centre": "cable_out_m",
    "lashing-rings-passed": "tow_m",
    "wave-machine": "time_s",
    "fridges-run": "time_s",
    "ballast-pumped": "time_s",
    "sump-pumped": "time_s",
    "drier-cycles": "time_s",
    "glycol-pump-cycles": "time_s",
    "shot-blaster-cycles": "time_s",
    "arms-swing": "walked_m",
    "seams-passed": "route_m",
    "wheel-out-of-round": "rope_m",
    "kickboard-posts-passed": "boards_m",
    "revolve-castors-passed": "rim_m",
    "tie-rods-passed": "rods_m",
    "rail-chairs-passed": "chairs_m",
    "folder-cuts": "web_m",
    "wheel-paddles-pass": "rim_m",
    "chain-lugs-pass": "chain_m",
    "fine-gain-cycles": "rx_power_dbm",
    "drum-ribs-pass": "drum_m",
    "heating-loops-passed": "loop_m",
    "chamber-sloshes": "time_s",
    "rope-clamps-pass": "haul_m",
    "dome-rollers-pass": "curb_m",
    "lane-floats-pass": "rope_m",
    "fence-panels-pass": "fence_m",
    "joists-pass-below": "under_m",
    "belt-idlers-pass": "belt_m",
    "chain-pins-pass": "chain_m",
    "panes-pass-alongside": "glide_m",
    "supports-of-the-belt-pass": "spiral_m",
    "ribs-of-the-hull-pass": "keel_m",
    "trestles-pass-underneath": "spun_m",
    "worn-teeth-pass-on-racks": "rack_m",
    "joints-of-flags-pass-underfoot": "paced_m",
    "teeth-of-mash-rakes-pass": "raked_m",
    "ribs-of-reeding-wheels-pass": "reed_m",
    "cogs-of-the-great-spur-pass": "spur_m",
    "flights-of-the-conveyor-pass": "flights_m",
    "rungs-of-the-ladder-pass": "ladder_m",
    "sleepers-pass-underneath": "sleepers_m",
    "rollers-of-the-biscuit-way-pass": "rollers_m",
}
WORLD_OF_DEVICE = {
    "beam": "rx",
    "beacon": "rx",
    "lamp": "rx",
    "pillar": "rx",
    "mast": "rx",
    "truss": "rx",
    "gantry": "rx",
    "column": "rx",
    "bolt": "rx",
    "balcony": "rx",
    "girder": "rx",
    "letter": "tx",
    "cleat": "rx",
    "buckstay": "rx",
    "pier": "rx",
    "stanchion": "rx",
    "nestbox": "rx",
    "brace": "rx",
    "louvre": "tx",
    "knot": "rx",
    "davit": "rx",
    "vane": "rx",
    "sconce": "rx",
    "pole": "rx",
    "post": "rx",
    "prop": "rx",
    "spout": "rx",
    "mullion": "rx",
    "corbel": "rx",
    "derrick": "rx",
    "cove": "rx",
    "boss": "rx",
    "lintel": "rx",
    "quoin": "tx",
    "hatch": "rx",
    "bracket": "tx",
    "cresset": "rx",
    "rosette": "tx",
    "purlin": "rx",
    "strut": "tx",
    "arch": "tx",
    "anchor": "tx",
}


@cache
def _tables(family: str, names: tuple[str, ...], mode: str = "ranges", **more: Any) -> Tables:
    world: Any = world_of(family, mode)
    made: Tables = world.tables(Draw(names, ratio=1, **more), 9)
    return made


def _laws(form: str) -> list[tuple[str, str, Law]]:
    worlds: list[tuple[str, Any]] = [(family, world_of(family)) for family in LAST]
    return [(f, n, law) for f, w in worlds for n, law in w.LAWS.items() if form in law.forms]


def _shift(made: Tables) -> np.ndarray:
    assert made.shifts_m is not None
    return made.shifts_m[0]


def _end(device: str) -> str:
    return WORLD_OF_DEVICE[device.rstrip("0123456789")]


def _there(made: Tables, device: str) -> np.ndarray:
    return (made.recorded[_end(device)] == device).to_numpy()


def test_no_family_takes_code_from_another() -> None:
    folder = Path(families.__file__).parent
    for path in folder.glob("*.py"):
        own = path.stem.split("_")[0]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                names = {f"{node.module}.{one.name}" for one in node.names}
            else:
                names = {one.name for one in getattr(node, "names", ())}
            ours = {name.split(".")[3] for name in names if name.startswith(families.__name__)}
            assert {one.split("_")[0] for one in ours} <= {own, "case"}, path.stem


def test_each_has_at_least_eight_laws_of_its_own_and_nearly_all_names() -> None:
    for family in LAST:
        both: list[Any] = [world_of(family, mode) for mode in ("ranges", "CIR")]
        laws, known = ({*both[0].__dict__[n], *both[1].__dict__[n]} for n in ("LAWS", "KNOWN"))
        assert family in WITH_WAVES
        assert len(laws) >= 13
        assert min(len(one.LAWS) for one in both) >= 8
        assert len(known) >= 24
        assert not laws & known


def test_their_tables_have_other_columns_and_lengths() -> None:
    has = {key: {*_tables(key[0], (), key[1]).recorded} for key in MODES}
    assert {"los"} <= has["bowls", "ranges"] - has["aviary", "ranges"]
    assert {"los"} <= has["roundhouse", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["laundry", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m"} <= has["circus", "CIR"] - has["canal", "CIR"]
    assert {"los"} <= has["saltworks", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m"} <= has["observatory", "CIR"] - has["saltworks", "CIR"]
    assert {"los"} <= has["observatory", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m"} <= has["baths", "ranges"] - has["saltworks", "ranges"]
    assert {"los"} <= has["baths", "CIR"] - has["aviary", "CIR"]
    assert {"los"} <= has["canal", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m"} <= has["laundry", "CIR"] - has["bowls", "CIR"]
    assert {"los"} <= has["sawmill", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m"} <= has["circus", "ranges"] - has["sawmill", "ranges"]
    assert {"room_x_m"} <= has["colliery", "CIR"] - has["saltworks", "CIR"]
    assert {"room_x_m", "los"} <= has["granary", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["icerink", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["breadworks", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["shipyard", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["ropewalk", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["planetarium", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["cathedral", "CIR"] - has["aviary", "CIR"]
    assert {"los"} <= has["garage", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["distillery", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["mint", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["watermill", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["gasworks", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["lighthouse", "ranges"] - has["aviary", "ranges"]
    assert {"room_x_m", "los"} <= has["tramshed", "CIR"] - has["aviary", "CIR"]
    assert {"room_x_m", "los"} <= has["pottery", "ranges"] - has["aviary", "ranges"]
    lengths = {len(_tables(family, (), "CIR").recorded["cir"][0]) for family in LAST}
    assert lengths == {
        146, 164, 134, 152, 174, 128, 144, 122, 148, 140,
        158, 116, 98, 124, 168, 142, 150, 154, 160, 162,
        170, 176, 120, 130, 118, 184, 178, 186, 136,
    }  # fmt: skip


@pytest.mark.parametrize(("family", "mode"), MODES)
def test_nothing_hidden_is_nothing_added_and_sums_add_up(family: str, mode: str) -> None:
    made = _tables(family, (), mode)
    pd.testing.assert_frame_equal(made.recorded, made.clean)
    assert abs(made.clean["error_m"].median()) < 0.02
    ends = (made.clean[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx"))
    far = np.linalg.norm(np.subtract(*ends), axis=1)
    assert np.allclose(far, made.clean["true_range_m"])


@pytest.mark.parametrize(("family", "mode"), MODES)
def test_another_mix_is_nearer_and_farther(family: str, mode: str) -> None:
    made = _tables(family, (), mode, paired=False, same_mix=False)
    assert made.simulated is not None
    near, far = (t["true_range_m"].mean() for t in (made.recorded, made.simulated))
    assert far > 1.2 * near
    same = _tables(family, (), mode, paired=False)
    assert same.simulated is not None
    assert not {*same.simulated["link"]} & {*same.recorded["link"]}


@pytest.mark.parametrize("family", LAST)
def test_waveforms_are_the_same_from_the_same_seed(family: str) -> None:
    first, again = (_tables.__wrapped__(family, ("diffuse-tail",), "CIR") for _ in range(2))
    pd.testing.assert_frame_equal(first.recorded, again.recorded)
    pd.testing.assert_frame_equal(first.truth, again.truth)


@pytest.mark.parametrize(("family", "name", "law"), _laws("position"))
def test_a_device_elsewhere_is_as_far_off_as_is_said(family: str, name: str, law: Law) -> None:
    made = _tables(family, (name,), strength=0.05)
    there = _there(made, law.devices[0])
    ends = [made.recorded[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx")]
    own = ends[0] - ends[1] if _end(law.devices[0]) == "tx" else ends[1] - ends[0]
    toward = own / np.linalg.norm(own, axis=1)[:, None]
    vector = np.linalg.lstsq(toward[there], _shift(made)[there], rcond=None)[0]
    assert np.linalg.norm(vector) == pytest.approx(0.05 * law.value, rel=0.03)
    assert not _shift(made)[~there].any()


@pytest.mark.parametrize(("family", "name", "law"), _laws("swap"))
def test_swapped_devices_have_each_others_ranges(family: str, name: str, law: Law) -> None:
    made = _tables(family, (name,))
    one, other = law.devices
    end, moving = ("tx", "rx") if _end(one) == "tx" else ("rx", "tx")
    rows = made.recorded
    place = rows[rows[end] == other][[f"{end}_{a}_m" for a in "xyz"]].to_numpy()[0]
    there = _there(made, one)
    far = np.linalg.norm(rows.loc[there, [f"{moving}_{a}_m" for a in "xyz"]] - place, axis=1)
    clean = made.clean["error_m"][there]
    assert np.allclose(rows["range_m"][there] - clean, far)
    assert not _shift(made)[~there & ~_there(made, other)].any()


@pytest.mark.parametrize(("family", "name", "law"), _laws("unit"))
def test_another_unit_is_the_factor_that_is_said(family: str, name: str, law: Law) -> None:
    made = _tables(family, (name,), strength=2.0)
    ratio = made.recorded["range_m"] / made.clean["range_m"]
    assert np.allclose(ratio, np.where(_there(made, law.devices[0]), law.value, 1.0))


@pytest.mark.parametrize(("family", "name", "law"), _laws("step"))
def test_a_step_has_two_values_as_far_apart_as_is_said(family: str, name: str, law: Law) -> None:
    values = np.unique(np.abs(_shift(_tables(family, (name,)))))
    assert np.allclose(values, [0.0, law.value])


@pytest.mark.parametrize(("family", "name", "law"), _laws("periodic"))
def test_what_is_periodic_has_the_period_that_is_said(family: str, name: str, law: Law) -> None:
    made = _tables(family, (name,))
    turn = 2 * np.pi * made.recorded[PERIOD_OF[name]].to_numpy() / law.value
    waves = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    assert np.linalg.lstsq(waves, _shift(made), rcond=None)[1] < 1e-12


LATER = ("antenna-delay", "range-scale", "material-delay", "blocked-path", "diffraction")


@pytest.mark.parametrize("family", LAST)
@pytest.mark.parametrize("name", LATER)
def test_what_makes_ways_longer_is_late_and_grows(family: str, name: str) -> None:
    less, more = (_shift(_tables(family, (name,), strength=s)) for s in (0.5, 2.0))
    assert more.mean() > 1.2 * less.mean() > 0
    assert np.quantile(more, 0.02) > -0.1


@pytest.mark.parametrize("family", LAST)
def test_what_needs_motion_leaves_what_rests(family: str) -> None:
    for name in ("time-lag", "exchange-motion"):
        made = _tables(family, (name,))
        rows = made.recorded.groupby("link")["true_range_m"]
        moves, once = rows.transform(np.ptp) > 0, rows.transform("size") == 1
        moves |= once & (np.abs(_shift(made)) > 0)
        assert np.abs(_shift(made)[~moves]).max() < 1e-9
        assert 0.1 < np.mean(~moves) < 0.5
        assert np.abs(_shift(made)[moves]).mean() > 0.004


DARKER = ("path-loss", "material-delay", "diffraction", "level-control")


@pytest.mark.parametrize(("family", "mode"), MODES)
@pytest.mark.parametrize("name", DARKER)
def test_what_loses_power_lowers_the_first_path(family: str, mode: str, name: str) -> None:
    made = _tables(family, (name,), mode)
    lost = made.recorded["first_path_power_dbm"] - made.clean["first_path_power_dbm"]
    assert -8 < lost.mean() < -0.25
    assert np.quantile(lost, 0.95) < 0.8


@pytest.mark.parametrize("family", LAST)
def test_the_true_table_has_what_the_recorded_one_has(family: str) -> None:
    for mode in ("ranges", "CIR"):
        made = _tables(family, ("antenna-delay",), mode, strength=2.0)
        means = [t.groupby(["tx", "rx"])["error_m"].mean() for t in (made.recorded, made.truth)]
        assert float((means[0] - means[1]).abs().median()) < 0.04
        assert float(means[0].std()) > 0.05


@pytest.mark.parametrize("family", LAST)
def test_tails_and_rings_come_after_the_first_path_alone(family: str) -> None:
    for name in ("diffuse-tail", "pulse-ringing"):
        made = _tables(family, (name,), "CIR")
        sizes = [np.stack(list(t["cir"])) for t in (made.recorded, made.clean)]
        before, after = (
            float(sizes[0][:, part].mean() / sizes[1][:, part].mean())
            for part in (slice(0, 6), slice(20, 36))
        )
        assert before == pytest.approx(1, abs=0.12)
        assert after > 1.03, name


@pytest.mark.parametrize("family", LAST)
def test_an_obstructed_path_is_weak_and_late_on_some_links(family: str) -> None:
    made = _tables(family, ("obstructed-path",), "CIR")
    late = made.recorded["error_m"] - made.clean["error_m"]
    struck = late > 0.2
    assert 0.1 < struck.mean() < 0.4
    assert struck.groupby(made.recorded["link"]).nunique().eq(1).mean() > 0.9
    lost = made.recorded["first_path_power_dbm"] - made.clean["first_path_power_dbm"]
    assert lost[struck].mean() < -3
    assert abs(lost[~struck].mean()) < 0.5


CHANNELS = {
    "garage": 9,
    "manege": 1, "opera": 4,
    "brickworks": 3, "roundhouse": 5, "aviary": 3, "sawmill": 1,
    "laundry": 5, "bowls": 4, "canal": 9, "saltworks": 2, "observatory": 3,
    "baths": 9, "circus": 5, "colliery": 3, "granary": 4, "icerink": 2,
    "breadworks": 5, "shipyard": 3, "ropewalk": 1, "planetarium": 5,
    "cathedral": 2, "distillery": 5, "mint": 9, "watermill": 3, "gasworks": 1,
    "lighthouse": 2, "tramshed": 9, "pottery": 4,
}  # fmt: skip
AGAIN = [(m, f, CHANNELS[f]) for m, f in SCHEDULE if f in CHANNELS and m.endswith("again")]


@pytest.mark.parametrize(("mode", "family", "channel"), sorted({*AGAIN}))
def test_recordings_have_the_levels_of_the_channel_that_they_state(
    mode: str, family: str, channel: int
) -> None:
    """Channel 9 is an octave above channel 2: its levels are 6 dB lower at the same place."""
    turns = (n for n in range(36) if turn_of(n).family == family and turn_of(n).mode == mode)
    case = make_case(next(turns), 7)  # nothing is hidden in the first
    assert isinstance(case.simulated, Simulator)
    assert case.simulated.base.channel == case.recorded.frame["channel"].iloc[0] == channel
    made = case.simulated.observe(scene(case.recorded.frame), 5, 3, cir=mode == "CIR again")
    off = case.recorded.frame["rx_power_dbm"] - np.asarray(
        made.table(case.recorded.frame)["rx_power_dbm"]
    )
    assert abs(off.median()) < 0.5
