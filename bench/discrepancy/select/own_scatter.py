"""Scatter of ranges that a named cause makes by itself is no jitter.

An edge is timed the worse the more noise there is beside the signal: its standard deviation goes
with the square root of noise over signal (Kay 1993, section 3.11). A truth that is late is not
equally late in every row (a tracker has frames, a host a queue), and a device moves as far
meanwhile as it is fast: what that leaves goes with the speed. A crystal's offset wanders, with its
warmth or by itself, and what that makes goes with the reply time, as what it makes in the mean
does. Paths that are named move what is detected from row to row, and most what they move most. Time
stamps scatter every range alike. Where a receiver logs a noise that is louder than simulated,
motion, clocks or, of waveforms, paths are named, these are put to ranges.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.residual_range import moved_m
from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.law.likelihood import log_density
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.in_turn import apart_in_turn
from bench.discrepancy.select.receiver_logs import logs
from bench.discrepancy.select.settings import EXTRA_SCATTER_M, PATHS_TIMES, REPLY_RATIO
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import versions
from bench.discrepancy.select.within_links import within
from bench.discrepancy.sets.settings import DEVICE_ROWS
from bench.discrepancy.settings import FIT_MEMBERS, LEAD_NATS, LEAST_SCATTER_M
from bench.physics.effect import Effect
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.units import Floats
from bench.recordings.motion import SPEED

REPLY = "reply_time_s"
OF_NOISE = "it scatters as the noise does that is logged"
OF_MOTION = "it scatters as devices move"
OF_CLOCKS = "it scatters as clocks wander"
OF_PATHS = "it scatters as paths move what is detected"
OWN = (OF_NOISE, OF_MOTION, OF_CLOCKS, OF_PATHS)
OF_SCATTER = ("spread", "rows")  # moments that say how far ranges scatter
ENDS = ("tx", "rx")
FARTHER = "it scatters the more, the farther devices are apart"
WEAKER = "it scatters the more, the weaker the signal"
FASTER = "it scatters the more, the faster devices move apart"


def beyond_causes(search: Search, added: Added, effect: Effect) -> Adequacy:
    """Return whether independent scatter is told from that which other causes make themselves.

    Of rows beside their link: that of clocks must be likelier by 3 nats than one whose variance
    goes with the noise that was not simulated over the signal, with how far devices move, or with
    the reply time. No scatter that grows with the distance, with the speed, or as the signal fades,
    may be likelier by as much. And it is drawn for every row, so rows that follow each other must
    differ as any two do.
    """
    if not type(effect).independent or type(effect).marked or search.work is None:
        return Adequacy(True)
    rest = without(added, effect)
    made = versions(search.comparison, search.work, rest)
    if RANGE not in made.names:
        return Adequacy(True)
    own = _own_notes(made, _own_scatter(search, search.work, rest))
    own += of_paths(search, search.work, rest, made)
    if notes := [*own, *uneven(made, search.work), *of_one_device(made, search.work)]:
        return Adequacy(False, 1.0, note=notes[0])
    return apart_in_turn(made, numeric(search.work.frame, "time_s"), search.seed)


def left_by_causes(search: Search, added: Added, findings: tuple[Finding, ...]) -> bool:
    """Return whether all that is left is scatter of ranges which named causes make by themselves.

    It has their name: nothing is left without one.
    """
    cells = [one.cell for one in findings]
    if not added or not all(c.observable == RANGE and c.moment in OF_SCATTER for c in cells):
        return False
    kind = next((k for k in search.kinds.values() if k.independent and not k.marked), None)
    if kind is None or not cells or any(isinstance(one, kind) for one in added):
        return False
    return beyond_causes(search, (*added, kind()), kind()).note in OWN


def _own_notes(made: Ensemble, own: dict[str, Floats]) -> list[str]:
    """Return which of named causes' own scatters, by what to say, rows may scatter by."""
    if not own:
        return []
    left, simulated = _beside(made)
    spread = max(float(np.nanmean(simulated**2)), LEAST_SCATTER_M**2)
    return [note for note, goes in own.items() if not _even(left, spread, goes)]


def of_paths(search: Search, rows: View, rest: Added, made: Ensemble) -> list[str]:
    """Return that ranges may scatter as named paths move them, by what to say, or nothing.

    By how far waveform effects move the range of each row, in the root mean square of versions:
    their form is not a recording's, so how far its rows are moved by it goes with that. Time stamps
    must be likelier by 3 nats, unless rows scatter by far more than paths move them. `made` are the
    versions of rows with the effects `rest`.
    """
    paths = tuple(effect for effect in rest if type(effect).stage != "ranging")
    if not (paths and search.fit.waveform):
        return []
    beside = tuple(effect for effect in rest if effect not in paths)
    without_them = versions(search.comparison, rows, beside)
    moved_m = made.simulated_of(RANGE) - without_them.simulated_of(RANGE)
    left, simulated = _beside(made)
    goes = np.mean(moved_m**2, axis=0)
    more_m2 = float(np.nanmean(left**2) - np.nanmean(simulated**2))
    if more_m2 > PATHS_TIMES**2 * float(np.nanmean(goes)):
        return []
    return [OF_PATHS] * _grows(left, simulated, goes, -2 * LEAD_NATS)


