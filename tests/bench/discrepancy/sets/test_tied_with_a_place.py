"""A delay that a device which stands elsewhere does as well as is said beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.law.found import FoundLaw, LawConstant, Rival
from bench.discrepancy.law.judge import tied_names

CORNERS_M = np.array([[0.3, 0.3, 2.4], [11.7, 0.4, 2.4], [11.6, 6.6, 2.4], [0.4, 6.5, 2.4]])


def office(seed: int, late_m: float, each: int) -> pd.DataFrame:
    """Return ranges of a tag at 14 places to four corners, one of which is late; SIMULATED."""
    places = np.random.default_rng(5).uniform([1, 1, 1.0], [11, 6, 1.4], (14, 3))
    rng = np.random.default_rng(seed)
    place, corner = (one.ravel() for one in np.meshgrid(np.arange(14), np.arange(4)))
    place, corner = np.repeat(place, each), np.repeat(corner, each)
    true_m = np.linalg.norm(places[place] - CORNERS_M[corner], axis=1)
    noise_m = rng.normal(0, 0.025, len(true_m))
    ends = {"tx": CORNERS_M[corner], "rx": places[place]}
    at = {f"{end}_{axis}_m": ends[end][:, i] for end in ends for i, axis in enumerate("xyz")}
    return pd.DataFrame(
        {"link": [f"A{c}-P{p}" for c, p in zip(corner, place, strict=True)],
         "tx": [f"A{c}" for c in corner], "rx": "tag", "true_range_m": true_m,
         "range_m": true_m + late_m * (corner == 2) + noise_m, **at}
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore")
def test_a_late_corner_is_never_said_to_stand_elsewhere_without_the_delay() -> None:
    found = bench.diagnose(office(1, 0.12, 6), office(2, 0.0, 18))
    said = f"{found.headline} {found.selection.names}"
    assert "antenna-delay" in said
    if found.setup_fault:
        assert found.selection.tied == ("antenna-delay",)
        said = found.headline.partition("; or antenna-delay of A2 instead (error = 0.1")[2]
        assert "m): these recordings cannot tell" in said


def test_only_a_place_has_a_name_beside_it() -> None:
    law = FoundLaw("position", (), "A2", "", "", "0", (), 9.0, None, None, fault="position")  # type: ignore[arg-type]
    (rival,) = tied_names(law, ("antenna-delay",))
    assert (rival.words, rival.behind) == ("antenna-delay of A2 instead", 0.0)
    same = Rival("error = 0.12 m, where rx is A2", "constant", (), -0.1)
    (rival,) = tied_names(replace(law, rivals=(same,)), ("antenna-delay",))
    assert rival.words == "antenna-delay of A2 instead (error = 0.12 m)"
    assert tied_names(law, ()) == ()
    assert tied_names(FoundLaw(**{**vars(law), "fault": "unit"}), ("antenna-delay",)) == ()


def test_a_name_that_does_as_well_is_said_before_laws_that_do() -> None:
    sine = Rival("a sine", "periodic", ("time_s",), -0.8)
    law = FoundLaw("position", (), "A2", "", "", "0", (), 9.0, None, None, (sine,), "position")  # type: ignore[arg-type]
    assert law.nearest == "; not excluded: a sine"
    both = replace(law, rivals=(sine, *tied_names(law, ("antenna-delay",))))
    assert both.nearest == "; or antenna-delay of A2 instead: these recordings cannot tell"


def test_a_device_that_may_be_where_it_should_may_be_late_instead() -> None:
    law = FoundLaw("position", (), "A2", "", "", "0", (), 9.0, None, None, fault="position")  # type: ignore[arg-type]
    unsure = [LawConstant(f"d{axis}", 0.2, -0.6, 1.1, "m") for axis in "xyz"]
    (rival,) = tied_names(replace(law, constants=tuple(unsure)), ())
    assert rival.words == "antenna-delay of A2 instead"
    sure = (LawConstant("dx", 0.4, 0.3, 0.5, "m"), *unsure[1:])
    assert tied_names(replace(law, constants=sure), ()) == ()
