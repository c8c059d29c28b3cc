"""Scores of blind cases against their bars, with 95 % Wilson intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import binomtest

from bench.challenge.planted import LARGER, SMALLER, WITHIN
from bench.challenge.scoring import RIGHT, Outcome

COVERAGE = (0.85, 0.95)
MEDIAN_SHARE = 0.9
MOST_CAUSES = 4
FAULTS = ("position", "swap", "unit", "time shift")


@dataclass(frozen=True)
class Rate:
    """A share with its count, the bar it is held to, and why it was missed.

    `least` and `most`: the bar (None: no bar on that side); `causes` says what the misses were.
    """

    words: str
    hits: int
    cases: int
    least: float | None = None
    most: float | None = None
    causes: str = ""

    @property
    def value(self) -> float:
        """The share, NaN where there was no case."""
        return self.hits / self.cases if self.cases else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % Wilson interval of the share, NaN where there was no case."""
        if not self.cases:
            return float("nan"), float("nan")
        found = binomtest(self.hits, self.cases).proportion_ci(method="wilson")
        return float(found.low), float(found.high)

    @property
    def bar(self) -> str:
        """The bar in words, empty where there is none."""
        low, high = (None if b is None else f"{100 * b:.3g}" for b in (self.least, self.most))
        if low and high:
            return f"{low} to {high} %"
        return f"at least {low} %" if low else f"at most {high} %" if high else ""

    @property
    def met(self) -> bool | None:
        """Whether the bar is met; None without a bar or a case."""
        if not self.cases or not self.bar:
            return None
        low = -1.0 if self.least is None else self.least
        high = 2.0 if self.most is None else self.most
        return low <= self.value <= high


def rates(outcomes: list[Outcome]) -> list[Rate]:
    """Return the scores of a mode against its bars."""
    empty = [o for o in outcomes if not o.hidden]
    rest = [o for o in outcomes if o.hidden]
    outside = [o for o in rest if set(o.hidden) == set(o.outside)]
    above = [o for o in rest if not o.outside and o.above_limit]
    other = [o for o in empty if not o.same_mix]
    return [
        _rate("false alarms, nothing hidden", empty, _is("alarm"), most=0.05),
        _rate("false alarms where the mix differs", other, _is("alarm")),
        _rate("a law stated where nothing is hidden", empty, _stated, most=0.05),
        _rate("a law stated, library cases", [o for o in rest if not o.outside], _stated),
        _rate("wrong names, something hidden", rest, _is("wrong"), most=0.05),
        _rate("right name or class, above the limit", above, _is(*RIGHT), least=0.9),
        _rate("right name alone, above the limit", above, _is("right"), least=0.8),
        _rate(
            "outside the library: not given a library name", outside, _not_named,
            least=0.95,
        ),
        _rate(
            "outside the library, above the limit: something is there",
            [o for o in outside if o.above_limit], _is("unknown", "wrong", *RIGHT),
        ),
        *_law_rates([o for o in outside if o.above_limit]),
        _covered(outcomes),
        _rate("sealed links fit better where something is named", _named(rest), _better, least=1.0),
        _rate("of these, the new simulator is recommended", _named(rest), _recommended),
        *_planted(empty),
        _rate("crashed", outcomes, _is("crash"), most=0.0),
        _rate("refused in one line", outcomes, _is("refused")),
    ]  # fmt: skip


Test = Callable[[Outcome], bool]


def _not_named(one: Outcome) -> bool:
    """Return whether nothing is named, or, in every class, what is hidden but cannot be tried."""
    return all(set(group) & set(one.hidden) for group in one.names)


def _is(*scores: str) -> Test:
    return lambda one: one.score in scores


def _named(outcomes: list[Outcome]) -> list[Outcome]:
    return [one for one in outcomes if one.names]


def _better(one: Outcome) -> bool:
    return one.better


def _recommended(one: Outcome) -> bool:
    return one.recommended


def _rate(
    words: str,
    among: list[Outcome],
    test: Test,
    least: float | None = None,
    most: float | None = None,
) -> Rate:
    """Return the share of outcomes that pass a test; causes are those that speak against it."""
    hits = [one for one in among if test(one)]
    against = hits if most is not None else [one for one in among if not test(one)]
    causes = causes_of(against) if least is not None or most is not None else ""
    return Rate(words, len(hits), len(among), least, most, causes)


def causes_of(outcomes: list[Outcome]) -> str:
    """Return the commonest pairs of what was hidden and what was said."""
    counted = Counter(map(cause, outcomes))
    return "; ".join(f"{count} x {words}" for words, count in counted.most_common(MOST_CAUSES))


def cause(one: Outcome) -> str:
    """Return what was hidden and what was said instead."""
    hidden = " + ".join(one.hidden) or ("nothing" if one.same_mix else "nothing, another mix")
    said = ", ".join(" or ".join(group) for group in one.names) or one.score
    return f"{hidden} -> {said}"


def _law_rates(outcomes: list[Outcome]) -> list[Rate]:
    """Return how often the form of a law, or the fault of the set-up, is stated."""
    laws = [o for o in outcomes if o.forms and not set(o.forms) & set(FAULTS)]
    faults = [o for o in outcomes if set(o.forms) & set(FAULTS)]
    valued = [o for o in outcomes if o.form_right and o.value_right is not None]
    return [
        _rate("laws above the limit: form stated", laws, _form_right, least=0.75),
        _rate("faults of the set-up above the limit: named", faults, _form_right, least=0.8),
        _rate("of these, size or devices within 10 %", valued, lambda o: bool(o.value_right)),
    ]


def _form_right(one: Outcome) -> bool:
    return bool(one.form_right)


def _stated(one: Outcome) -> bool:
    return bool(one.stated_law)


def _covered(outcomes: list[Outcome]) -> Rate:
    """Return how many 90 % intervals hold the true parameter."""
    every = [held for one in outcomes for held in one.covered]
    words = "90 % intervals that hold the true parameter"
    missed = [one for one in outcomes if one.covered and not all(one.covered)]
    return Rate(words, sum(every), len(every), *COVERAGE, causes_of(missed))


def _planted(outcomes: list[Outcome]) -> list[Rate]:
    """Return how often shifts planted around the stated detectable one are seen."""
    bars: tuple[tuple[str, float | None, float | None], ...] = (
        (LARGER, 0.5, None),
        (SMALLER, None, 0.5),
    )
    return [
        _rate(
            f"stated detectable shift x {word} seen (to be true within {WITHIN:g})",
            [one for one in outcomes if word in one.detected],
            lambda o, word=word: o.detected[word], low, high,  # type: ignore[misc]
        )
        for word, low, high in bars
    ]  # fmt: skip


def median_share(outcomes: list[Outcome]) -> float:
    """Return the median share of the removable mismatch that is removed, above the limit.

    Library cases; those that were missed or called unknown count with what they removed.
    """
    ours = [one for one in outcomes if one.hidden and not one.outside and one.above_limit]
    known = [one.fraction for one in ours if np.isfinite(one.fraction)]
    return float(np.median(known)) if known else float("nan")
