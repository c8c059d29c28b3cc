"""What the opera hides in waveforms: effects in forms of its own, oddities of its consoles.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.opera_console import METRES, PLACES, WIDE_SAMPLES, Console, hiss
from bench.challenge.families.opera_effects import EFFECTS, deck_ray
from bench.challenge.families.opera_stage import CLEATS, STAGE_M
from bench.challenge.families.opera_stage import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the opera's tables of ranges."""
ODD = ("eights-sorted", "mantissas-lost", "histogram-equalised")
ELSEWHERE = ("rake-forgotten", "varas-from-one-cleat")
LAWS = {one: law for one, law in LAWS_OF_ROWS.items() if one not in ELSEWHERE}
LAWS |= {one: Law() for one in ODD}
"""What nobody's library has."""
FROM = 10.5  # samples past edges from which consoles are odd
IRON, CONCRETE, BRICK = 0.93, 5.24, 3.91  # amplitude that comes back; permittivities
CHANCES: Complexes = np.exp(2j * np.pi * np.arange(48) / 48) * np.sqrt(
    -2 * np.log((np.arange(400)[:, None] + 0.5) / 400)
)  # noise to try readings on, evenly over chances [400, 48]


def _walls(console: Console, strength: float) -> None:
    """Hear the iron curtain and three walls, by images of tags, by Fresnel's law or whole."""
    first, cue = console.arrived() * console.beginning(), console.cue()
    for axis, wall_m, dense in (
        (1, 0.0, np.inf), (1, STAGE_M[1], BRICK), (0, 0.0, CONCRETE), (0, STAGE_M[0], CONCRETE),
    ):  # fmt: skip
        apart = cue.at - cue.post
        apart[:, axis] = 2 * wall_m - cue.at[:, axis] - cue.post[:, axis]
        way = np.linalg.norm(apart, axis=1)
        square = np.abs(apart[:, axis]) / way
        inside = np.sqrt(min(dense, 1e9) - 1 + square**2)
        back = IRON if np.isinf(dense) else (inside - square) / (inside + square)
        free = cue.by_link(lambda n: console.rng.beta(5.0, 2.0, n))
        size = (1.5 * strength**0.5 * free * back * cue.way / way).clip(max=0.8)
        late = np.maximum((way - cue.way) / METRES, 2.6)
        console.echo(first, size * console.phases(), late)


def _deck(console: Console, strength: float) -> None:
    longer, share = deck_ray(console.cue(), strength)
    console.echo(console.arrived(), share, longer / METRES)


def _past_a_stack(console: Console, strength: float) -> None:
    """Lose what comes straight past a stack of scenery; the rest finds its way by gaps."""
    cue, air = console.cue(), console.arrived()
    past = cue.some_hidden(0.21)
    console.weaken(1 - 0.985 * past[:, None] * console.beginning())
    samples = 1.3 + 1.6 * strength**0.7 * cue.by_link(lambda n: console.rng.uniform(0.6, 1.4, n))
    size = 0.46 * cue.by_link(lambda n: console.rng.uniform(0.85, 1.15, n))
    for _ in range(4):
        console.echo(air, size * past * console.phases(), samples)
        samples = samples + cue.by_link(lambda n: 1.2 + console.rng.gamma(2.0, 1.1, n))
        size = 0.68 * size


def _few_rays(console: Console, strength: float) -> None:
    """Fade by sums of four squares, which last as long as a pulse does (Nakagami, m = 2)."""
    bell = np.hanning(13)[1:-1]
    power = np.zeros(console.wave.shape)
    for one in (hiss(console.rng, console.count) for _ in range(2)):
        soft = sum(weight * np.roll(one, k, axis=1) for k, weight in enumerate(bell))
        power += np.abs(soft) ** 2
    mixed = min(0.6 * strength**0.6, 0.9)
    by = np.sqrt(1 - mixed + mixed * power / power.mean())
    console.wave = console.wave + console.arrived() * (by - 1)


def _tower(console: Console, strength: float) -> None:
    """Reverberate up and down the tower: what is heard of it swells, and dies away (Erlang)."""
    since = np.clip(console.since - 3.2, 0.0, None) / 12.0
    power = 0.052 * strength * since * np.exp(1 - since) * console.after(3.2)
    console.add_noise(np.sqrt(power / 2) * console.heights()[:, None])


def _stub(console: Console, strength: float) -> None:
    """Echo in a cable that fits neither of its ends: once, and once more of that."""
    samples, phase = console.common(1).uniform((3.6, 0.0), (6.2, 2 * np.pi))
    back = 0.27 * min(strength, 2.4) ** 0.8 * np.exp(1j * phase)
    air = console.arrived()
    for turns in (1, 2):
        console.echo(
            air, back**turns + np.zeros(console.count), np.full(console.count, samples * turns)
        )


def _dimmers(console: Console, strength: float) -> None:
    db = EFFECTS["noise-floor"](console.cue(), strength).hiss_db
    console.louder_noise(db + np.zeros(console.count))


