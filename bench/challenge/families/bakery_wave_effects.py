"""What the bakery hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.bakery_effects import EFFECTS, tile_ray
from bench.challenge.families.bakery_house import HOODS_M, HOUSE_M
from bench.challenge.families.bakery_house import LAWS as RANGE_LAWS
from bench.challenge.families.bakery_tuner import METRES, TICK, Tuned, hum
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the bakery's tables of ranges."""
ODDITIES = ("memory-leaks", "late-part-levelled", "squelch-closes")
LAWS = {name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms}
LAWS |= {name: Law() for name in ODDITIES}
"""What nobody's library has."""
FACES = ((0, 0.0, 0.82), (0, HOUSE_M[0], 0.4), (1, 0.0, 0.5), (1, HOUSE_M[1], 0.5),
         (2, HOUSE_M[2], 0.3))  # fmt: skip
"""Fronts of ovens, tiles of three walls, a ceiling of boards: axis, place in m, share returned."""


def _faces(tuned: Tuned, strength: float) -> None:
    """Hear images in walls and ceiling, and in corners of ovens and walls by two of them."""
    sheet, straight = tuned.sheet(), tuned.signal() * tuned.first()
    corners = [(FACES[0], FACES[2]), (FACES[0], FACES[3]), (FACES[0], FACES[4])]
    for faces in (*((one,) for one in FACES), *corners):
        image, share = sheet.tags(), strength**0.5 * np.ones(tuned.rows)
        for axis, plane, returned in faces:
            image[:, axis] = 2 * plane - image[:, axis]
            bare = sheet.of_links(lambda n: tuned.rng.uniform(0.5, 1.15, n))  # racks stand before
            share = share * returned * bare
        way = np.linalg.norm(image - sheet.hooks(), axis=1)
        share = np.minimum(share * sheet.far / way, 0.85) * tuned.spun()
        tuned.echo(share, np.maximum(way - sheet.far, 1.0) / METRES, straight)


def _tiles(tuned: Tuned, strength: float) -> None:
    longer, share = tile_ray(tuned.sheet(), strength)
    tuned.echo(share, longer / METRES, tuned.signal())


def _behind_racks(tuned: Tuned, strength: float) -> None:
    """Lose, behind racks full of loaves, what comes straight: it comes by ceiling and ovens."""
    sheet, signal = tuned.sheet(), tuned.signal()
    full = sheet.of_links(lambda n: (tuned.rng.random(n) < 0.22) * 1.0)
    tuned.damp(1 - 0.983 * full[:, None] * tuned.begun() * tuned.first())
    late = sheet.of_links(lambda n: tuned.rng.uniform(2.2, 4.4, n)) * (0.5 + 0.5 * strength)
    for share in 0.36 * 0.8 ** np.arange(5):
        size = full * share * tuned.rng.uniform(0.8, 1.2, tuned.rows)
        tuned.echo(size * tuned.spun(), late, signal)
        late = late + sheet.of_links(lambda n: 1.2 + tuned.rng.exponential(1.6, n))


def _nakagami(tuned: Tuned, strength: float) -> None:
    """Fade by Nakagami's sizes, whose powers are gamma: alike in six samples, straight between."""
    knots, shape = len(TICK) // 6 + 3, 0.5 + 2.6 / strength
    power = tuned.rng.gamma(shape, 1 / shape, (tuned.rows, knots))
    place = (TICK + 6 * tuned.rng.random((tuned.rows, 1))) / 6
    left = np.floor(place).astype(np.intp)
    near, next_ = (np.take_along_axis(power, left + k, axis=1) for k in (0, 1))
    size = np.sqrt(near + (place - left) * (next_ - near))
    size = np.clip(size / np.sqrt(np.mean(size**2)), 0.08, None)
    tuned.damp(1 + tuned.begun() * (size - 1))


def _builds_up(tuned: Tuned, strength: float) -> None:
    """Ring on among steel: a fast build-up and a slow decay, the difference of exponentials."""
    past = np.maximum(tuned.past - 3.0, 0)
    power = 0.026 * strength * (np.exp(-past / 33.0) - np.exp(-past / 3.5))
    rough = hum(tuned.rng, tuned.rows) * np.sqrt(power / 2)
    tuned.wave = tuned.wave + tuned.crest()[:, None] * rough


def _resonates(tuned: Tuned, strength: float) -> None:
    """Ring as a patch antenna with flour on it does: a resonator, fed three samples late."""
    turn = np.exp(1j * tuned.constant(1).uniform(0.3, 0.9))
    fed, ring = tuned.signal(), np.zeros(tuned.wave.shape, np.complex128)
    for k in range(3, len(TICK)):
        ring[:, k] = 0.87 * turn * ring[:, k - 1] + 0.14 * min(strength, 2.6) * fed[:, k - 3]
    tuned.wave = tuned.wave + ring


def _igniters(tuned: Tuned, strength: float) -> None:
    tuned.noisier(np.asarray(EFFECTS["noise-floor"](tuned.sheet(), strength).hiss))


