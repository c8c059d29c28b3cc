"""What a named effect does to the ranges that were recorded, in metres.

Parameters may be undetermined each by itself (a thickness and a delay per thickness) where what
they do together is well known.
"""

from __future__ import annotations

from typing import TypeGuard

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.select.settings import MOST_PUBLISHED_M
from bench.discrepancy.settings import LEAST_SCATTER_M, SHOWN_VALUES
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.pattern_curve import PatternCurve
from bench.physics.effects.ranging.power_bias import PowerBias, published_bias_m
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS, Floats


def doings(diagnosis: Diagnosis) -> dict[str, str]:
    """Return in words what every added effect does to ranges of the working rows, by its name.

    Of those that draw at random the jitter alone; not of those that do nothing.
    """
    if diagnosis.evidence is None:
        return {}
    frame, base = diagnosis.evidence.frame, diagnosis.base
    shifts = {one.physics: _shift_m(one, frame, base) for one in diagnosis.added if _steady(one)}
    known = {name: shift for name, shift in shifts.items() if shift is not None}
    said = {name: in_words(shift) for name, shift in known.items()}
    if said.get(PowerBias.name):
        said[PowerBias.name] += beyond_published(known[PowerBias.name])
    for one in diagnosis.added:
        if _follows(one, frame) and said.get(one.physics):
            said[one.physics] += _where_heard(one, frame)
        if isinstance(one, PatternCurve) and one.gain_db:
            said[one.physics] = "; ".join(filter(None, (said.get(one.physics), _gains(one))))
        if isinstance(one, DeviceClock) and said.get(one.physics):
            said[one.physics] += meanwhile(one, diagnosis.evidence.frame)
        if _by_step(one):
            said[one.physics] = _rounds(one)
        if isinstance(one, TimestampJitter):
            spread_m = one.jitter_samples * base.sample_period_ns * C_M_PER_NS
            said[one.physics] = f"ranges scatter by {spread_m:.3g} m (one standard deviation)"
    return {name: words for name, words in said.items() if words}


def beyond_published(shift_m: Floats) -> str:
    """Return what is said of a bias [n] over levels that is far more than published, "" if not."""
    low, high = np.percentile(shift_m, [5, 95])
    if high - low <= MOST_PUBLISHED_M:
        return ""
    return (
        f"; from weak to strong it changes by {high - low:.2g} m, Decawave publishes 0.19 m at "
        "64 MHz (APS011): first paths that are found late may do so, which waveforms tell"
    )


def meanwhile(clock: DeviceClock, frame: pd.DataFrame) -> str:
    """Return how far offsets go from the first rows of each device to its last, "" where not.

    What is stated of every device is its mean: a warm-up is more, or all, of what there is.
    """
    moved = {name: step for name in clock.devices if abs(step := _step_ppm(clock, frame, name))}
    far = sorted(moved, key=lambda name: abs(moved[name]), reverse=True)[:SHOWN_VALUES]
    words = ", ".join(f"{moved[name]:+.2g} ppm at {name}" for name in far)
    rest = f" and less at {len(moved) - len(far)} more" if len(moved) > len(far) else ""
    return f"; offsets change while devices are heard, by {words}{rest}" if words else ""


def _step_ppm(clock: DeviceClock, frame: pd.DataFrame, name: str) -> float:
    """Return by how much the offset of a device changes from its first row to its last."""
    if "time_s" not in frame or not {"tx", "rx"} <= set(frame.columns):
        return 0.0
    heard = frame[(frame["tx"].astype(str) == name) | (frame["rx"].astype(str) == name)]
    ends = heard["time_s"].agg(["min", "max"]).to_numpy(np.float64)
    first, last = (float(clock.at(name, time)) for time in ends) if len(heard) else (0.0, 0.0)
    return last - first


