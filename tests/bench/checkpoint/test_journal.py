"""A diagnosis that was stopped goes on where it was, and ends in the same bits."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.checkpoint.codec import NotPlainError, from_plain, to_plain
from bench.checkpoint.journal import FOLDER, Kept
from bench.discrepancy import Options, diagnose, method
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.report.document import summary
from bench.discrepancy.select import stepwise
from bench.discrepancy.sets import turn
from bench.physics.base import Base
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings
from bench.runner.diagnosis import fingerprint

BASE = Simulator(Base(), (TimestampJitter(),), 3, "mine")
QUICK = Options(search_rows=300, fit_rows=120, observables=("error_m",), waveform=False)
KINDS = {
    "clock-offset": ClockOffset,
    "temperature-drift": TemperatureDrift,
    "material-delay": MaterialDelay,
}


@pytest.fixture(scope="module")
def recorded() -> Recordings:
    """Return recordings with two effects hidden in them, for more than one round."""
    rng = np.random.default_rng(0)
    link = np.repeat(np.arange(32), 8)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "true_range_m": rng.uniform(2, 20, 32)[link],
            "tx": [f"t{i % 3}" for i in link],
            "rx": [f"r{i % 4}" for i in link],
            "reply_time_s": rng.uniform(2e-4, 1e-3, len(link)),
            "temperature_c": rng.uniform(0, 50, 32)[link],
        }
    )
    hidden = BASE.with_effect(TemperatureDrift(slope_mm_per_c=8.0))
    hidden = hidden.with_effect(ClockOffset(device_spread_ppm=0.6))
    made = hidden.observe(scene(frame), 50, cir=False).table(frame)
    return Recordings(made.drop(columns="clock_offset_ppm", errors="ignore"), "test")


@pytest.fixture(scope="module")
def whole(recorded):
    """Return the diagnosis that was never stopped, as its JSON, and how many rounds it took."""
    said: list[str] = []
    found = diagnose(recorded, BASE, QUICK, said.append, KINDS)
    return json.dumps(summary(found)), sum(words.startswith("searching") for words in said)


@pytest.fixture
def calls(monkeypatch) -> Counter[str]:
    """Return how often each of the long steps is really done, from now on."""
    done: Counter[str] = Counter()

    def counted(module, name: str):
        real = getattr(module, name)

        def work(*args, **kwargs):
            done[name] += 1
            return real(*args, **kwargs)

        return work

    for module, name in (
        (stepwise, "locate"),
        (stepwise, "explain"),
        (turn, "chosen"),
        (method, "polished"),
        (stepwise, "pruned"),
    ):
        monkeypatch.setattr(module, name, counted(module, name))
    return done


def stopping_at(number: int):
    """Return a progress line that interrupts when a round begins."""

    def tell(words: str) -> None:
        if words == f"searching (round {number})":
            raise KeyboardInterrupt

    return tell


def resumed(recorded: Recordings, folder: Path) -> str:
    """Return the JSON of a diagnosis that goes on from what is in the folder."""
    found = diagnose(recorded, BASE, QUICK, kinds=KINDS, journal=Kept(folder, "same"))
    return json.dumps(summary(found))


def test_a_stopped_diagnosis_ends_in_the_same_bits_and_repeats_no_round(
    recorded, whole, calls, tmp_path
):
    text, rounds = whole
    assert rounds >= 2
    with pytest.raises(KeyboardInterrupt):
        diagnose(recorded, BASE, QUICK, stopping_at(rounds), KINDS, Kept(tmp_path, "same"))
    assert calls["locate"] >= calls["chosen"] == rounds - 1
    assert Kept(tmp_path, "same").finished == rounds - 1
    calls.clear()
    assert resumed(recorded, tmp_path) == text
    assert calls["locate"] == 1
    assert calls["chosen"] <= 1
    assert calls["explain"] <= 1
    calls.clear()
    assert resumed(recorded, tmp_path) == text
    assert not calls


def test_a_diagnosis_that_keeps_its_steps_is_that_which_does_not(recorded, whole, tmp_path):
    assert resumed(recorded, tmp_path) == whole[0]
    names = [path.name for path in sorted((tmp_path / FOLDER / "same").glob("0*.json"))]
    taken = [int(name[:4]) for name in names]
    assert taken == list(range(len(taken)))  # every result had a plain form


def test_what_is_kept_of_another_input_or_damaged_is_not_used(recorded, whole, calls, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        diagnose(recorded, BASE, QUICK, stopping_at(2), KINDS, Kept(tmp_path, "other"))
    assert not Kept(tmp_path, "same").started
    (tmp_path / FOLDER / "other").rename(tmp_path / FOLDER / "same")
    for path in (tmp_path / FOLDER / "same").iterdir():
        path.write_text(path.read_text()[:-3])
    calls.clear()
    assert Kept(tmp_path, "same").finished == 0
    assert resumed(recorded, tmp_path) == whole[0]
    assert calls["chosen"] >= 1
    assert calls["locate"] == whole[1]
    Kept(tmp_path, "same").clear()
    assert not (tmp_path / FOLDER).exists()


def test_the_fingerprint_changes_with_all_that_decides(recorded):
    frame = recorded.frame
    other = Recordings(frame.assign(error_m=frame["error_m"] + 1e-12), "test")
    prints = [
        fingerprint(recorded, BASE, QUICK),
        fingerprint(other, BASE, QUICK),
        fingerprint(recorded, BASE.with_effect(TemperatureDrift()), QUICK),
        fingerprint(recorded, other, QUICK),
        fingerprint(recorded, BASE, Options()),
        fingerprint(recorded, BASE, Options(seed=1)),
    ]
    assert len(set(prints)) == len(prints)
    assert fingerprint(recorded, BASE, QUICK) == prints[0]


def test_values_come_back_to_the_last_bit_and_in_the_order_of_their_memory():
    values = np.array([[0.1, np.nan, -0.0], [np.inf, 1e-320, 1 / 3]])
    tally = Tally(("a", "b", "c"), values, np.asfortranarray(values))
    kept = (tally, {"x": [1, None, True]}, np.float32(0.1), TemperatureDrift(slope_mm_per_c=1 / 3))
    back = from_plain(json.loads(json.dumps(to_plain(kept, {}))), {})
    assert back[0].sums.tobytes() == values.tobytes()
    assert back[0].sums.flags.c_contiguous
    assert back[0].counts.flags.f_contiguous
    assert back[1:] == kept[1:]
    assert type(back[2]) is np.float32
    located = Located((), 0.5, 1.0, 2.0, 3, {"error_m": 0.1})
    assert from_plain(to_plain(located, {}), {}) == located


def test_what_cannot_be_read_back_is_not_written_and_no_other_code_is_named():
    for value in (object(), np.array([None]), {1, 2}):
        with pytest.raises(NotPlainError):
            to_plain(value, {})
    with pytest.raises(NotPlainError):
        from_plain({"class": "subprocess:Popen", "fields": {"args": "ls"}}, {})
    with pytest.raises(NotPlainError):
        from_plain({"class": "bench.discrepancy.method:diagnose", "fields": {}}, {})
    assert from_plain(to_plain(Estimate(1.0, 0.0, 2.0), {}), {}) == Estimate(1.0, 0.0, 2.0)
