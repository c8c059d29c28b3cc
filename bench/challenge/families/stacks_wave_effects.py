"""What the archive hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.stacks_effects import EFFECTS, floor_ray
from bench.challenge.families.stacks_plan import LAWS as RANGE_LAWS
from bench.challenge.families.stacks_plan import ROOM_M
from bench.challenge.families.stacks_rack import GRID, METRES, Rack, rustle, shifted

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "exchange-motion",
)  # fmt: skip
"""Effects that are those of the archive's tables of ranges."""
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms},
    "record-stretched": Law(),
    "spurs-in-memory": Law(),
    "not-cleared-before": Law(),
}
"""What nobody's library has."""
PLASTER = 4.6 - 0.25j  # permittivity of walls and of the ceiling


def _walls(rack: Rack, strength: float) -> None:
    """Hear the four walls and the ceiling by their images, as Fresnel has it for plaster."""
    files, heard = rack.files(), rack.heard() * rack.early()
    here, there = files.walkers(), files.hung()
    for axis, wall in ((0, 0.0), (0, ROOM_M[0]), (1, 0.0), (1, ROOM_M[1]), (2, ROOM_M[2])):
        image = here.copy()
        image[:, axis] = 2 * wall - image[:, axis]
        way = np.linalg.norm(image - there, axis=1)
        cosine = np.abs(image - there)[:, axis] / way
        root = np.sqrt(PLASTER - 1 + cosine**2)
        back = np.abs((cosine - root) / (cosine + root)) * files.far() / way
        size = min(1.3 * strength**0.5, 1.8) * back * files.linkwise(_unshelved(rack))
        echo = (np.minimum(size, 0.95) * rack.turn())[:, None]
        rack.wave = rack.wave + echo * shifted(heard, (way - files.far()) / METRES)


def _unshelved(rack: Rack) -> Callable[[int], Floats]:
    """Return a maker of what shelves leave of a wall: nothing, half, or all."""
    return lambda n: rack.rng.choice([0.0, 0.5, 1.0, 1.0], n)


def _floor(rack: Rack, strength: float) -> None:
    longer, ray = floor_ray(rack.files(), strength)
    rack.wave = rack.wave + ray[:, None] * shifted(rack.heard(), longer / METRES)


def _shut_shelves(rack: Rack, strength: float) -> None:
    """Lose, where shelves are shut, what comes straight: over their tops it comes spread out."""
    files, heard = rack.files(), rack.heard()
    shut = files.linkwise(lambda n: 1.0 * (rack.rng.random(n) < 0.23))
    late = files.linkwise(lambda n: rack.rng.uniform(2.2, 6.5, n)) * (0.55 + 0.45 * strength)
    rack.dim(1 - 0.98 * shut[:, None] * rack.begun() * rack.early())
    for k in range(7):
        part = 0.27 * np.exp(-0.22 * k) * shut * rack.rng.weibull(2.2, len(late)) * rack.turn()
        rack.wave = rack.wave + part[:, None] * shifted(heard, late + 1.5 * k)


def _shadowed(rack: Rack, strength: float) -> None:
    """Fade by a log-normal law, samples near each other alike, each row by its own draw."""
    loose = rack.rng.normal(size=(len(rack.table), len(GRID) + 8))
    kernel = np.exp(-0.5 * np.square(np.arange(-4, 5) / 1.9))
    kernel = kernel / np.sqrt(np.square(kernel).sum())
    smooth = sum(k * loose[:, i : i + len(GRID)] for i, k in enumerate(kernel))
    spread = 0.2 * np.sqrt(strength)
    gain = np.exp(spread * np.asarray(smooth) - spread**2)
    rack.dim(1 - rack.begun() * (1 - np.minimum(gain, 3.0)))


