"""Every set is weighed at its own ratio of link offsets: that of others is no evidence."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.sets.evidence import Evidence

LINKS, ROWS = 29, 27


@pytest.mark.parametrize("ratio", [0.15, 0.6, 2.0])
def test_offsets_between_two_ratios_are_no_evidence_for_a_cause(ratio: float) -> None:
    rng, links = np.random.default_rng(3), np.repeat(np.arange(LINKS), ROWS)
    offsets = np.sqrt(ratio) * rng.standard_normal(LINKS)
    left = 0.04 * (rng.standard_normal(len(links)) + offsets[links])
    pattern = 0.1 * rng.standard_normal((LINKS, 8))[links]
    made = Evidence(left, links, {"antenna-pattern": (pattern,)})
    for causes in ((), ("antenna-pattern",)):
        best = max(made.at([causes], one)[0].nats for one in np.geomspace(0.05, 6.4, 40))
        assert made.of(causes).nats > best - 0.3
