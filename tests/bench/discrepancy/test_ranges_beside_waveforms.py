"""What ranges show beside waveforms of tables that were made with numpy alone."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy import Diagnosis, diagnose
from bench.recordings.table import Recordings

LINKS, ROWS, SAMPLES, FIRST = 40, 8, 72, 12.0
PULSE = 1.7  # samples
GO_WITH_LEVELS_M = 0.012  # per dB: one multipath makes a first path strong and early, or neither


def _places(rng: np.random.Generator) -> pd.DataFrame:
    """Return 40 links of 8 rows, 2.5 to 22 m long, of links that keep a shadowing of 2.2 dB."""
    link = np.repeat(np.arange(LINKS), ROWS)
    ends = rng.integers(0, 5, LINKS), rng.integers(0, 7, LINKS)
    distance_m = np.exp(rng.uniform(np.log(2.5), np.log(22.0), LINKS))
    return pd.DataFrame(
        {
            "link": [f"link {i}" for i in link],
            "tx": [f"anchor {i}" for i in ends[0][link]],
            "rx": [f"tag {i}" for i in ends[1][link]],
            "true_range_m": distance_m[link] + rng.uniform(-0.05, 0.05, len(link)),
            "temperature_c": rng.uniform(12, 30, LINKS)[link],
            "sample_period_ns": 1.0016,
            "shadowing_db": rng.normal(0, 2.2, LINKS)[link],
        }
    )


def _heard(places: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return ranges, levels and waveforms: a first path, eight echoes of any phase, and noise."""
    rows = len(places)
    multipath_db = rng.normal(0, 1.1, rows)
    far_db = -57 - 20 * np.log10(places["true_range_m"]) + places["shadowing_db"]
    level_dbm = far_db.to_numpy() + multipath_db
    error_m = GO_WITH_LEVELS_M * multipath_db + rng.normal(0, 0.018, rows)
    since = np.arange(SAMPLES) - FIRST
    wave = np.exp(-0.5 * (since / PULSE) ** 2) * 10 ** (multipath_db[:, None] / 20)
    for _ in range(8):
        late, size = rng.uniform(4, 45, (rows, 1)), rng.normal(0, 1, (2, rows, 1))
        echo = 0.25 * (size[0] + 1j * size[1]) * np.exp(-late / 14)
        wave = wave + echo * np.exp(-0.5 * ((since - late) / PULSE) ** 2)
    size = 3000 * 10 ** ((far_db.to_numpy()[:, None] + 75) / 20)
    noise = rng.normal(0, 60, (2, rows, SAMPLES))
    heard = np.abs(size * wave + noise[0] + 1j * noise[1])
    return places.drop(columns="shadowing_db").assign(
        error_m=error_m,
        rx_power_dbm=level_dbm,
        noise_std=rng.normal(39, 1.5, rows),
        first_path_index=FIRST + rng.normal(0, 0.05, rows),
        cir=list(heard.astype(np.float32)),
    )


def _biased(heard: pd.DataFrame) -> pd.DataFrame:
    """Hide 9 mm per dB of the level that a link has in the mean."""
    level_dbm = heard.groupby("link")["rx_power_dbm"].transform("mean")
    bias_m = np.clip(-0.009 * (level_dbm + 78), -0.1, 0.08)
    return heard.assign(error_m=heard["error_m"] + bias_m)


def _rounded(heard: pd.DataFrame) -> pd.DataFrame:
    """Hide that ranges are printed in steps of 15 cm."""
    step = np.round((heard["true_range_m"] + heard["error_m"] - 0.04) / 0.15)
    return heard.assign(error_m=0.15 * step + 0.04 - heard["true_range_m"])


def _plain(heard: pd.DataFrame) -> pd.DataFrame:
    return heard


def _diagnosed(hidden: object) -> Diagnosis:
    rng = np.random.default_rng(20)
    places = _places(rng)
    recorded = hidden(_heard(places, rng))  # type: ignore[operator]
    simulated = pd.concat([_heard(places, rng) for _ in range(2)], ignore_index=True)
    for one in (recorded, simulated):
        one["range_m"] = one["true_range_m"] + one["error_m"]
    return diagnose(Recordings(recorded, "numpy"), Recordings(simulated, "o", simulator="numpy"))


@pytest.mark.parametrize(
    ("hidden", "names"),
    [(_biased, [("power-bias",)]), (_rounded, [("range-rounding",)]), (_plain, [])],
)
def test_ranges_beside_waveforms_are_named(hidden: object, names: list[tuple[str, ...]]) -> None:
    found = _diagnosed(hidden)

    assert [*found.selection.names] == names
    if hidden is _rounded:
        effect = found.added[0]
        assert (effect.step_m, effect.origin_m) == pytest.approx((0.15, 0.04))  # type: ignore[attr-defined]
