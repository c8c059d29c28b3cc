"""What the bowls green hides in waveforms: effects in forms of its own, oddities of its dials.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.bowls_dial import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Dial,
    rush,
)
from bench.challenge.families.bowls_effects import EFFECTS, off_the_carpet
from bench.challenge.families.bowls_rinks import GREEN_M, KNOTS, WAVE_M, End
from bench.challenge.families.bowls_rinks import LAWS as LAWS_OF_ROWS
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the green's tables of ranges."""
ODD = ("late-part-read-slowly", "windows-never-overlapped", "only-summits-kept")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "fathoms-from-one-knot"}
LAWS |= {name: Law() for name in ODD}
"""What nobody's library has."""
FROM = 10.0  # samples past first paths from which dials are odd
WET, GAP_M, FILM_M = 77.0, 0.31, (0.0001, 0.0006)  # permittivity; between films; of water on them
SHEETS: tuple[tuple[int, float, float], ...] = (
    (0, -0.4, 9.0), (0, GREEN_M[0] + 0.4, 9.0), (1, 0.6, 1.9), (1, GREEN_M[1] - 0.6, 1.9),
)  # fmt: skip
"""Both ends' films and both banks' hoardings: axis, where, and how high these are, in m."""
GALLERY_M, BOUNCES = 11.0, 9  # how round the skin is; of what runs along it
ENDS = 92.0  # samples after which nothing is left of tails
RING, BELL = 26, 9.0  # samples that screws ring; until they are a bell's width less
LINES, WIDTH = 14, 0.09  # of a phone's band; radians a sample to either end of it
WINDOW = 5  # samples in which noise is read
TURNS = 16  # angles that are kept
FRAME = 16  # samples of a window
TRIED: Complexes = rush(np.random.default_rng(2408), 140)  # noise to try readings on


def film(straight: Floats, thick: Floats) -> Floats:
    """Return what films of water return of waves that come so straight [n], in size."""
    bends = np.pi * thick * (WET - 1) / (WAVE_M * straight.clip(0.05))
    return np.asarray(bends / np.hypot(1.0, bends))


def mirrored(end: End, axis: int, plane_m: float) -> tuple[Floats, Floats, Floats]:
    """Return ways by an upright plane in m, how high these meet it, and how straight, [n] each."""
    image = end.aloft.copy()
    image[:, axis] = 2 * plane_m - image[:, axis]
    way = np.linalg.norm(image - end.below, axis=1)
    legs = [np.abs(one[:, axis] - plane_m) for one in (end.below, end.aloft)]
    both = legs[0] + legs[1]
    return way, (end.below[:, 2] * legs[1] + end.aloft[:, 2] * legs[0]) / both, both / way


def _sheets(dial: Dial, strength: float) -> None:
    """Hear both ends, of two wet films each, and boards along the banks where these reach."""
    end, first = dial.end(), dial.by_air() * dial.straight()
    for axis, plane_m, high_m in SHEETS:
        way, high, straight = mirrored(end, axis, plane_m)
        thick = end.by_link(lambda n: dial.rng.uniform(*FILM_M, n))
        free = end.by_link(lambda n: dial.rng.triangular(0.3, 0.9, 1.0, n))
        back = film(straight, thick) * free * (high < high_m)
        share = (1.35 * np.sqrt(strength) * back * end.far / way).clip(max=0.8)
        samples = ((way - end.far) / METRES).clip(2.8)
        dial.echo(first, share * dial.turns(), samples)
        if axis == 0:
            dial.echo(first, 0.5 * share * dial.turns(), samples + 2 * GAP_M * straight / METRES)


def _carpet(dial: Dial, strength: float) -> None:
    longer, share = off_the_carpet(dial.end(), strength)
    dial.echo(dial.by_air(), share, longer / METRES)


def chords_m(arc: Floats, bounces: int) -> Floats:
    """Return how long ways along a round skin are, of so many chords in all, in m [n]."""
    return np.asarray(2 * bounces * GALLERY_M * np.sin(0.5 * arc / bounces))


