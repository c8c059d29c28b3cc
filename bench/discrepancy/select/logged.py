"""What a receiver logs beside ranges tells causes apart that ranges and levels alone do not.

From paths alone neither the count of accumulated symbols nor the noise of an accumulator is
simulated, so no score sees them. But where both sides log them they are read directly. A receiver
that controls its level stops accumulating early where signals are strong, which no path loss does;
a raised noise floor is in the noise that is logged, whatever ranges do.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import cluster_bootstrap
from bench.discrepancy.compare.skill import Tally, gain, tally
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.grouped import group_means
from bench.discrepancy.data.observables import COUNT, NOISE
from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.control_curve import with_curve
from bench.discrepancy.select.noisy_devices import noise_of_devices, read_levels
from bench.discrepancy.select.receiver_logs import Logged, logs, logs_as_simulated
from bench.discrepancy.select.settings import (
    LOGGED_COMPRESSIONS,
    LOGGED_LEVELS,
    LOGGED_NATS,
    LOGGED_SHARES,
    LOGGED_SHIFTS_DB,
    NOISE_FORMULA_DB,
    SPARE_LINKS,
)
from bench.discrepancy.select.state import Search, State
from bench.discrepancy.select.within_links import rows_per_link
from bench.discrepancy.settings import FIT_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.effects.receiver.level_control import LevelControl, accumulated_share
from bench.physics.effects.receiver.noise_floor import NoiseFloor

Floats = NDArray[np.float64]
PEAK_NULL = next(p.high for p in LevelControl.parameters() if p.name == "peak_counts")


def with_logs(state: State) -> State:
    """Return the state with what logs beside ranges say, as it is where they cannot be read."""
    read = state.guard.safely("logs of the receiver", read_logs, state.search)
    return replace(state, search=read(state.search))


def read_logs(search: Search) -> Search:
    """Return the search with what logs beside ranges say.

    `logged` are effects that the logs show; a level control that they exclude is not offered.
    Beside waveforms noise is weighed with these: it is seen in samples before the path, too. But
    of few devices that are louder than others a log alone says by how much.
    """
    waves, rows = search.fit.waveform, search.both
    seen = logs_as_simulated(search, rows)
    found: list[Effect] = []
    if LevelControl.name in search.kinds:
        if max(ends_early(seen), turns_down(seen)) > LOGGED_NATS:
            found.append(_level_control(search, rows, seen))
        elif as_simulated(seen) > LOGGED_NATS:
            search = search.without(LevelControl())
    if NoiseFloor.name in search.kinds:
        noisy = noise_of_devices(search, rows, seen)
        if noisy:
            found, search = [*found, noisy], search.without(NoiseFloor())
        elif not waves and louder(seen) > LOGGED_NATS:
            found.append(NoiseFloor(level_db=_louder_db(seen)))
    return replace(search, logged=tuple(found))


def ends_early(seen: Logged) -> float:
    """Return the nats for counts that fall where levels are strong, 0 where that is not known.

    Beside counts that every device has of its own; by a step, a slope or a ramp from some level on,
    of which one costs as much as was tried. Beyond what a simulated version shows beside others:
    where its receiver does it as well, a row that is louder by chance has a smaller count there.
    """
    other = seen.simulated
    return _over_levels(seen) - max(_over_levels(other) if other else 0.0, 0.0)


def _over_levels(seen: Logged) -> float:
    """Return the nats for counts that fall where levels are strong, on one side."""
    rows = seen.known(seen.level_dbm, seen.count_db)
    if not rows.any():
        return 0.0
    own, count = seen.devices[rows], seen.count_db[rows]
    forms = [form for one in seen.followed for form in _falling(one[rows])]
    freedom = _independent(seen, rows, count, own, forms)
    brought = [_brings(count, own, form[:, None], freedom, seen.rounding_db2) for form in forms]
    return max(brought) - float(np.log(len(forms)))


def turns_down(seen: Logged) -> float:
    """Return the nats for counts that fall where rows fall behind the level of their own link.

    A receiver that turns down and stops at once, now and then, does so whatever its devices are set
    to; what is in the way of a signal takes none of the count. Beyond what a simulated version
    shows, whose receiver may do it as well; 0 where that is not known.
    """
    if seen.simulated is None:
        return 0.0
    return _within_links(seen) - max(_within_links(seen.simulated), 0.0)


def _within_links(seen: Logged) -> float:
    """Return the nats for counts that fall, within links, where levels are behind what arrives."""
    if seen.links is None or len(seen.followed) <= len(seen.levels_dbm):
        return 0.0
    behind = seen.followed[-1]
    rows = seen.known(seen.count_db, behind)
    if not rows.any():
        return 0.0
    code, forms = np.unique(seen.links[rows], return_inverse=True)[1], _falling(behind[rows])
    freedom = float(len(code) - len(np.unique(code)))
    every = np.stack([seen.count_db[rows], *forms], axis=1)
    count, *ways = (every - group_means(every, code)).T
    null = np.zeros((len(code), 1))
    brought = [_brings(count, null, way[:, None], freedom, seen.rounding_db2) for way in ways]
    return max(brought) - float(np.log(len(forms)))


def _falling(level_dbm: Floats) -> list[Floats]:
    """Return what falls from some level on: slopes, steps, and ramps that end at another, [n] each.

    Accumulation ends somewhere between its longest and its shortest.
    """
    knots = np.quantile(level_dbm, LOGGED_LEVELS)
    over = [np.maximum(level_dbm - knot, 0) for knot in knots]
    pairs = [(a, b) for a, b in combinations(knots, 2) if b > a]
    ramps = [np.clip(level_dbm - a, 0, b - a) for a, b in pairs]
    return [-one for one in (*over, *ramps)] + [-(one > 0).astype(np.float64) for one in over]


def _independent(
    seen: Logged, rows: NDArray[np.bool_], values: Floats, null: Floats, forms: list[Floats]
) -> float:
    """Return how many independent values [n] there are beside what some forms leave of them.

    Rows of one link count as far as they have nothing in common (the design effect: Kish 1965),
    beside the form that leaves least.
    """
    if seen.links is None:
        return seen.freedom
    every = (rest_of(values, np.column_stack([null, form])) for form in forms)
    left = min(every, key=lambda one: float(np.sum(one**2)))
    code = np.unique(seen.links[rows], return_inverse=True)[1]
    return seen.freedom * rows_per_link(left, code)


def as_simulated(seen: Logged) -> float:
    """Return the nats that speak against counts falling as a control of levels makes them fall."""
    rows = seen.known(seen.level_dbm, seen.count_db)
    if not rows.any():
        return 0.0
    own, count = seen.devices[rows], seen.count_db[rows]
    fall = 10 * np.log10(accumulated_share(seen.level_dbm[rows]))
    least = min((_left(count - share * fall, own) for share in LOGGED_SHARES), default=0.0)
    spare = seen.rounding_db2 * len(count)
    freedom = seen.freedom - own.shape[1]
    return float(0.5 * freedom * np.log((least + spare) / (_left(count, own) + spare)))


def louder(seen: Logged) -> float:
    """Return the nats for noise of another level than simulated, 0 where that is not known.

    Beyond what goes with the count: its level as a whole, or that of every device. Less noise than
    simulated is nothing that the simulator leaves out.
    """
    rows = seen.known(seen.noise_db)
    if not rows.any() or np.mean(seen.noise_db[rows]) <= 0:
        return 0.0
    spare, noise, own = NOISE_FORMULA_DB**2, seen.noise_db[rows], seen.devices[rows]
    null = np.nan_to_num(seen.count_db[rows])[:, None]
    return max(_brings(noise, null, way, seen.freedom, spare) for way in (own[:, :1], own))


def _louder_db(seen: Logged) -> float:
    """Return by how much the logged noise is louder than simulated, within the effect's bounds."""
    item = next(p for p in NoiseFloor.parameters() if p.name == "level_db")
    return float(np.clip(np.nanmedian(seen.noise_db), item.low, item.high))