def uneven(made: Ensemble, rows: View) -> list[str]:
    """Return what the scatter of ranges grows with, by what to say; nothing where it is even.

    Its variance with the square of the distance, or one over the power of the signal: so a noise
    scatters edges, of signals that fade in free space. Or with the square of the speed: so does a
    truth that is off along the way, though nothing that it does is named. Beside simulated scatter,
    which may grow so.
    """
    left, simulated = _beside(made)
    goes = {FARTHER: rows.scene.true_range_m**2}
    if SPEED in rows.frame:
        goes[FASTER] = numeric(rows.frame, SPEED) ** 2
    if LEVEL in rows.frame:
        goes[WEAKER] = 10 ** (-numeric(rows.frame, LEVEL) / 10)
    return [note for note, one in goes.items() if _grows(left, simulated, one)]


def of_one_device(made: Ensemble, rows: View) -> list[str]:
    """Return which device alone has ranges that scatter, in words; nothing where others do, too.

    Its rows or all rows scatter more than simulated; asked of the device that scatters most, which
    is one of many.
    """
    left, simulated = _beside(made)
    ends = [one for one in ENDS if one in rows.frame]
    names = {end: rows.frame[end].astype(str).to_numpy(object) for end in ends}
    every = {(end, one): names[end] == one for end in ends for one in np.unique(names[end])}
    some = {key: mask & np.isfinite(left) for key, mask in every.items()}
    some = {key: mask for key, mask in some.items() if mask.sum() >= DEVICE_ROWS < (~mask).sum()}
    wide = {key: float(np.mean(left[mask] ** 2)) for key, mask in some.items()}
    end, one = max(wide, key=lambda key: wide[key], default=("", ""))
    if not one or not _grows(left, simulated, some[end, one] * 1.0, float(np.log(len(some)))):
        return []
    return [f"it scatters where {end} is {one} alone"]


def _grows(left_m: Floats, simulated_m: Floats, goes: Floats, more_nats: float = 0.0) -> bool:
    """Return whether ranges [n] scatter rather with `goes` [n] than evenly, beside simulated ones.

    The variance of simulated ranges [m, n] is a line over it. `more_nats`: of lead, for what was
    chosen of many.
    """
    known = np.isfinite(left_m) & np.isfinite(goes) & np.isfinite(simulated_m).all(axis=0)
    if known.sum() < 2 or not goes[known].any():
        return False
    share = goes[known] / goes[known].mean()
    ways, square = np.stack([np.ones(len(share)), share], axis=1), simulated_m[:, known] ** 2
    own_m2 = ways @ nnls(ways, square.mean(axis=0))[0]
    own_m2 = np.maximum(own_m2, LEAST_SCATTER_M**2)
    even, growing = (likeliest(left_m[known], own_m2, one) for one in ways.T)
    return growing > even + LEAD_NATS + more_nats


def _own_scatter(search: Search, rows: View, rest: Added) -> dict[str, Floats]:
    """Return what variances go with that named causes make themselves, [n] each by what to say."""
    out = {}
    if any(isinstance(one, NoiseFloor) for one in search.logged):
        louder = np.maximum(10 ** (logs(search, rows).noise_db / 10) - 1, 0)
        out[OF_NOISE] = louder * 10 ** (-numeric(rows.frame, LEVEL) / 10)
    moving = [one for one in rest if any(SPEED in way for way in type(one).needs)]
    if moving:
        out[OF_MOTION] = np.sum(
            [moved_m(search.comparison, rows, rest, one, FIT_MEMBERS) ** 2 for one in moving],
            axis=0,
        )
    reply_s = numeric(rows.frame, REPLY) if REPLY in rows.frame else np.zeros(0)
    clocks = any(one.physics == ClockOffset.name for one in rest)
    if clocks and np.nanmax(reply_s, initial=0.0) > REPLY_RATIO * np.nanmin(reply_s):
        out[OF_CLOCKS] = reply_s**2
    return out


def _beside(made: Ensemble) -> tuple[Floats, Floats]:
    """Return recorded [n] and simulated ranges [m, n] beside the mean simulated and their link.

    What devices that move do to ranges is the same in all versions, and no scatter.
    """
    versions_m = made.versions.copy()
    m = len(versions_m) - 1
    if m > 1:
        versions_m -= versions_m[1:].mean(axis=0)
        versions_m[1:] *= np.sqrt((m + 1) / (m - 1))  # as far as a new one is
    return within(Ensemble(made.names, made.units, versions_m, made.links))


def _even(left_m: Floats, own_m2: float, goes: Floats) -> bool:
    """Return whether ranges [n] scatter evenly rather than with `goes` [n]; where that is none."""
    known = np.isfinite(left_m) & np.isfinite(goes)
    if not goes[known].any():
        return True
    even, other = (
        likeliest(left_m[known], own_m2, one[known] / one[known].mean())
        for one in (np.ones(len(left_m)), goes)
    )
    return even > other + LEAD_NATS


def likeliest(left_m: Floats, own_m2: float | Floats, goes: Floats) -> float:
    """Return the largest log likelihood of ranges [n] whose extra variance goes with [n].

    Of Student's t: how fast a device turned between two rows of the truth, nobody knows.
    """
    sizes_m = np.array([0.0, *np.geomspace(*EXTRA_SCATTER_M)])
    every = np.sqrt(own_m2 + np.square(sizes_m)[:, None] * goes)
    return float(log_density(left_m, every).sum(axis=1).max())
