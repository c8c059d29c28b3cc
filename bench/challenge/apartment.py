"""The furnished apartment with its labels hidden, against a simulator without walls or tail.

Of the recordings the diagnosis sees positions, ranges, accumulators and levels; whether sight was
free is hidden and used only to check. The simulator is the base alone, with the channel and the
pulse repetition of the recordings, and accumulates the whole preamble.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.mitigation import Effort, Mitigated, mitigated
from bench.challenge.obstruction import link_log_odds
from bench.challenge.real.case import Check, Progress, RealCase, markdown_table
from bench.discrepancy import Diagnosis, Options, diagnose
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window, window_of
from bench.discrepancy.data.split import link_codes, split_links, thinned
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

SEEN = (
    "link", "tx", "rx", "range_m", "true_range_m", "cir", "first_path_index", "preamble_count",
    "rx_power_dbm", "first_path_power_dbm", "noise_std", "sample_period_ns", "time_s",
    "tx_x_m", "tx_y_m", "rx_x_m", "rx_y_m",
)  # fmt: skip
ORIGINAL = Simulator(Base(channel=2, prf_mhz=64, keep_count=0), name="base")
OBSTRUCTED = {"obstructed-path", "blocked-path", "material-delay", "diffraction"}
ROWS_PER_LINK = 8  # of which the obstruction score is the mean
GOOD_AUC = 0.8


@dataclass(frozen=True)
class Separation:
    """How well the score of obstruction tells the hidden labels apart.

    `auc` over links with a 95 % bootstrap interval; `links` has link, log_odds and label.
    """

    auc: Estimate
    links: pd.DataFrame


def apartment(
    table: Recordings,
    seed: int,
    progress: Progress,
    options: Options | None = None,
    effort: Effort | None = None,
) -> RealCase:
    """Diagnose the apartment; check it against the labels, and REMnet against the held-out links.

    Rows of one link are near copies of each other, so the search and the fit use some 40 of each
    link's; `options` and `effort` other than the default make a quicker run still.
    """
    asked = options or Options(seed, search_rows=400, fit_rows=250, confirm_rows=1000)
    shown = table.frame[[name for name in SEEN if name in table.frame]]
    shown = shown.assign(error_m=shown["range_m"] - shown["true_range_m"]).reset_index(drop=True)
    recorded = Recordings(shown, "apartment, labels hidden", table.licence)
    found = diagnose(recorded, ORIGINAL, asked, progress)
    progress("which links are obstructed")
    told = separation(found, shown, table.frame["los"].to_numpy(bool), seed)
    assert found.simulator is not None
    split = split_links(shown, asked.seed)
    parts = split.work, split.confirm.open()
    simulators = ORIGINAL, found.simulator
    trained = mitigated(recorded, *parts, simulators, seed, effort or Effort(), progress)
    checks = (*_named_checks(found), *_which_links(told), _order_check(found))
    lines = (*ladder_lines(found, window_of(shown)), *_link_lines(told), *mitigation_lines(trained))
    return RealCase("apartment, labels hidden", found, (*checks, *_trained_checks(trained)), lines)


def separation(
    found: Diagnosis, shown: pd.DataFrame, sight: NDArray[np.bool_], seed: int
) -> Separation | None:
    """Return the score of every link beside its hidden label, None where nothing obstructs."""
    codes, window = link_codes(shown), window_of(shown)
    every = np.arange(len(shown))
    few = thinned(every, codes, ROWS_PER_LINK * (int(codes.max()) + 1))
    comparison = Resimulation(ORIGINAL, window)
    odds = link_log_odds(comparison, view(shown, codes, few, window), found.added)
    if odds is None:
        return None
    label = pd.Series(sight).groupby(shown["link"].to_numpy()).first()
    links = pd.DataFrame({"link": odds.index, "log_odds": odds.to_numpy()})
    links["label"] = np.where(label.loc[odds.index], "line of sight", "obstructed")
    return Separation(auc_interval(links, seed), links.sort_values("log_odds"))


def auc_interval(links: pd.DataFrame, seed: int, draws: int = 1000) -> Estimate:
    """Return the AUC of `log_odds` for the label (Mann-Whitney), with links resampled."""
    score = links["log_odds"].to_numpy(np.float64)
    struck = (links["label"] == "obstructed").to_numpy()
    higher = np.sign(score[struck, None] - score[None, ~struck]) / 2 + 0.5
    count = len(score)
    drawn = np.random.default_rng(seed).multinomial(count, np.full(count, 1 / count), size=draws)
    left, right = drawn[:, struck], drawn[:, ~struck]
    pairs = left.sum(axis=1) * right.sum(axis=1)
    wins = np.einsum("dl,lr,dr->d", left, higher, right)
    low, high = np.percentile(wins[pairs > 0] / pairs[pairs > 0], [2.5, 97.5])
    return Estimate(float(higher.mean()), float(low), float(high))


def _named_checks(found: Diagnosis) -> tuple[Check, ...]:
    """Return whether each of the four is named, alone or in an honest class."""
    said = "; ".join(" or ".join(names) for names in found.selection.names) or "nothing"
    every = {name for names in found.selection.names for name in names}
    asked = {
        "finds the constant delay": {"antenna-delay"},
        "finds the obstructed direct path": OBSTRUCTED,
        "finds the diffuse tail": {"diffuse-tail"},
        "finds the receiver's level control": {"level-control"},
    }
    return tuple(Check(words, said, bool(names & every)) for words, names in asked.items())


def _which_links(told: Separation | None) -> tuple[Check, ...]:
    """Return whether the score of obstruction agrees with the hidden labels."""
    asked = f"says which links are obstructed: AUC at least {GOOD_AUC:g} against hidden labels"
    if told is None:
        return (Check(asked, "no obstruction was found, so no link has a score", False),)
    struck = int((told.links["label"] == "obstructed").sum())
    words = f"AUC {told.auc} ({struck} of {len(told.links)} links obstructed by label)"
    return (Check(asked, words, told.auc.value >= GOOD_AUC),)


def ladder(found: Diagnosis, window: Window) -> pd.DataFrame:
    """Return one row per effect added: its gain, the runner-up's, and what leaving it out costs.

    `gain` is over the simulator of the round before on held-out discover links; `missed` is over
    the final simulator without it, on the confirm links (nats).
    """
    rows = []
    for number, turn in enumerate(found.selection.rounds, 1):
        if turn.added is None or turn.explanation is None:
            continue
        first, *others = turn.explanation.contenders
        rows.append(
            {
                "step": number,
                "added": first.name,
                "gain (nats)": str(first.gain),
                "others would have gained": "; ".join(
                    f"{one.name} {one.gain.value:.2f}" for one in others[:3]
                ),
                "first because": _reason(first.gain, [one.gain for one in others]),
                "missed at the end (nats)": _missed(found, turn.added.name, window),
            }
        )
    return pd.DataFrame(rows)


def _reason(gain: Estimate, others: list[Estimate]) -> str:
    """Return why a step came when it did."""
    if all(gain.value >= other.value for other in others):
        return "gains most"
    return "simpler than what gains more, and as good where it acts"


def _missed(found: Diagnosis, name: str, window: Window) -> str:
    """Return what the final simulator loses on confirm links without one effect."""
    if name not in [effect.name for effect in found.added]:
        return "taken out again"
    seen = found.confirmed
    comparison = Resimulation(ORIGINAL, window)
    rest = tuple(effect for effect in found.added if effect.name != name)
    left, whole = (tally(comparison.ensemble(seen.view, s, 8, 7000)) for s in (rest, found.added))
    return str(gain_interval(left, whole, found.options.seed))


def _order_check(found: Diagnosis) -> Check:
    """Return whether every step's gain on held-out links is above zero."""
    steps = [
        turn.explanation.contenders[0]
        for turn in found.selection.rounds
        if turn.added is not None and turn.explanation is not None
    ]
    words = ", ".join(f"{step.name} {step.gain.value:.2f}" for step in steps)
    sure = bool(steps) and all(step.gain.likely_above_zero for step in steps)
    return Check("in an order it justifies: every step gains on held-out links", words, sure)


