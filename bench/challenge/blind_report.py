"""The blind part of the challenge report: missed bars first, then every mode, then every case."""

from __future__ import annotations

import numpy as np

from bench.challenge.blind import SEALED, seal
from bench.challenge.cases import LIMIT_Z
from bench.challenge.families.case import CONCEALS, KEPT, LADDER, MODES, RATIOS
from bench.challenge.rates import MEDIAN_SHARE, Rate, causes_of, median_share, rates
from bench.challenge.scoring import RIGHT, Outcome


def blind_markdown(outcomes: list[Outcome], seed: int, families: tuple[str, ...] = ()) -> list[str]:
    """Return the blind part of the report."""
    modes = [(mode, [o for o in outcomes if o.mode == mode]) for mode in MODES]
    modes = [(mode, some) for mode, some in modes if some]
    lines = [*_intro(outcomes, seed, families), *_missed_lines(modes)]
    for mode, some in modes:
        lines += ["", f"### {mode}: {len(some)} cases", "", *_mode_lines(some)]
    return [*lines, *_group_lines(outcomes), *_case_lines(outcomes)]


def _intro(outcomes: list[Outcome], seed: int, families: tuple[str, ...]) -> list[str]:
    """Return what was run, and how it is counted."""
    ratios = "/".join(map(str, RATIOS))
    kept = " and ".join(KEPT)
    used = sorted({one.family for one in outcomes})
    opened = f"Families {', '.join(used)}"
    if set(KEPT) & set(used):
        opened += f"; written last: {kept}"
    return [
        "## Blind cases",
        "",
        f"The first {len(outcomes)} of {max(len(outcomes), SEALED)} sealed cases (SIMULATED), "
        f"seed {seed}, `bench.diagnose` with default options. "
        f"{opened}. Simulated rows per recorded row {ratios}; paired, unpaired and run again; "
        f"mixes equal and different; strengths x {', '.join(f'{s:g}' for s in LADDER)}; a third of "
        "the tables without the count of symbols. Answers "
        f"sealed before the run: sha256 `{seal(len(outcomes), seed, families)}`.",
        "",
        f"The detection limit is a signal-to-noise ratio of {LIMIT_Z:g} on the links that are "
        "searched: of a test that knows the exact shape of the effect (ranges); of scatter, "
        "whose draws no test knows, of its variance (until seed 903127: of its draws); of the "
        "most moved observable's mean (waveforms, levels); of several causes, of the weakest "
        "beside the others, to which scatter and rounding are noise (until seed 750991 they were "
        "known in ranges). Intervals of shares: 95 %, Wilson. "
        f"Mean CPU time of a diagnosis: {_seconds(outcomes):.1f} s.",
        "",
    ]


def _seconds(outcomes: list[Outcome]) -> float:
    """Return the mean CPU time of a diagnosis in s."""
    return float(np.mean([one.seconds for one in outcomes if one.seconds] or [0.0]))


def _missed_lines(modes: list[tuple[str, list[Outcome]]]) -> list[str]:
    """Return every bar that was missed, with what the misses were, before anything else."""
    out = ["### Bars that were missed", "", "| mode | score | value | bar | commonest causes |"]
    out.append("| --- | --- | --- | --- | --- |")
    for mode, some in modes:
        out += [
            f"| {mode} | {r.words} | {_share(r)} | {r.bar} | {r.causes} |"
            for r in rates(some)
            if r.met is False
        ]
        share = median_share(some)
        if share < MEDIAN_SHARE:
            low = [o for o in some if o.fraction < MEDIAN_SHARE and o.above_limit and not o.outside]
            out.append(
                f"| {mode} | removable mismatch removed, median | {share:.2f} "
                f"| at least {MEDIAN_SHARE} | {causes_of(low)} |"
            )
    return out if len(out) > 4 else [*out[:2], "None."]


def _share(rate: Rate) -> str:
    """Return a share with its count and interval."""
    if not rate.cases:
        return "no case"
    low, high = rate.interval
    return f"{rate.hits}/{rate.cases} = {rate.value:.0%} ({low:.0%} to {high:.0%})"


def _mode_lines(outcomes: list[Outcome]) -> list[str]:
    """Return the scores of a mode as a Markdown table with their bars."""
    lines = ["| score | value | bar | met |", "| --- | --- | --- | --- |"]
    for rate in rates(outcomes):
        met = {True: "yes", False: "**no**", None: ""}[rate.met]
        lines.append(f"| {rate.words} | {_share(rate)} | {rate.bar} | {met} |")
    share = median_share(outcomes)
    met = "yes" if share >= MEDIAN_SHARE else "**no**"
    lines.append(
        "| removable mismatch removed on sealed links, median above the limit "
        f"| {share:.2f} | at least {MEDIAN_SHARE} | {met} |"
    )
    errors = [e for one in outcomes for e in one.parameter_errors]
    if errors:
        lines.append(f"| relative error of parameters, median | {np.median(errors):.2f} | | |")
    return lines


def _group_lines(outcomes: list[Outcome]) -> list[str]:
    """Return the right names by family, relation, concealment and effect, as a Markdown table."""
    lines = ["", "| library cases above the limit | right or in the class | wrong |"]
    lines.append("| --- | --- | --- |")
    above = [o for o in outcomes if o.hidden and not o.outside and o.above_limit]
    groups = [(f, [o for o in above if o.family == f]) for f in sorted({o.family for o in above})]
    tables = [o for o in above if not o.mode.endswith("again")]
    groups += [(f"tables, {r} simulated rows", [o for o in tables if o.ratio == r]) for r in RATIOS]
    for paired, word in ((True, "paired"), (False, "unpaired")):
        groups.append((f"tables, {word}", [o for o in tables if o.paired == paired]))
    groups += [(c, [o for o in above if o.concealed == c]) for c in CONCEALS]
    groups += [(f"strength x {s:g}", [o for o in above if o.strength == s]) for s in LADDER]
    groups += [(f"{n} hidden", [o for o in above if len(o.hidden) == n]) for n in (1, 2, 3)]
    names = sorted({name for one in above for name in one.hidden})
    groups += [(name, [o for o in above if name in o.hidden]) for name in names]
    for words, among in groups:
        right = sum(o.score in RIGHT for o in among)
        lines.append(
            f"| {words} | {right}/{len(among)} | {sum(o.score == 'wrong' for o in among)} |"
        )
    return lines


def _case_lines(outcomes: list[Outcome]) -> list[str]:
    """Return every case as a Markdown table."""
    lines = [
        "",
        "| case | mode, family | tables | hidden | x | z | said | share removed | score |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for one in outcomes:
        said = "; ".join(" or ".join(group) for group in one.names) or one.verdict[:60]
        hidden = " + ".join(one.hidden) or "nothing"
        share = f"{one.fraction:.2f}" if np.isfinite(one.fraction) else ""
        lines.append(
            f"| {one.number} | {one.mode}, {one.family} | {_relation(one)} | {hidden} "
            f"| {one.strength:g} | {one.strength_z:.0f} | {said} | {share} | {one.score} |"
        )
    return lines


def _relation(one: Outcome) -> str:
    """Return how the two sides relate, in few words."""
    words = [] if one.mode.endswith("again") else [f"1:{one.ratio}"]
    if not one.mode.endswith("again"):
        words.append("paired" if one.paired else "unpaired")
    words += [] if one.same_mix else ["another mix"]
    words += [] if one.listed else ["no obstacles"]
    words += [] if one.counted else ["no counts"]
    return ", ".join([*words, *([] if one.concealed == "plain" else [one.concealed])])
