"""On which rows an effect was fitted, from which its intervals are then taken."""

from types import SimpleNamespace

from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.receiver.noise_floor import NoiseFloor


def test_what_a_set_of_causes_knows_is_of_all_rows_that_were_weighed() -> None:
    given = SimpleNamespace(both="all", sharpest="some", choice=Choice(names=(PowerBias.name,)))
    assert Search.fitted_on(given, PowerBias()) == "all"  # type: ignore[arg-type]
    assert Search.fitted_on(given, NoiseFloor()) == "some"  # type: ignore[arg-type]