def read_off(search: Search, effect: Effect) -> tuple[ParameterEstimate, ...]:
    """Return the level of a noise floor that logs show, or its devices'; none of another effect.

    Ranges need not tell it. The interval is that of the mean over links.
    """
    if isinstance(effect, NoiseOfDevices):
        return read_levels(effect)
    if not (isinstance(effect, NoiseFloor) and effect in search.logged):
        return ()
    seen, links = logs(search, search.both).noise_db, search.both.links
    rows = np.isfinite(seen)
    mean = cluster_bootstrap(seen[rows], links[rows], search.seed, "dB")
    low, high = (effect.level_db + end - mean.value for end in (mean.low, mean.high))
    return (ParameterEstimate("level_db", effect.level_db, low, high, "dB"),)


def judged_by(search: Search, effect: Effect) -> str:
    """Return what the gain of an effect is, "" where it decides; logs that show it decide alone."""
    if effect.name not in {one.name for one in search.logged}:
        return ""
    if isinstance(effect, LateDetection):
        seen = "where the index lies behind the edge of its record"
    else:
        seen = f"the {COUNT if isinstance(effect, LevelControl) else NOISE} that is logged"
    return f"told by {seen}; gain on held-out links, which does not decide"


def _brings(values: Floats, null: Floats, ways: Floats, count: float, spare: float) -> float:
    """Return the nats that `ways` [n, k] bring for values [n] beside `null` [n, j].

    `count` values are independent, not all; each factor pays half the logarithm of their number
    (Schwarz 1978), and what is `spare` of the variance is none to be explained. A first factor
    below zero is none.
    """
    both = np.hstack([null, ways])
    factors = np.linalg.lstsq(both, values, rcond=None)[0]
    freedom = count - both.shape[1]
    if freedom < SPARE_LINKS or (ways.shape[1] == 1 and factors[-1] <= 0):
        return 0.0
    before, after = (_left(values, design) + spare * len(values) for design in (null, both))
    cost = 0.5 * ways.shape[1] * np.log(count)
    return float(0.5 * freedom * np.log(max(before, 1e-300) / max(after, 1e-300)) - cost)


