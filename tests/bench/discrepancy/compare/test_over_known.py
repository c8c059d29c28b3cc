"""What a simulated table does over devices, clocks and headings is taken off where it is plain."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.compare.known_blocks import known_blocks
from bench.discrepancy.compare.over import found_over
from bench.discrepancy.compare.over_known import OverKnown, over_known
from bench.discrepancy.data.observables import Observables
from bench.physics.units import Floats

LINKS, DELAYS_M = 70, np.array([0.0, 0.15, -0.1, 0.08, -0.12])
Law = Callable[[pd.DataFrame], Floats]


def lobe(frame: pd.DataFrame) -> Floats:
    """Return what a body does that wears the tag, in metres [n]."""
    return np.asarray(0.1 * (1 - np.cos(np.radians(frame["azimuth_deg"]))), np.float64)


def delays(frame: pd.DataFrame) -> Floats:
    """Return what anchors are late by, in metres [n]."""
    return np.asarray(DELAYS_M[frame["rx"].str[1:].astype(int)], np.float64)


def clocks(frame: pd.DataFrame) -> Floats:
    """Return what anchors' clocks make of the reply time, in metres [n]."""
    ppm = 10 * DELAYS_M[frame["rx"].str[1:].astype(int)]
    return np.asarray(0.299792458 / 2 * ppm * 1000 * frame["reply_time_s"], np.float64)


def drift(frame: pd.DataFrame) -> Floats:
    """Return what the temperature does, in metres [n]."""
    return np.asarray(0.008 * (frame["temperature_c"] - 25), np.float64)


def ripple(frame: pd.DataFrame) -> Floats:
    """Return what a mirror at height zero makes of a range, by the sum of two phasors [n]."""
    far, heights = frame["true_range_m"], 4 * frame["tx_z_m"] * frame["rx_z_m"]
    longer = np.sqrt(far**2 + heights)
    ray = -0.5 * far / longer * np.exp(-2j * np.pi * (longer - far) / 0.0462)
    return np.asarray(((longer - far) * ray / (1 + ray)).to_numpy().real.clip(-0.3, 0.3))


def power(frame: pd.DataFrame) -> Floats:
    """Return what more transmit power does, in metres [n]."""
    return np.asarray(0.01 * (frame["tx_power_dbm"] + 8), np.float64)


def nothing(frame: pd.DataFrame) -> Floats:
    return np.zeros(len(frame))


def table(seed: int, law: Law, links: int = LINKS) -> pd.DataFrame:
    """Return ranges between tags and five anchors, off by a law; SIMULATED."""
    rng = np.random.default_rng(seed)
    rows = np.repeat(np.arange(links), 4)
    frame = pd.DataFrame(
        {"link": [f"{seed}-{n}" for n in rows], "true_range_m": rng.uniform(3, 18, links)[rows],
         "azimuth_deg": rng.uniform(0, 360, links)[rows], "tx": [f"t{n % 7}" for n in rows],
         "rx": np.array([f"a{n}" for n in range(5)])[rng.integers(0, 5, links)][rows],
         "temperature_c": rng.uniform(10, 40, links)[rows],
         "reply_time_s": rng.uniform(0.3e-3, 1.5e-3, links)[rows]}
    )  # fmt: skip
    if law is power:
        powers = np.random.default_rng([seed, 8]).choice([-14.3, -8.3, -2.3], links)
        frame = frame.assign(tx_power_dbm=powers[rows])
    if law is ripple:
        more = np.random.default_rng([seed, 7])
        heights = {f"{end}_z_m": more.uniform(1, 2.5, links)[rows] for end in ("tx", "rx")}
        frame = frame.assign(**heights, channel=5)
    noise_m = rng.normal(0, 0.03, len(rows))
    return frame.assign(range_m=frame["true_range_m"] + law(frame) + noise_m)


def errors(frame: pd.DataFrame) -> Floats:
    return np.asarray(frame["range_m"] - frame["true_range_m"], np.float64)


def found(ours: pd.DataFrame, theirs: pd.DataFrame) -> OverKnown:
    """Return what is plain of the errors of a simulated table."""
    seen = Observables(("error_m",), ("m",), errors(theirs)[:, None])
    links = np.asarray(pd.factorize(theirs["link"])[0], np.intp)
    return over_known(seen, links, tuple(known_blocks(ours, theirs)))


@pytest.mark.parametrize("law", [lobe, delays, clocks, drift, ripple, power])
def test_a_matched_row_is_made_one_of_ours(law: Law) -> None:
    ours, theirs = table(1, law), table(2, law)
    pick = np.random.default_rng(0).permutation(len(theirs))
    apart = errors(theirs)[pick] - errors(ours)
    left = apart + found(ours, theirs).change(("error_m",), pick)[:, 0]
    most_m = 0.075 if law is ripple else 0.065  # two scatters of 0.03 m, and what the fit is off
    assert np.std(left) < most_m
    assert np.std(left) < 0.75 * np.std(apart)


