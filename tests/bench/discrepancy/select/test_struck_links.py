"""Which links are held to be struck is listed beside the name of what strikes them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.report.found_lines import describe
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.settings import STRUCK_LIST
from bench.discrepancy.select.struck_links import struck_words, with_struck_links
from bench.discrepancy.select.verdict import Ambiguous
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.time_lag import TimeLag
from tests.bench.discrepancy.select.test_sealed import named, selection

BLOCKED = BlockedPath()
CODES = np.repeat(np.arange(30), 2)
ROWS: Any = SimpleNamespace(
    links=CODES, frame=pd.DataFrame({"link": [f"a{code}" for code in CODES]})
)


def strike(*links: int) -> Strike:
    return Strike(BLOCKED, Estimate(20, 10, 30), (), np.array(links, np.intp))


def test_struck_links_stand_beside_their_name() -> None:
    found = selection()
    turn = replace(found.rounds[0], strike=strike(3, 7))
    either = Ambiguous((named(BLOCKED), named(TimeLag())), "")
    found = replace(found, rounds=(turn,), verdicts=(either, named(TimeLag())))
    search: Any = SimpleNamespace(both=ROWS)
    made = with_struck_links(search, found)
    words = "held to be struck, of 30 working links: a3, a7"
    assert made.verdicts[0].options[0].note == words  # type: ignore[union-attr]
    assert made.verdicts[1] == found.verdicts[1]
    assert f"  - {words}" in describe(made.verdicts[0])


def test_of_many_the_first_are_listed() -> None:
    words = struck_words(ROWS, strike(*range(STRUCK_LIST + 4)))
    assert words.endswith(f"a{STRUCK_LIST - 1} and 4 more")
