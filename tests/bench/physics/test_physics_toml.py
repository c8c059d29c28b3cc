from pathlib import Path

import pytest

from bench.errors import BenchError
from bench.physics import Base, Simulator, from_toml, read_toml, to_toml
from bench.physics.rooms import Rooms
from bench.plugins import plugins


def test_every_effect_round_trips() -> None:
    effects = tuple(plugin.load()() for plugin in plugins("effects"))
    simulator = Simulator(Base(pulse_fwhm=1 / 3 + 2), effects, seed=7, name='a "name"\n')
    assert from_toml(to_toml(simulator)) == simulator


def test_rooms_round_trips_and_is_what_it_says() -> None:
    simulator = Rooms().simulator
    assert from_toml(to_toml(simulator)) == simulator
    assert len(simulator.effects) >= 12


def test_seed_of_rooms_can_be_set() -> None:
    assert Rooms(seed=5).simulator.seed == 5
    assert Rooms(seed=5).key() != Rooms().key()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x =", "not TOML"),
        ("", "it is empty: expected .base. or"),
        ("sed = 3", "unknown key 'sed'; did you mean 'seed'"),
        ("seed = -1", "seed = -1, expected a whole number"),
        ("seed = true", "expected a whole number"),
        ("name = 3", "expected a text"),
        ("base = 3", r"\[base\] must be a table"),
        ("[base]\nchanel = 2", "did you mean 'channel'"),
        ("[base]\nchannel = 6", "channel must be"),
        ("[base]\nchannel = 'two'", "expected a number"),
        ("[base]\ncir_samples = 12.5", "expected a whole number"),
        ("effects = 1", r"\[\[effects\]\] tables"),
        ("[[effects]]\nscale = 1", 'needs effect = "NAME"'),
        ("[[effects]]\neffect = 'power-bas'", "did you mean 'power-bias'"),
        ("[[effects]]\neffect = 'power-bias'\nscal = 1", "did you mean 'scale'"),
        ("[[effects]]\neffect = 'power-bias'\nscale = 9", "outside its physical bounds, 0 to 3"),
        ("[[effects]]\neffect = 'power-bias'\nscale = nan", "expected a number in ratio"),
        ("[[effects]]\neffect = 'power-bias'\nscale = '1 m'", "expected a number in ratio"),
        ("[[effects]]\neffect = 'ground-bounce'\nground = 'gold'", "unknown material 'gold'"),
        ("[[effects]]\neffect = 'ground-bounce'\nground = 3", "expected a material"),
    ],
)
def test_bad_toml_is_one_clear_line(text: str, message: str) -> None:
    with pytest.raises(BenchError, match=message) as caught:
        from_toml(text, "SIM.toml")
    assert str(caught.value).startswith("SIM.toml: ")
    assert "\n" not in str(caught.value)


def test_missing_and_binary_files(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="cannot read"):
        read_toml(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BenchError, match="cannot read"):
        read_toml(tmp_path / "bad.toml")
