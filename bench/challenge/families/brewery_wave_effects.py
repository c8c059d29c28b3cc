"""What the brewery hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.brewery_cellar import BARROWS, LONG_M, WAVE_M, WIDE_M
from bench.challenge.families.brewery_cellar import LAWS as RANGE_LAWS
from bench.challenge.families.brewery_effects import EFFECTS, tile_ray
from bench.challenge.families.brewery_receiver import METRES, TICKS, Tap, rustle
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "time-lag",
)  # fmt: skip
"""Effects that are those of the brewery's tables of ranges."""
ODDITIES = ("canceller-overshoots", "row-before-shines-through", "least-of-three")
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and law.forms != ("unit",)},
    **dict.fromkeys(ODDITIES, Law()),
}
"""What nobody's library has."""
TANKS_M = [(x, y) for x in (5.6, 16.4) for y in (6.0, 13.0, 20.0, 27.0, 33.0)]


def _tanks_and_walls(tap: Tap, strength: float) -> None:
    """Hear tanks, as cylinders spread what they return, and both ends of the cellar."""
    batch, straight = tap.batch(), tap.sound() * tap.early()
    tags, hung = batch.tags(), batch.hung
    for x, y in TANKS_M:
        legs = [np.linalg.norm(end[:, :2] - [x, y], axis=1) for end in (tags, hung)]
        way = np.hypot(legs[0] + legs[1] - 1.6, tags[:, 2] - hung[:, 2])  # of 0.8 m radius
        spread = np.sqrt(0.5 / np.maximum(legs[0] * legs[1] / (legs[0] + legs[1]), 0.5))
        share = 0.8 * np.sqrt(strength) * spread * batch.m / np.maximum(way, 1.0)
        tap.add(np.maximum(way - batch.m, 1.0) / METRES, np.minimum(share, 0.8) * tap.chance(),
                straight)  # fmt: skip
    for wall in (0.0, LONG_M):
        along = np.abs(tags[:, 1] + hung[:, 1] - 2 * wall)
        way = np.sqrt(batch.m**2 - np.square(tags[:, 1] - hung[:, 1]) + along**2)
        share = 0.62 * np.sqrt(strength) * batch.m / way
        tap.add(np.maximum(way - batch.m, 1.0) / METRES, share * tap.chance(), straight)


def _tiles(tap: Tap, strength: float) -> None:
    longer, share = tile_ray(tap.batch(), strength)
    tap.add(longer / METRES, -share * np.exp(-2j * np.pi * longer / WAVE_M), tap.sound())


def _behind_tanks(tap: Tap, strength: float) -> None:
    """Lose, behind tanks, what comes straight: it creeps round one by both sides, then others."""
    batch, sound = tap.batch(), tap.sound()
    tank = batch.links(lambda n: np.where(tap.rng.random(n) < 0.22, 1.0, 0.0))
    tap.leave(1 - 0.981 * tank[:, None] * tap.running() * tap.early())
    first = batch.links(lambda n: tap.rng.triangular(2.0, 3.0, 5.5, n)) * (0.55 + 0.45 * strength)
    other = batch.links(lambda n: tap.rng.uniform(1.6, 3.4, n))
    for k, size in enumerate((0.31, 0.25, 0.22, 0.14)):
        share = tank * size * tap.rng.lognormal(0, 0.2, batch.rows)
        tap.add(first + k * other, share * tap.chance(), sound)


def _flickers(tap: Tap, strength: float) -> None:
    """Fade by inverse Gaussian powers, alike over six samples, by cosines from one to the next."""
    rows, knots = len(tap.table), len(TICKS) // 6 + 3
    power = np.minimum(tap.rng.wald(1.0, 2.2 / strength, (rows, knots)), 5.0)
    gain = np.sqrt(power / power.mean())
    place = (TICKS + tap.rng.uniform(0, 6, (rows, 1))) / 6
    low = place.astype(np.intp)
    blend = 0.5 - 0.5 * np.cos(np.pi * (place - low))
    left, right = np.take_along_axis(gain, low, 1), np.take_along_axis(gain, low + 1, 1)
    tap.leave(1 + tap.running() * ((1 - blend) * left + blend * right - 1))


def _stairs(tap: Tap, strength: float) -> None:
    """Scatter between tanks and walls: less by stairs, one for every time across the cellar."""
    across = WIDE_M / METRES / tap.rng.uniform(3.0, 5.0, (len(tap.table), 1))
    steps = np.floor(np.maximum(tap.past - 3, 0) / across)
    power = 0.022 * strength * 0.48**steps * (tap.past > 3)
    tap.wave = tap.wave + tap.peak()[:, None] * np.sqrt(power / 2) * rustle(tap.rng, len(tap.table))


def _by_a_power(tap: Tap, strength: float) -> None:
    """Ring on as many resonances together do: by a power of the time since, not exponentially."""
    turn, lags = tap.recipe(1).uniform(0.5, 1.1), np.arange(3, 46)
    answer = 0.75 * min(strength, 2.6) * np.exp(1j * turn * lags) / lags**1.25
    spectrum = np.fft.fft(tap.sound(), 256, axis=1)
    filtered = spectrum * np.fft.fft(np.concatenate([np.zeros(3), answer]), 256)
    tap.wave = tap.wave + np.fft.ifft(filtered, axis=1)[:, : len(TICKS)]