def _between_shelves(rack: Rack, strength: float) -> None:
    """Reverberate between shelves: two slopes of decay, with gaps where nothing comes."""
    since = np.maximum(rack.delay - 3.0, 0)
    power = 0.05 * np.exp(-since / 7) + 0.012 * np.exp(-since / 42)
    open_ = rack.rng.random((len(power), len(GRID) // 5 + 1)).repeat(5, axis=1)[:, : len(GRID)]
    rough = np.sqrt(strength * power * (open_ < 0.7) * (since > 0) / 2)
    rack.wave = rack.wave + (rack.size()[:, None] * rough) * rustle(rack.rng, len(power))


def _cavity(rack: Rack, strength: float) -> None:
    """Ring in a cavity behind the antenna: a burst that begins late and ends by a bell."""
    pitch = rack.bound(1).uniform(0.25, 0.6)
    lags = np.arange(4, 40)
    burst = 0.1 * min(strength, 2.4) * np.exp(-np.square((lags - 10) / 13.0) + 1j * pitch * lags)
    size = 2 * len(GRID)
    taps = np.zeros(size, np.complex128)
    taps[lags] = burst / 1.6
    rung = np.fft.ifft(np.fft.fft(rack.heard(), size, axis=1) * np.fft.fft(taps))
    rack.wave = rack.wave + rung[:, : len(GRID)]


def _dimmers(rack: Rack, strength: float) -> None:
    entered = EFFECTS["noise-floor"](rack.files(), strength)
    rack.raise_noise(np.asarray(entered.hiss))


def _two_tones(rack: Rack, strength: float) -> None:
    """Hear two carriers next to each other, which beat; each row at its own moment."""
    pitch, gap = rack.bound(2).uniform([-0.4, 0.12], [0.4, 0.18])
    loud = 1.15 * strength * rack.bound(3).uniform(0.6, 1.4, 7)[rack.files().reader()]
    tones = [rack.turn()[:, None] * np.exp(2j * np.pi * one * GRID) for one in (pitch, pitch + gap)]
    rack.wave = rack.wave + (loud * rack.sigma)[:, None] * (tones[0] + 0.7 * tones[1])
    rack.noise_gain = rack.noise_gain * _beating(loud)
    rack.sigma = rack.sigma * np.sqrt(1 + loud**2 * 1.49 / 2)


def _beating(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside two such carriers [n], by trial."""
    rng = np.random.default_rng(795)
    noise = rng.normal(size=(2, 10000))
    beat = 1 + 0.7 * np.exp(2j * np.pi * rng.random(10000))
    tried = np.linspace(0, 9, 46)
    spread = [float(np.abs(noise[0] + 1j * noise[1] + one * beat).std()) for one in tried]
    return np.asarray(np.interp(loud, tried, spread) / spread[0])


def _coarse(rack: Rack, strength: float) -> None:
    """Keep sizes to a step and phases as they are, as a logger does that stores both."""
    step = 1.1 * strength * rack.sigma[:, None]
    size = np.abs(rack.wave)
    rack.wave = rack.wave / np.maximum(size, 1e-9) * step * np.round(size / step)
    noise = np.abs(np.random.default_rng(796).normal(size=(10000, 2)) @ [1, 1j])
    kept = (1.1 * strength * np.round(noise / (1.1 * strength))).std() / noise.std()
    rack.noise_gain = rack.noise_gain * max(float(kept), 0.03)


def _deafer(rack: Rack, strength: float) -> None:
    """Listen for louder first paths alone, and time them by more of their rise."""
    rack.deaf = 0.9 * strength


def _stretched(rack: Rack, strength: float) -> None:
    """Read records with a clock that is slow, from the first path on: all after it is nearer."""
    rate = 1 + 0.4 * min(strength, 2.5)
    read = np.where(rack.delay > 3, rack.knock[:, None] + 3 + rate * (rack.delay - 3), GRID)
    low = np.clip(np.floor(read), 0, len(GRID) - 2).astype(np.intp)
    part = np.clip(read - low, 0, 1)
    near, next_ = (np.take_along_axis(rack.wave, low + k, axis=1) for k in (0, 1))
    mixed = near * (1 - part) + next_ * part
    lost = np.sqrt(1 - part**2 - (1 - part) ** 2) * rack.sigma[:, None]
    rack.wave = mixed + lost * rustle(rack.rng, len(part))


def _spurs(rack: Rack, strength: float) -> None:
    """Find spurs in every record, so many samples apart wherever the first path is."""
    period = int(rack.bound(4).integers(7, 13))
    phase = rack.rng.integers(0, period, len(rack.table))[:, None]
    struck = np.mod(GRID + phase, period) == 0
    loud = 11.0 * strength * rack.sigma[:, None] * (GRID > 30)
    rack.wave = rack.wave + np.where(struck, loud, 0) * rack.turn()[:, None]


def _not_cleared(rack: Rack, strength: float) -> None:
    """Add up in a memory that still holds some of the row before, at the same places."""
    share = 0.9 * min(strength, 2.5) ** 0.5 * rack.rng.uniform(0.7, 1.0, len(rack.table))
    held = np.roll(rack.wave, 1, axis=0)
    gain = rack.size() / np.maximum(np.roll(rack.size(), 1), 1e-9)
    rest = np.where(rack.delay > 4, held, 0) * (share * np.minimum(gain, 1.0))[:, None]
    rack.wave = rack.wave + rest * rack.turn()[:, None]


WAVES: dict[str, Callable[[Rack, float], None]] = {
    "specular-reflections": _walls,
    "ground-bounce": _floor,
    "obstructed-path": _shut_shelves,
    "small-scale-fading": _shadowed,
    "diffuse-tail": _between_shelves,
    "pulse-ringing": _cavity,
    "noise-floor": _dimmers,
    "narrowband-interference": _two_tones,
    "record-stretched": _stretched,
    "not-cleared-before": _not_cleared,
    "spurs-in-memory": _spurs,
    "quantisation": _coarse,
    "late-detection": _deafer,
}
INSIDE = 5  # of these, from the ringing on, are of the radio: what rows have comes before


def put_through(rack: Rack, names: tuple[str, ...], strength: float) -> None:
    """Put waveforms through effects: those of the archive, of rows, of the radio."""
    order = [*WAVES]
    place = {name: order.index(name) if name in WAVES else INSIDE - 0.5 for name in names}
    for name in sorted(names, key=lambda one: place[one]):
        if name in WAVES:
            WAVES[name](rack, strength)
        else:
            rack.enter(EFFECTS[name](rack.files(), strength))