def _gallery(dial: Dial, strength: float) -> None:
    """Lose what comes straight behind things: the rest runs along the skin (Rayleigh 1910).

    The more chords a way has, the nearer it is to the arc: what comes crowds towards an end.
    """
    end, air = dial.end(), dial.by_air()
    hidden = end.struck(0.2)
    dial.lose(-36.0 * hidden[:, None] * dial.straight())
    arc = end.by_link(lambda n: dial.rng.triangular(1.3, 1.6, 2.6, n))
    for bounces in range(2, BOUNCES):
        late = (chords_m(arc, bounces) - chords_m(arc, 1)) / METRES
        size = 0.4 * hidden * 0.93**bounces * dial.rng.uniform(0.5, 1.2, dial.rows)
        dial.echo(air, size * dial.turns(), 1.6 + late * (0.35 + 0.65 * strength**0.7))


def _drifting(dial: Dial, samples: float) -> Floats:
    """Return two parts of chance [2, n, k], alike for some samples."""
    loose = np.fft.rfft(dial.rng.standard_normal((2, dial.rows, WIDE_SAMPLES)), axis=2)
    shape = np.exp(-((np.fft.rfftfreq(WIDE_SAMPLES) * 2.2 * samples) ** 2))
    made = np.fft.irfft(loose * shape, WIDE_SAMPLES, axis=2)
    return np.asarray(made / made.std(axis=(1, 2), keepdims=True))


def _beckmann(dial: Dial, strength: float) -> None:
    """Fade by two parts that are unlike in both mean and scatter (Beckmann 1962)."""
    part = min(0.3 * strength**0.7, 0.62)
    loose = _drifting(dial, 4.5)
    real = np.sqrt(0.8 * (1 - part)) + np.sqrt(1.5 * part) * loose[0]
    other = np.sqrt(0.2 * (1 - part)) + np.sqrt(0.5 * part) * loose[1]
    by = np.hypot(real, other)
    dial.wave = dial.wave + dial.by_air() * (by / np.sqrt((by**2).mean()) - 1)


def _to_an_end(dial: Dial, strength: float) -> None:
    """Reverberate below the skin until all ways are at an end: by a cube of what is left."""
    left = (1 - dial.since.clip(0.0) / ENDS).clip(0.0)
    power = 0.058 * left**3 * dial.past(2.6, 3.0)
    dial.add_noise(np.sqrt(0.5 * strength * power) * dial.heights()[:, None])


def _screws(dial: Dial, strength: float) -> None:
    """Ring as many screws of unlike length do, which fall out of step: by a bell."""
    pitch, turn = dial.shared(1).uniform((0.5, 0.0), (1.7, 2 * np.pi))
    air, wave = dial.by_air(), dial.wave.copy()
    for lag in range(2, RING):
        part = 0.17 * min(strength, 2.4) ** 0.8 * np.exp(-0.5 * (lag / BELL) ** 2)
        wave[:, lag:] += part * np.exp(1j * (turn - pitch * lag)) * air[:, :-lag]
    dial.wave = wave


def _blower(dial: Dial, strength: float) -> None:
    dial.be_noisy(np.zeros(dial.rows) + EFFECTS["noise-floor"](dial.end(), strength).noise_db)


