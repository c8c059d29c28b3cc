"""What is said beside an AUC where there are too few links for one."""

from __future__ import annotations

from bench.discrepancy.compare.calibration import auc_doubt
from bench.discrepancy.settings import FEWEST_AUC_LINKS


def test_an_auc_of_so_few_links_that_none_could_tell_says_so() -> None:
    assert auc_doubt(3) == " (3 links: too few to tell, an AUC far from 0.5 is no finding)"
    assert auc_doubt(FEWEST_AUC_LINKS) == ""
    assert 0.5 ** (FEWEST_AUC_LINKS - 1) > 0.05 > 0.5**FEWEST_AUC_LINKS  # a sign test's least p