def _microwave(tuned: Tuned, strength: float) -> None:
    """Hear a harmonic of an oven's magnetron, which is on for six tenths of the mains' time."""
    pitch = tuned.constant(2).uniform(-0.4, 0.4)
    near = 12.0 / (12.0 + np.abs(HOODS_M[:, 1] - tuned.constant(3).uniform(5, 33)))
    on = tuned.rng.random(tuned.rows) < 0.6
    size = 2.3 * strength * near[tuned.sheet().hood] * on
    tone = np.exp(2j * np.pi * pitch * TICK) * tuned.spun()[:, None]
    tuned.wave = tuned.wave + (size * tuned.sigma)[:, None] * tone
    tuned.hissing = tuned.hissing * _beside(size)
    tuned.sigma = tuned.sigma * np.sqrt(1 + size**2 / 2)


def _beside(size: Floats) -> Floats:
    """Return how many times more sizes scatter beside a tone of such size [n]: by trial."""
    rng = np.random.default_rng(926)
    noise = rng.normal(size=18000) + 1j * rng.normal(size=18000)
    tried = np.linspace(0.0, 6.0, 31)
    spread = np.std(np.abs(noise + tried[:, None]), axis=1)
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _leaks(tuned: Tuned, strength: float) -> None:
    """Keep samples on capacitors that leak while they wait: the later, the more noise in them."""
    waited = np.clip((tuned.past - 8.0) / 60.0, 0, 1.6)
    tuned.dither(1.6 * strength * tuned.sigma[:, None] * np.sqrt(waited))


def _levelled(tuned: Tuned, strength: float) -> None:
    """Scale late parts toward one size beside first paths, as a block of exponents does."""
    late = tuned.ramp(9.0, 12.0)
    size = np.sqrt(np.sum(late * np.abs(tuned.wave) ** 2, axis=1) / np.sum(late, axis=1))
    aim = 0.09 * np.maximum(tuned.crest(), 1e-9)
    gain = (aim / np.maximum(size, 1e-9)) ** min(0.4 * strength, 1.0)
    tuned.wave = tuned.wave * (1 + late * (np.clip(gain, 0.2, 5.0) - 1)[:, None])


def _squelch(tuned: Tuned, strength: float) -> None:
    """Close a squelch behind the last echo above a level: what comes afterwards is damped."""
    loud = np.abs(tuned.wave) >= 0.16 * tuned.crest()[:, None]
    last = np.where(loud, TICK, 0.0).max(axis=1)
    closed = np.clip((TICK - np.maximum(last, tuned.front + 8)[:, None] - 4) / 3, 0, 1)
    tuned.wave = tuned.wave * (1 - min(0.45 * strength, 0.9) * closed)


def _mid_rise(tuned: Tuned, strength: float) -> None:
    """Keep the middles of steps, none of which is zero, of both components."""
    step = 1.4 * strength * float(np.median(tuned.sigma))
    real, imaginary = (_middles(x, step) for x in (tuned.wave.real, tuned.wave.imag))
    tuned.wave = real + 1j * imaginary
    noise = np.random.default_rng(927).normal(size=(2, 18000))
    tried = np.geomspace(0.05, 5.0, 50)
    spread = np.array([np.hypot(*_middles(noise, one)).std() for one in tried])
    by = np.interp(step / tuned.sigma, tried, spread / np.hypot(*noise).std())
    tuned.hissing = tuned.hissing * np.maximum(by, 0.05)


def _middles(values: Floats, step: float) -> Floats:
    return np.asarray(step * (np.floor(values / step) + 0.5))


def _deaf(tuned: Tuned, strength: float) -> None:
    """Ask more of a first path, and tell it nearer to its top."""
    tuned.deaf = 0.95 * strength


HOUSE = ("specular-reflections", "ground-bounce", "obstructed-path", "small-scale-fading",
         "diffuse-tail")  # fmt: skip
WAVES: dict[str, Callable[[Tuned, float], None]] = {
    "specular-reflections": _faces,
    "ground-bounce": _tiles,
    "obstructed-path": _behind_racks,
    "small-scale-fading": _nakagami,
    "diffuse-tail": _builds_up,
    "pulse-ringing": _resonates,
    "noise-floor": _igniters,
    "narrowband-interference": _microwave,
    "memory-leaks": _leaks,
    "late-part-levelled": _levelled,
    "squelch-closes": _squelch,
    "quantisation": _mid_rise,
    "late-detection": _deaf,
}


def happen(tuned: Tuned, names: tuple[str, ...], strength: float) -> None:
    """Let effects happen to waveforms: those of the house, those of rows, those of the radio."""
    rows = tuple(name for name in names if name not in WAVES)
    radio = tuple(name for name in WAVES if name not in HOUSE)
    for name in (*HOUSE, *rows, *radio):
        if name in rows:
            tuned.bake(EFFECTS[name](tuned.sheet(), strength))
        elif name in names:
            WAVES[name](tuned, strength)