def in_words(shift_m: Floats) -> str:
    """Return shifts of rows [n] in words, "" where none is a millimetre or more."""
    acts = np.abs(shift_m) > LEAST_SCATTER_M
    if not acts.any():
        return ""
    places = np.percentile(shift_m[acts], [5, 50, 95])
    low, middle, high = np.where(np.abs(places) < LEAST_SCATTER_M, 0.0, places)
    where = "" if acts.all() else f" of the rows where it acts ({acts.mean():.0%})"
    same = high - low <= LEAST_SCATTER_M
    around = f"{low:+.3g} to {high:+.3g} m in nine of ten"
    if same or middle:
        return f"ranges {middle:+.3g} m in the median{where}{'' if same else f', {around}'}"
    return f"ranges {around}{where}, none in the median"


def _gains(pattern: PatternCurve) -> str:
    """Return where levels are lowest and highest over the heading, and by how much."""
    low, high = (int(at(pattern.gain_db)) for at in (np.argmin, np.argmax))
    at = (f"{pattern.gain_db[i]:+.2g} dB at {pattern.headings_deg[i]:g} deg" for i in (low, high))
    return f"levels {' to '.join(at)}"


def _rounds(effect: RangeRounding) -> str:
    """Return how far a rounding moves a range, which lies anywhere within a step."""
    half_m = effect.step_m / 2
    ways = effect.leans or (effect.lean,)
    some = {way: ways.count(way) for way in (-0.5, 0.5) if way in ways}
    cut = [f"{way * effect.step_m:+.3g} m in the mean" for way in some]
    if len(ways) == some.get(ways[0]):
        return f"ranges {cut[0]}, by 0 to twice that"
    of = [f"; {n} of {len(ways)} devices {one}" for n, one in zip(some.values(), cut, strict=True)]
    return f"ranges off by up to {half_m:.3g} m either way{''.join(of)}"


def _follows(effect: Effect, frame: pd.DataFrame) -> bool:
    """Return whether an effect follows levels that are recorded: those of the base are others."""
    return isinstance(effect, PowerBias) and "rx_power_dbm" in frame


def _at_levels(effect: Effect, frame: pd.DataFrame) -> Floats | None:
    """Return what a bias does to ranges [k] at the levels that are known, None where none is."""
    level_dbm = numeric(frame, "rx_power_dbm")
    known = level_dbm[np.isfinite(level_dbm)]
    return _bias_m(effect, known) if known.size else None


def _where_heard(effect: Effect, frame: pd.DataFrame) -> str:
    """Return a bias in words where one in ten is weaker, in the middle, and one in ten stronger."""
    levels = np.nanpercentile(numeric(frame, "rx_power_dbm"), [10, 50, 90])
    biases = zip(_bias_m(effect, levels), levels, strict=True)
    return "; " + ", ".join(f"{bias:+.3f} m at {level:.0f} dBm" for bias, level in biases)


def _bias_m(effect: Effect, level_dbm: Floats) -> Floats:
    """Return what a bias does to ranges at levels [k]."""
    assert isinstance(effect, PowerBias)
    return effect.scale * published_bias_m(level_dbm - effect.shift_db)


def _steady(effect: Effect) -> bool:
    kind = type(effect)
    return not (kind.independent or kind.per_link or kind.strikes or _by_step(effect))


def _by_step(effect: Effect) -> TypeGuard[RangeRounding]:
    """Return whether an effect is a rounding that one even step says."""
    return isinstance(effect, RangeRounding) and not (effect.steps_m or effect.growth)


def _shift_m(effect: Effect, frame: pd.DataFrame, base: Base) -> Floats | None:
    """Return what an effect does to the range of every row [n], None where paths do not tell."""
    if _follows(effect, frame):
        return _at_levels(effect, frame)
    try:
        rows = scene(frame)
        made = [Simulator(base, one).observe(rows, 0, cir=False) for one in ((effect,), ())]
    except BenchError:
        return None
    if made[0].range_m is None or made[1].range_m is None:
        return None
    shift = np.asarray(made[0].range_m - made[1].range_m, np.float64)
    return shift if np.isfinite(shift).all() else None
