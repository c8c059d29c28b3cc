"""Plans that are turned, stretched or aslant are said as such, with their sizes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.judge import judged, setup_fault
from bench.discrepancy.law.material import material
from bench.discrepancy.law.plan import Plan, plans
from bench.discrepancy.law.search import propose
from bench.physics import Base, Simulator
from bench.recordings.table import Recordings

Places = Callable[[np.ndarray], np.ndarray]


def turned(places: np.ndarray) -> np.ndarray:
    """Return places [n, 2] turned by 2 degrees about the origin, from x toward y."""
    angle = np.deg2rad(2.0)
    return places @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def aslant(places: np.ndarray) -> np.ndarray:
    """Return places [n, 2] of which x is off by 3 % of y."""
    return places + 0.03 * np.stack([places[:, 1] - 8, 0 * places[:, 1]], axis=1)


def stretched(places: np.ndarray) -> np.ndarray:
    """Return places [n, 2] of which x is 1.2 % longer."""
    return places * np.array([1.012, 1.0])


def rows(seed: int, rx: Places, tx: Places) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows that stand where `rx` and `tx` take those of the plan, and links."""
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(90), 4)
    anchors = rng.uniform([0, 0], [24, 16], (8, 2))
    own = rng.integers(0, 8, 90)[links]
    tags = np.repeat(rng.uniform([1, 1], [23, 15], (90, 2)), 4, axis=0)
    height = rng.uniform(2, 4, 8)[own]
    frame = pd.DataFrame({"tx": "tag", "rx": [f"a{one}" for one in own]})
    frame[["tx_x_m", "tx_y_m"]], frame["tx_z_m"] = tags, 1.0
    frame[["rx_x_m", "rx_y_m"]], frame["rx_z_m"] = anchors[own], height
    plan = np.hypot(np.linalg.norm(tags - anchors[own], axis=1), height - 1)
    real = np.hypot(np.linalg.norm(tx(tags) - rx(anchors[own]), axis=1), height - 1)
    frame["true_range_m"] = plan
    frame["error_m"] = real - plan + rng.normal(0, 0.03, len(plan))
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    return frame, links


def same(places: np.ndarray) -> np.ndarray:
    """Return places as they are."""
    return places


@pytest.mark.parametrize(
    ("rx", "tx", "words", "size"),
    [
        (turned, same, "the plan of every rx is turned by", 2.0),
        (same, aslant, "the plan of every tx is aslant, x by", 3.0),
        (stretched, stretched, "the plan of both ends is stretched along x by", 1.2),
    ],
)
def test_what_a_plan_is_off_by_is_said(rx: Places, tx: Places, words: str, size: float) -> None:
    frame, links = rows(3, rx, tx)
    sealed = links >= 70
    given = material(frame[~sealed], frame["error_m"].to_numpy()[~sealed], links[~sealed])
    proposal = propose(given, 0)
    assert proposal is not None
    left = material(
        frame[sealed].reset_index(drop=True),
        frame["error_m"].to_numpy()[sealed], links[sealed], proposal.given,
    )  # fmt: skip
    law, fault = judged(proposal, left, 0), setup_fault(proposal)
    assert law is not None
    assert law.words.startswith(words), law.words
    assert str(law).startswith("a fault of the set-up: the plan of ")
    assert fault is not None
    assert fault.kind == "plan"
    first = fault.size[0]
    assert first.low <= size <= first.high
    assert first.value == pytest.approx(size, rel=0.05)


def test_the_law_of_a_plan_is_an_effect_of_the_simulator() -> None:
    frame, links = rows(4, turned, same)
    proposal = propose(material(frame, frame["error_m"].to_numpy(), links), 0)
    assert proposal is not None
    law = judged(proposal, proposal.given, 0)
    assert law is not None
    bare, off = (
        Simulator(Base(), effects).simulate(Recordings(frame, "test")).frame["range_m"].to_numpy()
        for effects in ((), (law.effect,))
    )
    says = proposal.best.structure.shift_m(proposal.given, proposal.best.fitted.constants)
    assert np.allclose(off - bare, says, atol=0.05)


def test_a_plan_whose_places_lie_on_a_line_is_not_asked_for() -> None:
    frame, links = rows(5, same, same)
    frame["rx_y_m"] = frame["tx_y_m"] = 3.0
    frame["true_range_m"] = np.sqrt(
        sum((frame[f"tx_{a}_m"] - frame[f"rx_{a}_m"]) ** 2 for a in "xyz")
    )
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    assert not list(plans(material(frame, frame["error_m"].to_numpy(), links)))


def test_noise_is_no_plan() -> None:
    frame, links = rows(6, same, same)
    assert propose(material(frame, frame["error_m"].to_numpy(), links), 0) is None


@pytest.mark.parametrize(
    ("by", "said"), [("-200 (-200..-186) %", True), ("1.2 (1.1..1.3) %", False)]
)
def test_an_axis_that_is_stretched_past_zero_is_mirrored(by: str, said: bool) -> None:
    plan = Plan(("tx",), ("sx",), (11.0, 8.1), "xyz", 1)
    words = plan.words({"sx": by, "cx": "11 m", "cy": "8.1 m", "dx": "2 m", "dy": "0 m"})
    assert ("mirrored (stretched along x by" in words) is said
