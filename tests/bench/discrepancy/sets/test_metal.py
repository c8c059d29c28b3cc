"""What comes late behind metal alone came around it: nothing goes through."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.choose import chosen
from bench.physics.effects.propagation.diffraction import Diffraction, knife_edge
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.scene import scene

LINKS, ROWS = 40, 4
KINDS = ((), (), ("metal",), ("wood",))


def names_of(late: str) -> tuple[str, ...]:
    """Return the names given to ranges that are 8 cm late behind one kind of obstacle."""
    rng, link = np.random.default_rng(3), np.repeat(np.arange(LINKS), ROWS)
    behind = [KINDS[i % len(KINDS)] for i in link]
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "tx": [f"t{i % 5}" for i in link],
            "rx": [f"a{i % 7}" for i in link],
            "obstacles": [list(kinds) for kinds in behind],
            "true_range_m": rng.uniform(3, 20, LINKS)[link],
        }
    )
    links = link_codes(frame)

    def written(shift_m: np.ndarray) -> pd.DataFrame:
        error = shift_m + rng.normal(0, 0.02, len(frame))
        return frame.assign(error_m=error, range_m=frame["true_range_m"] + error)

    recorded = written(np.array([0.08 * (late in kinds) for kinds in behind]))
    simulated = pd.concat([written(np.zeros(len(frame))) for _ in range(3)])
    rows = view(recorded, links, np.arange(len(frame)), Window(), None, False)
    kinds, _ = offered(library()[0], recorded, False, False)
    comparison = TableComparison(simulated.reset_index(drop=True), Window())
    return chosen(Search(comparison, rows, rows, kinds, 0, work=rows), ()).names


@pytest.mark.parametrize(("late", "name"), [("metal", "diffraction"), ("wood", "material-delay")])
def test_a_delay_behind_metal_went_around_it(late: str, name: str) -> None:
    """The names of a delay behind metal and behind wood."""
    assert names_of(late) == (name,)


def test_what_goes_around_or_through() -> None:
    """Metal delays nothing that goes through it; what comes around it comes no sooner."""
    rows = scene(pd.DataFrame({"true_range_m": [5.0, 6.0], "obstacles": [["metal"], []]}))
    assert MaterialDelay.ways(rows) is None
    (steps,) = Diffraction.ways(rows) or ()
    assert steps[:, 0].tolist() == [0.1, 0.0]
    assert Diffraction.possible(rows, np.array([0.05, 0.0]))
    assert not Diffraction.possible(rows, np.array([-0.05, 0.0]))


def test_a_way_around_an_edge_is_the_longer_the_nearer_both_ends_are() -> None:
    """Knife edges so far off the straight line: their detours are a step and its share by 1 / d."""
    true_m = np.array([2.0, 4.0, 8.0, 16.0, 5.0])
    kinds = [["metal"]] * 4 + [[]]
    rows = scene(pd.DataFrame({"true_range_m": true_m, "obstacles": kinds}))
    (ways,) = Diffraction.ways(rows) or ()
    detour_m = knife_edge(true_m[:4], np.full(4, 0.2), np.full(4, 0.5), 6.5)[0]
    sizes = np.linalg.lstsq(ways[:4], detour_m, rcond=None)[0]
    assert ways[:4] @ sizes == pytest.approx(detour_m, rel=0.03)
    assert sizes[1] > 0
    assert not ways[4].any()
    far = scene(pd.DataFrame({"true_range_m": [0.01, 5.0, 6.0], "obstacles": [["metal"]] * 3}))
    assert np.abs((Diffraction.ways(far) or ())[0]).max() < 0.5