def read_noise(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter within windows of WINDOW, as dials tell of noise."""
    whole = sizes.shape[1] - sizes.shape[1] % WINDOW
    parts = sizes[:, :whole].reshape(-1, WINDOW)
    return float(np.sqrt(parts.var(axis=1).mean()))


def _tell(dial: Dial, of: Floats, tried: Floats, made: list[Floats]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([read_noise(one) for one in made]) / read_noise(np.abs(TRIED))
    dial.told_noise = dial.told_noise * np.interp(of, tried, by).clip(0.04)


def _phones(dial: Dial, strength: float) -> None:
    """Hear phones in band n77, which lies across channel 4: lines of chance, close together."""
    drawn = dial.shared(2)
    middle = drawn.uniform(-1.3, 1.3)
    near = np.exp(drawn.normal(-0.06, 0.35, KNOTS))[dial.end().knot]
    pitch = middle + np.linspace(-WIDTH, WIDTH, LINES)
    data = np.exp(0.5j * np.pi * dial.rng.integers(4, size=(dial.rows, LINES)))
    lines = data @ np.exp(1j * pitch[:, None] * PLACES) / np.sqrt(LINES)
    size = 1.5 * strength * near
    dial.wave = dial.wave + (dial.sigma * size)[:, None] * lines
    tried, some = np.linspace(0.0, 16.0, 49), np.resize(lines, TRIED.shape)
    _tell(dial, size, tried, [np.abs(TRIED + one * some) for one in tried])
    dial.sigma = dial.sigma * np.sqrt(1 + 0.5 * size**2)


def in_polar_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms whose sizes are in whole steps, at one of TURNS angles."""
    angle = np.rint(np.angle(waves) * TURNS / (2 * np.pi)) * 2 * np.pi / TURNS
    return np.asarray(step * np.rint(np.abs(waves) / step) * np.exp(1j * angle))


def _in_polar_steps(dial: Dial, strength: float) -> None:
    """Keep sizes in whole steps, and coarse angles."""
    step = 1.4 * strength * float(np.median(dial.sigma))
    dial.wave = in_polar_steps(dial.wave, step)
    tried = np.geomspace(0.04, 11.0, 60)
    made = [np.abs(in_polar_steps(TRIED, float(one))) for one in tried]
    _tell(dial, step / dial.sigma, tried, made)


def _deaf(dial: Dial, strength: float) -> None:
    """Ask more of first bends, as where a lift's motor was once in the way."""
    dial.deaf = strength


def _replaced(dial: Dial, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    by = sizes / np.abs(dial.wave).clip(1e-9)
    dial.wave = dial.wave * (1 + min(part, 1.0) * dial.past(FROM) * (by - 1))


def slowed(sizes: Floats, begins: Floats, pace: float) -> Floats:
    """Return sizes read from `begins` [n] on at a slower pace, by lines in between [n, k] both."""
    since = np.arange(sizes.shape[1]) - begins[:, None]
    at = begins[:, None] + np.where(since < 0, since, pace * since)
    low = np.floor(at).astype(np.int64).clip(0, sizes.shape[1] - 2)
    part = at - low
    left, right = (np.take_along_axis(sizes, low + k, axis=1) for k in (0, 1))
    return np.asarray((1 - part) * left + part * right)


def _slowed(dial: Dial, strength: float) -> None:
    """Read late sizes more slowly than they were written, so that all comes later than it did."""
    pace = 1 / (1 + 0.8 * min(strength, 2.0))
    _replaced(dial, slowed(np.abs(dial.wave), dial.at + FROM, pace), 1.0)


def windowed(sizes: Floats) -> Floats:
    """Return sizes times windows of FRAME (Hann), one after another, of mean power 1 [n, k]."""
    part = (np.arange(sizes.shape[1]) % FRAME + 0.5) / FRAME
    return np.asarray(sizes * np.sqrt(8 / 3) * np.sin(np.pi * part) ** 2)


def _windowed(dial: Dial, strength: float) -> None:
    """Leave late sizes in windows of a spectrum's, which were never laid over one another."""
    _replaced(dial, windowed(np.abs(dial.wave)), 0.75 * strength)


def summits(sizes: Floats) -> Floats:
    """Return sizes that are larger than both beside them, and a tenth of all others [n, k]."""
    top = (sizes > np.roll(sizes, 1, axis=1)) & (sizes >= np.roll(sizes, -1, axis=1))
    return np.where(top, sizes, 0.1 * sizes)


def _summits(dial: Dial, strength: float) -> None:
    """Keep summits of late sizes alone, as lists of echoes do."""
    _replaced(dial, summits(np.abs(dial.wave)), 0.8 * strength)


BELOW_THE_SKIN: dict[str, Callable[[Dial, float], None]] = {
    "obstructed-path": _gallery,
    "specular-reflections": _sheets,
    "ground-bounce": _carpet,
    "small-scale-fading": _beckmann,
    "diffuse-tail": _to_an_end,
}
IN_DIALS: dict[str, Callable[[Dial, float], None]] = {
    "pulse-ringing": _screws,
    "noise-floor": _blower,
    "narrowband-interference": _phones,
    "late-part-read-slowly": _slowed,
    "windows-never-overlapped": _windowed,
    "only-summits-kept": _summits,
    "quantisation": _in_polar_steps,
    "late-detection": _deaf,
}
WAVES = BELOW_THE_SKIN | IN_DIALS


def hide(dial: Dial, names: tuple[str, ...], strength: float) -> None:
    """Hide in waveforms what is below the skin, what becomes of rows, and what dials do."""
    for name in (one for one in BELOW_THE_SKIN if one in names):
        BELOW_THE_SKIN[name](dial, strength)
    for name in sorted({*names} - {*WAVES}):
        dial.take(EFFECTS[name](dial.end(), strength))
    for name in (one for one in IN_DIALS if one in names):
        IN_DIALS[name](dial, strength)
