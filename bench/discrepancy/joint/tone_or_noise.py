"""Where to begin trying what raises the noise in the place of something else that does.

A tone and a louder noise floor both raise what is there before the first path, and are told apart
only where both are fitted. A tone fades, so from points of some other level its fit ends in a wrong
place: it begins at the power that the noise floor adds, and the floor at the power of the tone.

Of magnitudes, a weak tone does what a louder noise does: of K times the noise's power it raises
their mean power and their variance by a factor 1 + K, but for a part of K^2 (0.46 K^2 / (1 + K) of
the variance, Rice 1945). How the level differs between rows tells them apart no better, as noise
differs from place to place too. A tone that is loud makes the samples before the path of one row
alike, which no noise does; one that is keyed within a row need not. Else they are told by the noise
that is logged, or not at all: where it is known that scatter is logged, as the DW1000 does, not
power.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import ive

from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import NOISE
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.joint.likelihood import whitener
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import CLASS_NATS, DB_PER_NEPER, TAIL, TONE_FADING_DB
from bench.discrepancy.joint.statistics import Floats, Moments, Statistics
from bench.physics.effect import Effect
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor

EARLY = "early_scatter"
WHITE = {"lag_1": 0.0, "lag_2": 0.0, "lag_3": 0.0}


def counterparts(effect: Effect) -> Added:
    """Return the effects of the other kind that add as much power to the noise; mostly none."""
    if isinstance(effect, NoiseFloor) and effect.level_db > 0:
        return (_tone(_more(effect)),)
    if isinstance(effect, NarrowbandInterference):
        return (floor_of(effect),)
    return ()


def floor_of(tone: NarrowbandInterference) -> NoiseFloor:
    """Return the noise floor that adds as much power to the noise as a tone."""
    return NoiseFloor(_within(NoiseFloor, 10 * np.log10(1 + _power(tone))))


def with_tone(effects: Added) -> Added:
    """Return a set with a tone of the same power in the place of its noise floor."""
    floors = (one for one in effects if isinstance(one, NoiseFloor))
    rest = tuple(one for one in effects if not isinstance(one, NoiseFloor))
    return (*rest, *(tone for floor in floors for tone in counterparts(floor)))


def with_floor(effects: Added) -> Added:
    """Return a set with a noise floor of the same power in the place of its tone.

    It hides as much of weak paths, and is white: without a colour of its own.
    """
    tones = [one for one in effects if isinstance(one, NarrowbandInterference)]
    rest = tuple(one for one in effects if not isinstance(one, NarrowbandInterference))
    if any(isinstance(one, NoiseFloor) for one in rest):
        return rest
    return (*rest, *(revalued(floor_of(tone), WHITE) for tone in tones))


def scatter_logged(effects: Added) -> Added:
    """Return effects with tones of which the scatter is logged."""
    return tuple(
        replace(one, power_logged=0.0) if isinstance(one, NarrowbandInterference) else one
        for one in effects
    )


def told_apart(given: Statistics, fit: Fit, name: str) -> float:
    """Return the nats by which a tone is told from a noise floor of the same power.

    By how steady samples before the path are, of a tone; a noise floor is no sure one where they
    are. Else by the noise that is logged, were the tone a steady one: infinite where none is
    logged, and the whole likelihood must tell. None of another tool's table: it may log the power
    of noise, which a tone has too, or its scatter. None where links have more or less of a noise
    floor by chance, as they may have of a tone.
    """
    place = fit.names.index(name)
    effect, early = fit.effects[place], fit.responses[place]
    if isinstance(effect, NarrowbandInterference):
        steady = steadied(given, fit.moments, early)
        if steady >= CLASS_NATS:
            return steady
    elif too_steady(given, fit.moments) >= CLASS_NATS:
        return 0.0
    if not given.by_rows or fit.moments.uneven is not None:
        return 0.0
    return _logged(given, fit, effect) if NOISE in given.names else float("inf")


def steady(given: Statistics, fit: Fit) -> float:
    """Return the nats by which early samples speak for the tone of a set, 0 where it has none."""
    tone = NarrowbandInterference.name
    if tone not in fit.names:
        return 0.0
    return steadied(given, fit.moments, fit.responses[fit.names.index(tone)])


def steadied(given: Statistics, moments: Moments, response: Floats) -> float:
    """Return the nats by which early samples scatter as little as a tone's `response` [L, p] says.

    Of this statistic alone, links far off by the logarithm; none where it is not known. `moments`
    are those with the tone in place.
    """
    if EARLY not in given.names:
        return 0.0
    left, came = _early(given, moments, moments.left), _early(given, moments, response)
    nats = (TAIL + 1) / 2 * (np.log1p((left + came) ** 2 / TAIL) - np.log1p(left**2 / TAIL))
    return float(nats.sum() / given.crowding)


def too_steady(given: Statistics, moments: Moments) -> float:
    """Return the nats by which early samples scatter less than simulated, in all links alike."""
    if EARLY not in given.names:
        return 0.0
    left = np.clip(_early(given, moments, moments.left), -3, 3)
    return float(0.5 * min(left.sum(), 0) ** 2 / given.links / given.crowding)


def _early(given: Statistics, moments: Moments, values: Floats) -> Floats:
    """Return what values [L, p] say of early samples [L], in scatters of simulated links."""
    place = given.names.index(EARLY)
    spread = np.sqrt([moments.covariances[int(n)][place, place] for n in given.count])
    return np.asarray(values[:, place] / spread)


def _logged(given: Statistics, fit: Fit, effect: Effect) -> float:
    """Return the nats by which logged noise differs between a steady tone and noise."""
    power = _power(effect) if isinstance(effect, NarrowbandInterference) else _more(effect)
    place = given.names.index(NOISE)
    matrices, _ = whitener(given, fit.moments, fit.responses)
    apart = matrices[:, :, place] * steadier_db(power)
    return float(0.5 * (apart**2).sum() / given.crowding)


def steadier_db(power: float) -> float:
    """Return how much less magnitudes scatter with a tone than with noise of the same power, dB.

    `power` is the tone's over the noise's: the moments of Rice's distribution (Rice 1945).
    """
    mean = (1 + power) * ive(0, power / 2) + power * ive(1, power / 2)
    scatter = (1 + power - np.pi / 4 * mean**2) / (1 - np.pi / 4)
    return float(10 * np.log10((1 + power) / scatter))


def _tone(power: float, fading_db: float = TONE_FADING_DB) -> NarrowbandInterference:
    """Return a tone of a mean power over the noise's, that is always on."""
    faded = NarrowbandInterference(0.0, fading_db, share=1.0)
    level = _within(NarrowbandInterference, 10 * np.log10(max(power, 1e-9) / _power(faded)))
    return NarrowbandInterference(level, fading_db, share=1.0)


def _more(effect: Effect) -> float:
    """Return the power that a noise floor adds, over the noise's."""
    assert isinstance(effect, NoiseFloor)
    return float(10 ** (effect.level_db / 10) - 1)


def _power(tone: NarrowbandInterference) -> float:
    """Return the mean power of a tone over the noise's: that of a lognormal level."""
    nepers = tone.fading_db / (DB_PER_NEPER / 2)
    return float(tone.share * 10 ** (tone.level_db / 10) * np.exp(nepers**2 / 2))


def _within(kind: type[Effect], level_db: float) -> float:
    """Return a level within the bounds of an effect."""
    item = next(p for p in kind.parameters() if p.name == "level_db")
    return float(np.clip(level_db, item.low, item.high))
