"""The example of docs/diagnose.md, a simulator of one's own as a chain, runs as it stands there."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.sound import tried
from bench.physics import Base, read_toml
from bench.plugins import Plugin, plugins

PAGE = (Path(__file__).parents[3] / "docs" / "diagnose.md").read_text(encoding="utf-8")
SECTION = PAGE.partition("## A simulator of your own")[2].partition("\n## ")[0]


def block(kind: str) -> str:
    """Return the one block of code of a kind in the section."""
    (found,) = re.findall(rf"```{kind}\n(.*?)```", SECTION, re.DOTALL)
    return str(found)


def test_the_wrapped_function_gives_its_own_ranges(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    module = ModuleType("my_ranges_of_the_page")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    exec(compile(block("python"), "docs/diagnose.md", "exec"), module.__dict__)
    mine = Plugin("effects", "my-ranges", f"{module.__name__}:MyRanges", "mine")
    monkeypatch.setattr("bench.plugins.plugins", lambda group: [mine, *plugins(group)])
    path = tmp_path / "SIM.toml"
    path.write_text(block("toml"))
    simulator = read_toml(path)
    frame = pd.DataFrame({"true_range_m": np.linspace(2, 20, 400), "temperature_c": 35.0})
    made = simulator.simulate(frame.assign(link="a")).frame
    error_m = made["range_m"] - frame["true_range_m"]
    assert error_m.mean() == pytest.approx(0.07, abs=0.004)
    assert error_m.std() == pytest.approx(0.02, abs=0.003)
    assert tried(simulator, Base(), frame, False) == ()  # the same again
