"""Error before and after mitigation: histograms with 300 bins, and how normal each is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from bench.errors import BenchError
from bench.reproduce import paper
from bench.reproduce.build import make_outcome, over_links
from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table

BINS = 300
QUANTILES = 199
RESAMPLES = 200  # each sorts every row
Floats = NDArray[np.float64]
_PROTOCOL = (
    "REMnet (fp32, seed 0) on the NLoS test rows. Histograms of 300 bins, normalised to density. "
    "Normality: the distance to a normal distribution of the same mean and σ (Kolmogorov's D: "
    "largest difference of the cumulative distributions, 0 = normal), the correlation of the Q-Q "
    "plot (1 = normal), skewness and excess kurtosis (0 = normal). No p-value is given: rows of "
    "one link are not independent, and with thousands of rows any distance is significant. "
    "Intervals: 95 %, bootstrap over links."
)


def run(context: Context) -> Outcome:
    """Return the histograms, the Q-Q plot and the figures that sum them up."""
    (record,) = context.runs("remnet", "fp32")
    table = context.predictions(record)
    table = table[~table["scored_as_los"]]
    if table.empty:
        raise BenchError(f"{context.name}: no NLoS rows to test on")
    states = {"before": table["error_m"], "after": table["error_m"] - table["predicted_m"]}
    values = {name: column.to_numpy(np.float64) for name, column in states.items()}
    rows = [row for name in values for row in _rows(name, values[name], table["link"])]
    summary = Table("NLoS error before and after mitigation", ("",), rows)
    title = "Residuals: range error before and after mitigation"
    figures = [_histogram(values), _qq(values)]
    note = f"The paper prints σ before as 0.1642 (text) and {_printed('sigma_table')} (Table II)."
    return make_outcome(context, "residuals", title, _PROTOCOL, [summary], figures, [note])


def _printed(name: str) -> float:
    return float(paper.before()[f"nlos_{name}_m"])


def _rows(name: str, values: Floats, links: pd.Series) -> list[Row]:
    room = paper.find("rooms", environment="medium")
    printed = {
        "mean": room[f"mean_{name}_m"],
        "σ": _printed("sigma") if name == "before" else room["sigma_after_m"],
    }
    made = []
    for quantity, (unit, statistic) in _statistics().items():
        ours = over_links(statistic, values, links, resamples=RESAMPLES)
        known = printed.get(quantity)
        made.append(Row((name,), quantity, unit, ours, known, of_data=name == "before"))
    return made


def _statistics() -> dict[str, tuple[str, Callable[[Floats], float]]]:
    return {
        "mean": ("m", lambda v: float(v.mean())),
        "σ": ("m", lambda v: float(v.std())),
        "skewness": ("", lambda v: float(stats.skew(v))),
        "excess kurtosis": ("", lambda v: float(stats.kurtosis(v))),
        "distance D": ("", _distance),
        "Q-Q correlation": ("", _straightness),
    }


def _distance(values: Floats) -> float:
    """Return Kolmogorov's D to the normal distribution of the same mean and sigma."""
    spread = values.std()
    if spread == 0:
        return 1.0
    return float(stats.ks_1samp((values - values.mean()) / spread, stats.norm.cdf).statistic)


def _straightness(values: Floats) -> float:
    """Return the correlation of the normal Q-Q plot over evenly spaced quantiles."""
    normal, ours = _quantiles(values)
    return float(np.corrcoef(normal, ours)[0, 1]) if ours.std() > 0 else 0.0


def _quantiles(values: Floats) -> tuple[Floats, Floats]:
    levels = (np.arange(QUANTILES) + 0.5) / QUANTILES
    return np.asarray(stats.norm.ppf(levels)), np.quantile(values, levels)


def _histogram(values: dict[str, Floats]) -> Figure:
    """Return both histograms over the same bins, which hold all but 0.2 % of the rows."""
    pooled = np.concatenate(list(values.values()))
    low, high = np.quantile(pooled, [0.001, 0.999])
    edges = np.linspace(float(low), float(high), BINS + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    series = []
    for name, state in values.items():
        density = np.histogram(state, edges)[0] / (len(state) * np.diff(edges))
        series.append(Series(f"{name} mitigation", middle.tolist(), density.tolist()))
    after = values["after"]
    bell = stats.norm.pdf(middle, after.mean(), after.std())
    series.append(Series("normal, as after", middle.tolist(), bell.tolist(), style="dashed"))
    return Figure(
        "histogram", f"Range error, {BINS} bins", "histogram", "range error (m)",
        "density (1/m)", series,
    )  # fmt: skip


def _qq(values: dict[str, Floats]) -> Figure:
    series = []
    for name, state in values.items():
        normal, ours = _quantiles((state - state.mean()) / max(state.std(), 1e-12))
        series.append(Series(f"{name} mitigation", normal.tolist(), ours.tolist()))
    ends = [-3.0, 3.0]
    series.append(Series("normal", ends, ends, style="dashed"))
    return Figure(
        "normality", "Normal Q-Q plot of standardised errors", "scatter",
        "normal quantile (σ)", "quantile of the error (σ)", series,
    )  # fmt: skip