def of_links(left: Floats, frame: pd.DataFrame) -> float:
    """Return the variance of links' means of what rows leave [n]."""
    return float(pd.Series(left).groupby(frame["link"].to_numpy()).mean().var())


def test_simulated_links_are_told_by_others_as_recorded_ones_are() -> None:
    """Each keeps an offset; a fit that it takes part in would leave it less of that."""
    inside, outside = [], []
    for seed in range(0, 40, 2):
        rng = np.random.default_rng([seed, 1])
        ours, theirs = (
            frame.assign(range_m=frame["range_m"] + np.repeat(rng.normal(0, 0.05, LINKS), 4))
            for frame in (table(seed, delays), table(seed + 1, delays))
        )
        known = found(ours, theirs)
        assert known.taken
        own = known.change(("error_m",), np.arange(len(theirs)))[:, 0]
        done = sum((one.block.ours @ one.size)[:, 0] for one in known.taken)
        inside.append(of_links(errors(theirs) + own - done, theirs))
        outside.append(of_links(errors(ours) - done, ours))
    assert np.mean(inside) == pytest.approx(np.mean(outside), rel=0.1)


def test_what_goes_with_the_distance_is_told_beside_it() -> None:
    """Anchors that are far away: neither is taken for the other, in part."""

    def far(seed: int) -> pd.DataFrame:
        frame = table(seed, nothing)
        noise_m = errors(frame)
        late = 0.12 * (frame["rx"] == "a1") - 0.12 * (frame["rx"] == "a4")
        near = np.where(frame["rx"] == "a1", 0.7, np.where(frame["rx"] == "a4", 1.4, 1.0))
        frame["true_range_m"] *= near
        return frame.assign(range_m=frame["true_range_m"] + late + noise_m)

    ours, theirs = far(1), far(2)
    seen = Observables(("error_m",), ("m",), errors(theirs)[:, None])
    links = np.asarray(pd.factorize(theirs["link"])[0], np.intp)
    over = found_over(ours, theirs, seen, theirs["true_range_m"].to_numpy(np.float64), links)
    done = np.asarray(over.known.done())[:, 0]
    late_m = done[theirs["rx"] == "a1"].mean() - done[theirs["rx"] == "a4"].mean()
    assert late_m == pytest.approx(0.24, abs=0.03)


def test_what_nothing_plainly_does_is_left() -> None:
    taken = [found(table(seed, nothing), table(seed + 1, nothing)).taken for seed in range(8)]
    assert not any(taken)


@pytest.mark.parametrize("lacks", ["channel", "tx_z_m"])
def test_two_rays_need_heights_and_a_channel(lacks: str) -> None:
    ours, theirs = table(1, ripple), table(2, ripple)
    assert [one.block.ours.shape[1] for one in found(ours, theirs).taken] == [8]
    assert not found(ours, theirs.drop(columns=lacks)).taken


def test_a_heading_is_no_bearing() -> None:
    ours = table(1, lobe).drop(columns="azimuth_deg")
    assert not found(ours, table(2, lobe)).taken


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("law", [lobe, delays, drift, ripple])
def test_what_both_tables_have_is_nothing_left_out(law: Law) -> None:
    said = bench.diagnose(table(1, law), table(2, law))
    assert not said.selection.names
    assert said.law is None


@pytest.mark.filterwarnings("ignore")
def test_what_recordings_alone_have_is_left_out() -> None:
    assert "antenna-pattern" in bench.diagnose(table(1, lobe), table(2, nothing)).headline
    assert "temperature-drift" in bench.diagnose(table(1, drift), table(2, nothing)).headline


@pytest.mark.parametrize("few", [1, 2, 3])
def test_a_link_that_missed_its_first_path_is_no_delay_of_its_device(few: int) -> None:
    """SIMULATED: of the few links of a device one reads 1.7 m long; anchors keep their delays."""
    ours, theirs = table(1, delays), table(2, delays)
    for frame in (ours, theirs):
        rare = frame["link"].isin(frame["link"].unique()[:few])
        frame.loc[rare, "tx"] = "rare"
    theirs.loc[theirs["link"] == theirs["link"].iloc[0], "range_m"] += 1.7
    known = found(ours, theirs)
    done = sum((one.block.ours @ one.size)[:, 0] for one in known.taken)
    by = pd.DataFrame({"done": done, "rx": ours["rx"], "rare": ours["tx"] == "rare"})
    beside = by["done"] - by[~by["rare"]].groupby("rx")["done"].mean()[by["rx"]].to_numpy()
    assert np.abs(beside[by["rare"]]).max() < 0.2
    assert np.ptp(by[~by["rare"]].groupby("rx")["done"].mean()) > 0.2
