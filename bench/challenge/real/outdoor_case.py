"""`outdoor`, line of sight: the power-dependent bias, told from distance."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.real.case import Check, RealCase, Tell, first_named, markdown_table
from bench.discrepancy.latent import power_curve
from bench.discrepancy.observables import Window
from bench.discrepancy.split import link_codes
from bench.discrepancy.study import Options, Study, study
from bench.discrepancy.terms import PowerCurve
from bench.discrepancy.world import Resimulation, view
from bench.physics.base import Base
from bench.physics.effects.ranging.power_bias import published_bias_m
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
SEEN = (
    "environment", "tx", "rx", "range_m", "true_range_m", "rx_power_dbm", "first_path_power_dbm",
    "noise_std", "preamble_count", "reply_time_s", "tx_x_m", "tx_y_m", "tx_z_m", "rx_x_m",
    "rx_y_m", "rx_z_m",
)  # fmt: skip
FADE_DBM = -86.0  # below this the outdoor link is in a null of the ground reflection


def outdoor(table: Recordings, seed: int, tell: Tell) -> RealCase:
    """Line of sight outdoors, split by height: is it the power-dependent bias, or distance."""
    frame = table.frame
    sight = frame[frame["los"].astype(bool)].reset_index(drop=True)
    shown = sight[[c for c in SEEN if c in sight]].assign(
        link="height " + sight["tx_z_m"].map("{:.3f} m".format)
    )
    recorded = Recordings(shown, "outdoor, line of sight", table.licence)
    options = Options(seed, observables=("error_m",), waveform=False)
    found = study(recorded, Simulator(Base(channel=5), name="base"), options, tell)
    spread = heights_out(shown)
    confirmed = confirm_spread(found)
    named = first_named(found)
    slope, p = slope_at_fixed_distance(shown)
    curve = next((e for e in found.added if isinstance(e, PowerCurve)), None)
    checks = (
        Check("names the power-dependent bias, not distance", named, named == "power-bias"),
        Check(
            "at one and the same distance, error falls as the level rises",
            f"{100 * slope:+.2f} cm per dB above {FADE_DBM:g} dBm, p = {p:.3g} "
            "(permutation over heights)",
            slope < 0 and p < 0.05,
        ),
        Check(
            "spread at least halved on heights held out (each in turn)",
            f"{100 * spread[0]:.1f} cm -> {100 * spread[1]:.1f} cm; on the confirm heights "
            f"{100 * confirmed[0]:.1f} cm -> {100 * confirmed[1]:.1f} cm",
            spread[1] <= spread[0] / 2,
        ),
        Check(
            "fitted curve compared with the published one, point by point",
            "see the table" if curve else "no curve was fitted",
            curve is not None,
        ),
    )
    return RealCase("outdoor, line of sight", found, checks, tuple(_curve_lines(curve)))


def heights_out(frame: pd.DataFrame) -> tuple[float, float]:
    """Return the standard deviation of the error, and of what the bias curve leaves, in metres.

    The curve of each height is fitted on all other heights.
    """
    links = link_codes(frame)
    error = (frame["range_m"] - frame["true_range_m"]).to_numpy(np.float64)
    left = np.empty(len(frame))
    world = Resimulation(Simulator(Base(channel=5)), Window())
    for height in np.unique(links):
        kept, held = np.flatnonzero(links != height), np.flatnonzero(links == height)
        learnt = view(frame, links, kept[::4], Window(), ("error_m",), False)
        curve = power_curve(world, learnt, ())
        assert curve is not None
        aside = view(frame, links, held, Window(), ("error_m",), False)
        guess = np.interp(curve.level_dbm(aside.scene), curve.levels_dbm, curve.bias_m)
        left[held] = error[held] - guess
    return float(error.std()), float(left.std())


def confirm_spread(found: Study) -> tuple[float, float]:
    """Return the standard deviation of the residual range error on confirm heights, in metres."""
    seen = found.confirmed
    which = seen.before.names.index("error_m")
    before = float(np.nanstd(seen.before.residual[:, which]))
    return before, float(np.nanstd(seen.after.residual[:, which]))


def slope_at_fixed_distance(frame: pd.DataFrame, permutations: int = 999) -> tuple[float, float]:
    """Return the slope of error over logged level (m/dB) within distances, and its p value.

    One value per position; every height's mean error is removed first. Levels in a null of the
    ground reflection are left out: there the bounce inside the pulse shortens ranges. Under the
    null the levels of different heights at one distance are exchangeable.
    """
    error = frame["range_m"] - frame["true_range_m"]
    place = [frame["link"], frame["tx_x_m"]]
    means = pd.DataFrame({"e": error, "p": frame["rx_power_dbm"]}).groupby(place).mean()
    means = means.reset_index()
    means["e"] -= means.groupby("link")["e"].transform("mean")
    means = means[means["p"] > FADE_DBM]
    level = means["p"] - means.groupby("tx_x_m")["p"].transform("mean")
    left = means["e"] - means.groupby("tx_x_m")["e"].transform("mean")
    x, y = level.to_numpy(np.float64), left.to_numpy(np.float64)
    seen = float(x @ y)
    rng = np.random.default_rng(0)
    groups = list(means.groupby("tx_x_m").indices.values())
    null = np.empty(permutations)
    for number in range(permutations):
        shuffled = x.copy()
        for rows in groups:
            shuffled[rows] = x[rng.permutation(rows)]
        null[number] = shuffled @ y
    p = (1 + np.sum(np.abs(null) >= abs(seen))) / (permutations + 1)
    return seen / float(x @ x), float(p)


def _curve_lines(curve: PowerCurve | None) -> list[str]:
    """Return the fitted and the published bias, both zero at -77 dBm, as a Markdown table."""
    if curve is None:
        return []
    levels = np.arange(-61.0, -94.0, -2.0)
    fitted = np.interp(levels, curve.levels_dbm, curve.bias_m)
    zero = float(np.interp(-77.0, curve.levels_dbm, curve.bias_m))
    rows = pd.DataFrame(
        {
            "true level (dBm)": levels,
            "fitted (cm)": 100 * (fitted - zero),
            "published (cm)": 100 * published_bias_m(levels),
        }
    )
    rows["fitted - published (cm)"] = rows["fitted (cm)"] - rows["published (cm)"]
    note = f"Both curves are zero at -77 dBm; the fitted constant there is {100 * zero:.1f} cm."
    return [*markdown_table(rows), "", note]
