"""Lines that say what a user said as such, and nothing where nothing could be removed."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.headline import _change
from bench.discrepancy.locate.hypotheses import Place
from bench.discrepancy.report.document import measured_lines
from bench.discrepancy.report.found_lines import describe, left_lines
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown
from bench.physics.effects.propagation.diffraction import Diffraction


def test_what_the_user_said_is_measured_is_not_put_down_to_the_rule() -> None:
    options = SimpleNamespace(measured=("supply_v",), known=())
    diagnosis = SimpleNamespace(
        links=(9, 9), measured=("supply_v", "lqi"), options=options
    )  # fmt: skip
    said, guessed = measured_lines(diagnosis)  # type: ignore[arg-type]
    assert said == "Measured, so not searched over: supply_v (you said so)."
    assert guessed.startswith("Measured, so not searched over: lqi (a column of your own")


@pytest.mark.parametrize(
    ("gain", "words"),
    [
        (Estimate(-0.7, -1.0, 0.1, "nats"), "removes nothing of held-out score"),
        (Estimate(0.7, 0.4, 1.1, "nats"), "removes 0.7 nats [0.4, 1.1] of held-out score"),
    ],
)
def test_a_regression_that_loses_removes_nothing(gain: Estimate, words: str) -> None:
    assert any(words in line for line in describe(Unknown((), gain, {}, "why")))


def test_what_could_not_be_tried_has_neither_values_nor_evidence() -> None:
    gain = Estimate(840.0, 445.0, 1290.0, "nats")
    note = "it could not be tried: it needs obstacles"
    said = " ".join(describe(LeftOut(Diffraction(), (), gain, 1.0, Control("", None), note=note)))
    assert note in said
    assert "840" not in said
    assert "strength_db" not in said


@pytest.mark.parametrize(
    ("mean_m", "median_m", "words"),
    [
        ((0.0363, 0.03631), (0.03, 0.02), "0.0363 m before and after on sealed links"),
        ((0.162, 0.161), (0.0301, 0.0339), "0.162 -> 0.161 m, in the median 0.0301 -> 0.0339 m"),
        ((0.162, 0.161), (0.03, 0.02), "0.162 -> 0.161 m on sealed links"),
    ],
)
def test_a_change_says_what_stays_and_what_gets_worse(
    mean_m: tuple[float, float], median_m: tuple[float, float], words: str
) -> None:
    values = {"mae": mean_m, "median": median_m}
    seen = {
        f"{name}_{when}_m": Estimate(value, value, value, "m")
        for name, pair in values.items()
        for when, value in zip(("before", "after"), pair, strict=True)
    }
    assert words in _change(SimpleNamespace(**seen, serves=True))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, True),
        ({"waveform": True}, False),  # of some levels: some always differ
        ({"waveform": True, "place": Place()}, True),  # of all
        ({"waveform": True, "observable": "error_m"}, True),
        ({"struck": True}, False),
        ({"names": ()}, False),
        ({"p": 0.04}, False),
        ({"verdicts": (Unknown((), Estimate(0, 0, 0, "nats"), {}, "why"),)}, False),
    ],
)
def test_what_still_differs_beside_a_name_is_said(change: dict[str, object], said: bool) -> None:
    level = "rx_power_dbm where maker=NXP: recorded - simulated = -2.8 dB"
    usual = {"names": (("antenna-delay",),), "verdicts": (), "waveform": False, "p": 0.002}
    where = {"observable": "rx_power_dbm", "place": Place("maker=NXP")}
    found = usual | where | {"struck": False} | change
    cell = SimpleNamespace(observable=found["observable"], place=found["place"])
    finding = SimpleNamespace(p=found["p"], told=level, cell=cell)
    located, strike = SimpleNamespace(findings=(finding,)), object() if found["struck"] else None
    turn = SimpleNamespace(added=None, strike=strike, located=located)
    selection = SimpleNamespace(rounds=[turn], verdicts=found["verdicts"], names=found["names"])
    selection.left_note, selection.mean = "3 of 52 links are struck as by blocked-path", ()
    options = SimpleNamespace(waveform=found["waveform"])
    diagnosis = SimpleNamespace(selection=selection, law=None, options=options)
    lines = left_lines(diagnosis)  # type: ignore[arg-type]
    assert lines == (
        ["**Beside that still differs, without a name:**", f"- {level}", f"- {selection.left_note}"]
        if said
        else []
    )
    selection.mean = (finding,)  # theirs: a lobe's mean was read as a second fault
    again = left_lines(diagnosis)  # type: ignore[arg-type]
    assert again[1:] == lines[1:]
    assert ("theirs" in "".join(again[:1])) is said


class Told:
    """A finding that is told as it is: an observable, and its name for words."""

    def __init__(self, observable: str) -> None:
        place = SimpleNamespace(trend=False)
        self.cell = SimpleNamespace(observable=observable, moment="mean", place=place)
        self.effect, self.p = SimpleNamespace(low=0.0, high=1.0), 0.002

    @property
    def told(self) -> Told:
        return self

    def __str__(self) -> str:
        return f"{self.cell.observable}: more"


def test_what_differs_in_ranges_is_said_before_levels() -> None:
    findings = tuple(map(Told, ("rx_power_dbm", "noise_std", "snr_db", "error_m")))
    turn = SimpleNamespace(added=None, strike=None, located=SimpleNamespace(findings=findings))
    named = {"verdicts": (), "names": (("a",),), "left_note": "", "mean": ()}
    selection = SimpleNamespace(rounds=[turn], **named)
    seen = {"law": None, "options": SimpleNamespace(waveform=False)}
    diagnosis = SimpleNamespace(selection=selection, **seen)
    lines = left_lines(diagnosis)  # type: ignore[arg-type]
    assert lines[1:] == ["- error_m: more", "- rx_power_dbm: more", "- noise_std: more"]
