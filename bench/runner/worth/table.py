"""The table: what is left of the error, for each way and number of surveyed links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.runner.worth.remains import Remains
from bench.runner.worth.scores import Scored

WAYS = {
    "none": "no correction",
    "real": "(a) surveyed links alone",
    "before": "(b) original simulator",
    "after": "(c) diagnosed simulator",
    "after+tuned": "(d) diagnosed simulator, network trained further on the links",
    "after+offset": "(d') diagnosed simulator, plus the links' mean offset",
    "before+tuned": "original simulator, network trained further on the links",
    "before+offset": "original simulator, plus the links' mean offset",
    "constant": "(e) the links' median error",
    "boosting": "(f) gradient boosting on the links' registers",
}
"""The ways that are compared, in words."""
ALL = 0
"""Stands for all the links there are to survey, which differ from split to split."""


@dataclass(frozen=True)
class Split:
    """The scores of one split: one diagnosis and its sealed links."""

    seed: int
    every: int
    scores: tuple[Scored, ...]


@dataclass(frozen=True)
class Worth:
    """What is left of |error| on sealed RECORDED links, in metres.

    `left` maps (way, links) to the mean over links with a 95 % interval over links, `links` 0
    meaning all; `paired` maps (way, links) to how much less it leaves than surveyed links alone
    (positive is better). `done` of `planned` tasks are in. `remains`: what still tells the
    diagnosed simulator from the recordings.
    """

    left: dict[tuple[str, int], Estimate]
    paired: dict[tuple[str, int], Estimate]
    links: tuple[int, ...]
    splits: int
    sealed_links: int
    done: int
    planned: int
    remains: tuple[Remains, ...] = ()

    def summary(self) -> dict[str, Any]:
        """Return the table as plain data."""
        return {
            "splits": self.splits,
            "sealed_links": self.sealed_links,
            "done": self.done,
            "planned": self.planned,
            "left_m": [_plain(key, one) for key, one in self.left.items()],
            "remaining_mismatch": [vars(one) for one in self.remains],
            "less_than_surveyed_links_alone_m": [_plain(k, one) for k, one in self.paired.items()],
        }


def _plain(key: tuple[str, int], one: Estimate) -> dict[str, Any]:
    return {"way": key[0], "links": key[1] or "all", **vars(one)}


def table(splits: Sequence[Split], links: tuple[int, ...], planned: int) -> Worth:
    """Return the table over all splits; intervals resample links."""
    found: dict[tuple[str, int], dict[tuple[int, str], list[float]]] = {}
    for split in splits:
        for one in split.scores:
            few = ALL if one.links == split.every else one.links
            targets = (*links, ALL) if not one.links else (few,)
            for count in targets:
                cell = found.setdefault((one.way, count), {})
                for link, left in one.left_m.items():
                    cell.setdefault((split.seed, link), []).append(left)
    means = {key: {k: float(np.mean(v)) for k, v in cell.items()} for key, cell in found.items()}
    order = [(way, count) for way in WAYS for count in (*links, ALL) if (way, count) in means]
    done = sum(len({(s.links, s.draw) for s in split.scores}) for split in splits)
    sealed = {link for split in splits for one in split.scores for link in one.left_m}
    return Worth(
        {key: _over_links(means[key]) for key in order},
        {key: _over_links(_less(means, key)) for key in order if key[0] not in ("real", "none")},
        links,
        len(splits),
        len(sealed),
        done,
        planned,
    )


def _less(
    means: dict[tuple[str, int], dict[tuple[int, str], float]], key: tuple[str, int]
) -> dict[tuple[int, str], float]:
    """Return by how much a way leaves less than surveyed links alone, link by link."""
    alone = means.get(("real", key[1]), {})
    return {k: alone[k] - left for k, left in means[key].items() if k in alone}


def _over_links(values: dict[tuple[int, str], float]) -> Estimate:
    """Return the mean over links with its interval; a link in several splits is one."""
    names = np.array([link for _, link in values])
    codes = np.unique(names, return_inverse=True)[1].astype(np.intp) if len(names) else names
    return cluster_bootstrap(np.array(list(values.values())), codes.astype(np.intp), 0, "m")