def _pumps(tap: Tap, strength: float) -> None:
    tap.roughen(np.asarray(EFFECTS["noise-floor"](tap.batch(), strength).hiss))


def _opener(tap: Tap, strength: float) -> None:
    """Hear a gate's opener, keyed on and off every few samples, some barrows more than others."""
    pitch, beat = tap.recipe(2).uniform([0.08, 7.0], [0.45, 12.0])
    loud = strength * tap.recipe(3).uniform(1.0, 1.7, BARROWS)[tap.batch().barrow]
    on = np.mod(TICKS / beat + tap.rng.random((len(loud), 1)), 1.0) < 0.6
    wave = np.exp(2j * np.pi * pitch * TICKS) * tap.chance()[:, None]
    tap.wave = tap.wave + (loud * tap.sigma)[:, None] * on * wave
    tap.noise = tap.noise * _beside_opener(loud)
    tap.sigma = tap.sigma * np.sqrt(1 + 0.5 * 0.6 * loud**2)


def _beside_opener(loud: Floats) -> Floats:
    """Return how many times more sizes scatter [n] with a carrier in six of ten: by trial."""
    noise = np.random.default_rng(877).normal(size=(20000, 2)) @ np.array([1, 1j])
    tried = np.linspace(0, 8, 41)
    on = np.arange(noise.size) % 10 < 6
    spread = np.array([np.abs(noise + one * on).std() for one in tried])
    return np.asarray(np.interp(loud, tried, spread / spread[0]))


def _canceller(tap: Tap, strength: float) -> None:
    """Take away more of an echo than there is of it: copies of other sign come after all."""
    later = int(tap.recipe(4).integers(11, 17))
    heard = tap.wave * tap.running()  # with its noise: it is taken away behind the receiver
    left = heard.copy()
    for begin in range(later, left.shape[1]):
        left[:, begin] -= min(0.3 * strength, 0.8) * left[:, begin - later]
    tap.wave = tap.wave + (left - heard)


def _shines_through(tap: Tap, strength: float) -> None:
    """Leave, past first paths, some of the row before in a memory that holds two."""
    before = np.roll(tap.wave, 1, axis=0)
    moved = np.rint(np.roll(tap.rise, 1) - tap.rise).astype(np.intp)
    place = np.clip(np.arange(len(TICKS)) + moved[:, None], 0, len(TICKS) - 1)
    again = np.take_along_axis(before, place, axis=1)
    ratio = tap.peak() / np.maximum(np.roll(tap.peak(), 1), 1e-9)
    part = np.minimum(0.4 * strength * np.minimum(ratio, 1.5), 1.2)
    tap.wave = tap.wave + np.where(tap.past > 9, part[:, None] * again, 0)


def _least(tap: Tap, strength: float) -> None:
    """Give, after first paths, the least of three sizes, or of more."""
    size, out = np.abs(tap.wave), np.abs(tap.wave)
    for step in range(1, 2 + int(strength >= 1)):
        out = np.minimum(out, np.minimum(np.roll(size, step, axis=1), np.roll(size, -step, axis=1)))
    part = np.where(tap.past > 6, min(0.9 * strength**0.5, 1.0), 0.0)
    tap.wave = tap.wave * (1 - part + part * out / np.maximum(size, 1e-9))


def _of_squares(tap: Tap, strength: float) -> None:
    """Keep powers in whole steps, and phases as they are: small sizes are coarse, large fine."""
    unit = 0.85 * strength * float(np.median(tap.sigma))
    size = np.abs(tap.wave)
    kept = unit * np.sqrt(np.rint(np.square(size / unit)))
    tap.wave = tap.wave * kept / np.maximum(size, 1e-9)
    draws = np.random.default_rng(878).rayleigh(size=20000)
    tried = np.geomspace(0.05, 8, 50)
    left = [float((x * np.sqrt(np.rint(np.square(draws / x)))).std()) for x in tried]
    by = np.interp(unit / tap.sigma, tried, np.array(left) / draws.std())
    tap.noise = tap.noise * np.maximum(by, 0.03)


def _slow(tap: Tap, strength: float) -> None:
    """Ask more of a first pulse, and time it nearer to its top."""
    tap.slow = 1.0 * strength


WAVES: dict[str, Callable[[Tap, float], None]] = {
    "specular-reflections": _tanks_and_walls,
    "ground-bounce": _tiles,
    "obstructed-path": _behind_tanks,
    "small-scale-fading": _flickers,
    "diffuse-tail": _stairs,
    "pulse-ringing": _by_a_power,
    "noise-floor": _pumps,
    "narrowband-interference": _opener,
    "canceller-overshoots": _canceller,
    "row-before-shines-through": _shines_through,
    "least-of-three": _least,
    "quantisation": _of_squares,
    "late-detection": _slow,
}
"""In the order in which waveforms take them up, but for those of rows: between cellar and radio."""
CELLAR = ("specular-reflections", "ground-bounce", "obstructed-path", "small-scale-fading",
          "diffuse-tail")  # fmt: skip


def pour(tap: Tap, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms take up effects: those of the cellar, those of rows, those of the radio."""
    for name in CELLAR:
        if name in names:
            WAVES[name](tap, strength)
    for name in (one for one in names if one not in WAVES):
        tap.take_up(EFFECTS[name](tap.batch(), strength))
    for name in WAVES:
        if name in names and name not in CELLAR:
            WAVES[name](tap, strength)
