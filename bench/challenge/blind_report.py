"""The blind part of the challenge report: rates against their bars, and every case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.challenge.blind import seal
from bench.challenge.cases import LIMIT_Z, WAYS
from bench.challenge.generator.conceal import CONCEALS
from bench.challenge.generator.geometry import LINKS, ROWS
from bench.challenge.generator.shapes import LIBRARY
from bench.challenge.scoring import OUTSIDE, RIGHT, Outcome

ORACLE_SHARE = 0.8
COVERAGE = (0.85, 0.95)


@dataclass(frozen=True)
class Rate:
    """A share with its count and the bar it is held to (None: no bar)."""

    words: str
    hits: int
    cases: int
    bar: str = ""
    met: bool | None = None

    @property
    def value(self) -> float:
        """The share, NaN where there was no case."""
        return self.hits / self.cases if self.cases else float("nan")


def rates(outcomes: list[Outcome]) -> list[Rate]:
    """Return the scores of a challenge against its bars."""
    empty = [o for o in outcomes if not o.hidden.names]
    rest = [o for o in outcomes if o.hidden.names]
    outside = [o for o in rest if set(o.hidden.names) & set(OUTSIDE)]
    ours = [o for o in rest if o not in outside]
    above = [o for o in ours if o.above_limit]
    far = [o for o in outside if o.above_limit]
    return [
        _rate("false alarms on empty cases", empty, ("alarm",), "at most 5 %", 0.05, most=True),
        _rate("wrong names on all others", rest, ("wrong",), "at most 5 %", 0.05, most=True),
        _rate(
            "right name, or a class that holds it, above the detection limit",
            above,
            RIGHT,
            "at least 90 %",
            0.9,
        ),
        _rate("of these, the right name alone", above, ("right",)),
        _rate("one of two effects named", above, ("partly",)),
        _rate("something is there, above the limit", above, ("unknown",)),
        _rate("missed, above the limit", above, ("missed",)),
        _rate(
            "outside the library, above the limit: reported unknown",
            far,
            ("unknown",),
            "at least 90 %",
            0.9,
        ),
    ]


def _rate(
    words: str,
    among: list[Outcome],
    scores: tuple[str, ...],
    bar: str = "",
    value: float | None = None,
    most: bool = False,
) -> Rate:
    """Return the share of outcomes with one of these scores."""
    hits = sum(o.score in scores for o in among)
    met = None
    if value is not None and among:
        met = hits / len(among) <= value if most else hits / len(among) >= value
    return Rate(words, hits, len(among), bar, met)


def roc(outcomes: list[Outcome]) -> list[tuple[float, ...]]:
    """Return rows of (threshold, false alarms, detected, detected above the limit), as shares.

    The statistic is the search's largest z over its family-wise 5 % threshold.
    """
    none = np.array([o.alarm_z for o in outcomes if not o.hidden.names])
    some = np.array([o.alarm_z for o in outcomes if o.hidden.names])
    above = np.array([o.alarm_z for o in outcomes if o.above_limit])
    return [
        (t, *(float((z >= t).mean()) if len(z) else float("nan") for z in (none, some, above)))
        for t in (0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0)
    ]


def figures(outcomes: list[Outcome]) -> list[Rate]:
    """Return interval coverage, and how many cases remove at least 0.8 of the oracle's."""
    covered = [c for o in outcomes for c in o.covered]
    share = sum(covered) / len(covered) if covered else float("nan")
    named = [o for o in outcomes if o.above_limit and o.score in RIGHT]
    enough = [o for o in named if o.fraction >= ORACLE_SHARE]
    return [
        Rate(
            "90 % intervals that hold the true parameter",
            sum(covered),
            len(covered),
            "85 to 95 %",
            COVERAGE[0] <= share <= COVERAGE[1] if covered else None,
        ),
        Rate("rightly named cases that remove 0.8 of the oracle's", len(enough), len(named)),
    ]


def median_fraction(outcomes: list[Outcome]) -> float:
    """Return the median share of the oracle's removed mismatch, of library cases above the limit.

    Cases that were missed or called unknown count with what they removed.
    """
    ours = [o for o in outcomes if o.above_limit and not set(o.hidden.names) & set(OUTSIDE)]
    known = [o.fraction for o in ours if np.isfinite(o.fraction)]
    return float(np.median(known)) if known else float("nan")


def _figure_lines(outcomes: list[Outcome]) -> list[str]:
    """Return the figures that are no rates of cases, as rows of the table of scores."""
    middle = median_fraction(outcomes)
    errors = [e for o in outcomes for e in o.parameter_errors]
    met = "yes" if middle >= ORACLE_SHARE else "**no**"
    out = [
        "| held-out mismatch removed, median share of the true effect's, above the limit "
        f"| {middle:.2f} | at least {ORACLE_SHARE} | {met} |"
    ]
    if errors:
        out.append(f"| relative error of parameters, median | {np.median(errors):.2f} | | |")
    return out