def _spread(sizes: Floats, reading: Callable[[Complexes, float], Floats]) -> Floats:
    """Return how many times more sizes of noise scatter, read in some way with such sizes [k]."""
    spread = [float(reading(CHANCES, one).std()) for one in sizes]
    return np.asarray(np.array(spread) / np.abs(CHANCES).std())


def _intercom(console: Console, strength: float) -> None:
    """Hear the stage manager's intercom: a carrier beside the channel's, keyed in most rows."""
    pitch = console.common(2).uniform(0.4, 1.3)
    near = console.common(3).gamma(9.0, 1 / 9.0, CLEATS)[console.cue().cleat]
    keyed = console.rng.random(console.count) < 0.8
    size = 1.7 * strength * near * keyed * console.rng.uniform(0.65, 1.35, console.count)
    tone = (console.phases() * size * console.sigma)[:, None] * np.exp(1j * pitch * PLACES)
    console.wave = console.wave + tone
    sizes = np.linspace(0.0, 12.0, 73)
    by = np.interp(size, sizes, _spread(sizes, lambda noise, one: np.abs(noise + one)))
    console.told_noise = console.told_noise * by
    console.sigma = console.sigma * np.sqrt(1 + size**2 / 2)


def _words(console: Console, strength: float) -> None:
    """Keep whole steps of both parts, by size: what is over is dropped towards zero."""
    step = 0.9 * strength * float(np.median(console.sigma))
    wave = console.wave
    console.wave = step * (np.trunc(wave.real / step) + 1j * np.trunc(wave.imag / step))
    steps = np.geomspace(0.05, 6.0, 60)
    spread = _spread(
        steps,
        lambda noise, one: one * np.hypot(np.trunc(noise.real / one), np.trunc(noise.imag / one)),
    )
    by = np.interp(step / console.sigma, steps, spread)
    console.told_noise = console.told_noise * np.maximum(by, 0.05)


def _deaf(console: Console, strength: float) -> None:
    """Ask more of a first path, as where an orchestra was once in the way."""
    console.deaf = strength


def _odd(console: Console, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    share = part * console.after(FROM)
    console.wave = console.wave * (
        1 + share * (sizes / np.clip(np.abs(console.wave), 1e-9, None) - 1)
    )


def _eights(console: Console, strength: float) -> None:
    """Sort late sizes within eights, as a network does that finds medians, and is read too soon."""
    size = np.abs(console.wave)
    whole = WIDE_SAMPLES // 8 * 8
    eights = np.sort(size[:, :whole].reshape(console.count, -1, 8), axis=2)
    ordered = size.copy()
    ordered[:, :whole] = eights.reshape(console.count, whole)
    _odd(console, ordered, min(1.2 * strength, 1.0))


def _mantissas(console: Console, strength: float) -> None:
    """Show late sizes as powers of two, or of more: exponents without their mantissas."""
    base = 1 + min(strength, 2.5)
    size = np.clip(np.abs(console.wave), 1e-9, None)
    power = np.floor(np.log(size) / np.log(base))
    _odd(console, base ** (power + 0.5), min(1.4 * strength, 1.0))


def _equalised(console: Console, strength: float) -> None:
    """Show which of seventeen neighbours late sizes would be, as pictures are made clear."""
    size = np.abs(console.wave)
    wide = np.pad(size, ((0, 0), (8, 8)), mode="reflect")
    ranks = sum((wide[:, k : k + WIDE_SAMPLES] < size).astype(np.float64) for k in range(17)) / 16
    late = console.after(FROM)
    usual = np.sqrt((late * size**2).sum(axis=1) / late.sum(axis=1))[:, None]
    _odd(console, 2.0 * usual * ranks, min(1.2 * strength, 1.0))


ON_STAGE: dict[str, Callable[[Console, float], None]] = {
    "obstructed-path": _past_a_stack,
    "specular-reflections": _walls,
    "ground-bounce": _deck,
    "small-scale-fading": _few_rays,
    "diffuse-tail": _tower,
}
IN_CONSOLES: dict[str, Callable[[Console, float], None]] = {
    "pulse-ringing": _stub,
    "noise-floor": _dimmers,
    "narrowband-interference": _intercom,
    "eights-sorted": _eights,
    "mantissas-lost": _mantissas,
    "histogram-equalised": _equalised,
    "quantisation": _words,
    "late-detection": _deaf,
}
WAVES = ON_STAGE | IN_CONSOLES


def go_through(console: Console, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms pass what is on stage, what becomes of rows, and what is in consoles."""
    for name in (one for one in ON_STAGE if one in names):
        ON_STAGE[name](console, strength)
    for name in sorted(one for one in names if one not in WAVES):
        console.bear(EFFECTS[name](console.cue(), strength))
    for name in (one for one in IN_CONSOLES if one in names):
        IN_CONSOLES[name](console, strength)