def ladder_lines(found: Diagnosis, window: Window) -> list[str]:
    """Return the ladder as Markdown."""
    table = ladder(found, window)
    if not len(table):
        return []
    note = (
        "The ladder. Each step adds what gains most over the simulator so far on links it was "
        "not fitted on; an effect drawn anew for every link goes behind one common to all links "
        "that does as well where it acts. The last column: what the finished simulator loses on "
        "the confirm links without it."
    )
    return [note, "", *markdown_table(table), ""]


def _link_lines(told: Separation | None) -> list[str]:
    """Return the score of every link as Markdown."""
    if told is None:
        return []
    note = "Log odds of being obstructed, learnt from SIMULATED links alone; the label was hidden."
    return [note, "", *markdown_table(told.links), ""]


def mitigation_lines(trained: Mitigated) -> list[str]:
    """Return the training comparison as Markdown."""
    rows = pd.DataFrame(
        [
            ("no mitigation", str(trained.raw)),
            ("REMnet, original simulator", str(trained.before)),
            ("REMnet, diagnosed simulator", str(trained.after)),
            ("original - diagnosed, paired", str(trained.over_before)),
            ("none - diagnosed, paired", str(trained.over_raw)),
        ],
        columns=["confirm links (RECORDED)", "mean abs. range error"],
    )
    note = (
        f"REMnet trained on {trained.simulated_rows} SIMULATED rows alone, "
        f"tested (mean over seeds) on {len(trained.links)} recorded links that the "
        "diagnosis never saw; intervals resample links."
    )
    return [note, "", *markdown_table(rows), "", *markdown_table(trained.links), ""]


def _trained_checks(trained: Mitigated) -> tuple[Check, ...]:
    """Return whether training on the diagnosed simulator pays on held-out recorded links."""
    mae = [f"{e.value:.3f}" for e in (trained.raw, trained.before, trained.after)]
    words = f"MAE {mae[0]} m raw, {mae[1]} m before, {mae[2]} m after"
    return (
        Check(
            "REMnet trained on the diagnosed simulator beats the original simulator's",
            f"{words}; better by {trained.over_before}",
            trained.over_before.above_zero,
        ),
        Check(
            "and beats no mitigation",
            f"{words}; better by {trained.over_raw}",
            trained.over_raw.above_zero,
        ),
    )