def blind_markdown(every: list[Outcome], seed: int) -> list[str]:
    """Return the blind part of the report."""
    outcomes = [o for o in every if o.hidden.conceal != "waveform"]
    waves = [o for o in every if o.hidden.conceal == "waveform"]
    lines = [
        "## Blind cases",
        "",
        f"{len(outcomes)} cases (SIMULATED), seed {seed}, {LINKS} links x {ROWS} rows each; ranges "
        "only, no CIR. Answers sealed before the run: sha256 "
        f"`{seal(len(outcomes), seed, len(waves))}`.",
        f"The detection limit is a matched-filter signal-to-noise ratio of {LIMIT_Z:g} on the "
        "links the search sees: a test that knows the exact shape of the effect.",
        "",
        *_score_lines([*rates(outcomes), *figures(outcomes)]),
        *_figure_lines(outcomes),
    ]
    lines += [*_roc_lines(outcomes), *_group_lines(outcomes)]
    return [*lines, *_wave_lines(waves), *_case_lines([*outcomes, *waves])]


def _score_lines(found: list[Rate]) -> list[str]:
    """Return rates as a Markdown table with their bars."""
    lines = ["| score | value | bar | met |", "| --- | --- | --- | --- |"]
    for rate in found:
        met = {True: "yes", False: "**no**", None: ""}[rate.met]
        share = f"{rate.hits}/{rate.cases}" + (f" = {rate.value:.0%}" if rate.cases else "")
        lines.append(f"| {rate.words} | {share} | {rate.bar} | {met} |")
    return lines


def _wave_lines(waves: list[Outcome]) -> list[str]:
    """Return the scores of effects hidden in the waveform, apart from those in the range."""
    if not waves:
        return []
    words = (
        f"{len(waves)} more cases (SIMULATED) hide an effect in the complex impulse responses; "
        "range and powers move only as far as the changed samples say. The simulator is run again "
        "at each row. Strengths are ratios."
    )
    return ["", "### Effects of the waveform", "", words, "", *_score_lines(rates(waves))]


def _group_lines(outcomes: list[Outcome]) -> list[str]:
    """Return the right names by way, concealment, effect and strength, as a Markdown table."""
    lines = ["", "| library cases | right or in the class | wrong |", "| --- | --- | --- |"]
    ours = [o for o in outcomes if o.hidden.names and not set(o.hidden.names) & set(OUTSIDE)]
    above = [o for o in ours if o.above_limit]
    groups = [(f"{way}, above", [o for o in above if o.way == way]) for way in sorted(set(WAYS))]
    groups += [(f"{c}, above", [o for o in above if o.hidden.conceal == c]) for c in CONCEALS]
    groups += [(f"{n}, above", [o for o in above if n in o.hidden.names]) for n in LIBRARY]
    for low, high in ((0, 4), (4, 8), (8, 16), (16, 32), (32, np.inf)):
        some = [o for o in ours if low <= o.strength_z < high]
        groups.append((f"strength z {low:g} to {high:g}", some))
    for words, among in groups:
        right = sum(o.score in RIGHT for o in among)
        wrong = sum(o.score == "wrong" for o in among)
        lines.append(f"| {words} | {right}/{len(among)} | {wrong} |")
    return lines


def _roc_lines(outcomes: list[Outcome]) -> list[str]:
    """Return the detection ROC as a Markdown table."""
    lines = ["", "| statistic over threshold | false alarms | detected | above the limit |"]
    lines.append("| --- | --- | --- | --- |")
    return lines + [f"| {t:g} | {a:.0%} | {b:.0%} | {c:.0%} |" for t, a, b, c in roc(outcomes)]


def _case_lines(outcomes: list[Outcome]) -> list[str]:
    """Return every case as a Markdown table."""
    lines = [
        "",
        "| case | way | hidden | mm or 1/1000 | z | concealed | said | score |",
    ]
    lines.append("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for one in outcomes:
        said = "; ".join(" or ".join(group) for group in one.names) or one.verdict[:60]
        sizes = ", ".join(f"{1000 * s:.0f}" for s in one.hidden.strengths_m)
        lines.append(
            f"| {one.number} | {one.way} | {', '.join(one.hidden.names) or 'nothing'} | {sizes} "
            f"| {one.strength_z:.0f} | {one.hidden.conceal} | {said} | {one.score} |"
        )
    return lines