def _left(values: Floats, design: Floats) -> float:
    """Return the squares that a regression on a design [n, k] leaves of values [n]."""
    return float(np.sum(rest_of(values, design) ** 2))


def _level_control(search: Search, rows: View, seen: Logged) -> Effect:
    """Return the level control that fits counts best, and with these the recorded levels.

    Where it starts and how much sooner it stops is for counts to say: levels change for many
    reasons, and it would take from them what a path loss does.
    """
    known = seen.known(seen.level_dbm, seen.count_db)
    count, own = seen.count_db[known], seen.devices[known]
    ways = list(product(seen.levels_dbm, LOGGED_SHIFTS_DB, LOGGED_SHARES))
    left = [_left(count - _count_db(at[known] - shift, share), own) for at, shift, share in ways]
    _, shift, share = ways[int(np.argmin(left))]
    made = LevelControl(0.0, share, PEAK_NULL, shift)

    def score(one: Effect) -> Tally:
        return tally(search.comparison.ensemble(rows, (one,), FIT_MEMBERS))

    tried = [replace(made, compression=size) for size in LOGGED_COMPRESSIONS]
    base = score(made)
    best = max(tried, key=lambda one: gain(base, score(one)))
    return with_curve(search, (best,))[0]


def _count_db(level_dbm: Floats, share: float) -> Floats:
    """Return by how much the count [n] falls with a share of the measured fall, in dB."""
    return np.asarray(10 * np.log10(1 - share * (1 - accumulated_share(level_dbm))))


def shown(search: Search, added: Added = ()) -> Added:
    """Return the effects that logs show, in the form that they have among `added`."""
    have = {effect.name: effect for effect in added}
    return tuple(have.get(effect.name, effect) for effect in search.logged)
