"""What the glasshouse hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.glasshouse_effects import EFFECTS, foil_ray, turns
from bench.challenge.families.glasshouse_house import GUTTERS_M, HOUSE_M
from bench.challenge.families.glasshouse_house import LAWS as RANGE_LAWS
from bench.challenge.families.glasshouse_pane import AXIS, METRES, Pane, delayed, murmur

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "exchange-motion",
)  # fmt: skip
"""Effects that are those of the glasshouse's tables of ranges."""
ODD = ("envelope-held", "samples-in-wrong-pairs", "weak-samples-dropped")
LAWS = dict.fromkeys(ODD, Law()) | {
    name: law for name, law in RANGE_LAWS.items() if law.forms and law.forms != ("unit",)
}
"""What nobody's library has."""
WET_GLASS = 2.9  # index of refraction at which a wet pane returns what it does


def _panes(pane: Pane, strength: float) -> None:
    """Hear the end walls, the side walls and a valley of the roof, each by an image."""
    crop, heard = pane.crop(), pane.signal() * pane.front()
    tags, hooks = crop.tags(), crop.hooks()
    for axis, plane in ((0, 0.0), (0, HOUSE_M[0]), (1, 0.0), (1, HOUSE_M[1]), (2, HOUSE_M[2])):
        other = tags.copy()
        other[:, axis] = 2 * plane - tags[:, axis]
        far = np.linalg.norm(other - hooks, axis=1)
        upright = np.abs(other - hooks)[:, axis] / far
        part = (WET_GLASS - upright) / (WET_GLASS + upright) * crop.way_m / far
        open_ = crop.per_link(lambda n: pane.rng.choice([0.25, 0.8, 1.0], n))  # vents stand open
        share = np.minimum(0.95 * strength**0.5 * open_ * part, 0.9)
        pane.now = pane.now + (share * pane.phase())[:, None] * delayed(
            heard, (far - crop.way_m) / METRES
        )


def _foil(pane: Pane, strength: float) -> None:
    longer, share = foil_ray(pane.crop(), strength)
    ray = share * turns(longer)
    pane.now = pane.now + ray[:, None] * delayed(pane.signal(), longer / METRES)


def _behind_tanks(pane: Pane, strength: float) -> None:
    """Lose, behind tanks of water, what comes straight: it comes round them by both sides."""
    crop, heard = pane.crop(), pane.signal()
    tank = crop.per_link(lambda n: np.where(pane.rng.random(n) < 0.2, 1.0, 0.0))
    first = crop.per_link(lambda n: pane.rng.uniform(2.5, 5.0, n)) * (0.6 + 0.4 * strength)
    apart = crop.per_link(lambda n: pane.rng.uniform(2.2, 6.0, n))
    pane.shade(1 - 0.985 * tank[:, None] * pane.on() * pane.front())
    for late, size in ((first, 0.34), (first + apart, 0.3), (first + 2.3 * apart, 0.16)):
        share = tank * size * pane.rng.gamma(6.0, 1 / 6.0, len(tank))
        pane.now = pane.now + (share * pane.phase())[:, None] * delayed(heard, late)


def _leaves_sway(pane: Pane, strength: float) -> None:
    """Fade by Weibull's law, as ways through leaves do: four samples alike, then others."""
    shape = 1.6 + 4.5 / max(strength, 0.15)
    groups = pane.rng.weibull(shape, (len(pane.table), len(AXIS) // 4 + 2))
    groups = np.minimum(groups / np.sqrt(np.mean(groups**2)), 2.5)
    place = (AXIS + pane.rng.uniform(0, 4, len(groups))[:, None]) / 4
    low = place.astype(np.intp)
    blend = np.square(np.sin(np.pi / 2 * (place - low)))
    left, right = (np.take_along_axis(groups, low + k, axis=1) for k in (0, 1))
    pane.shade(1 + pane.on() * (left + blend * (right - left) - 1))


def _leaf_clutter(pane: Pane, strength: float) -> None:
    """Scatter off leaves all about: a stretched exponential, as its sizes are of many kinds."""
    since = np.maximum(pane.since - 3, 0)
    power = 0.065 * strength * np.exp(-np.sqrt(since / 4.5)) * (since > 0)
    sizes = pane.summit()[:, None] * np.sqrt(power / 2)
    pane.now = pane.now + sizes * murmur(pane.rng, len(since))


def _open_stub(pane: Pane, strength: float) -> None:
    """Ring in a length of cable with two bad ends: again and again after as many samples."""
    round_trip = int(pane.sown(1).integers(5, 9))
    back = min(0.26 * strength**0.7, 0.6) * np.exp(1j * pane.sown(2).uniform(-np.pi, np.pi))
    rung = pane.signal()
    for begin in range(round_trip, rung.shape[1]):
        rung[:, begin] += back * rung[:, begin - round_trip]
    pane.now = pane.now + rung - pane.signal()


def _lamp_drivers(pane: Pane, strength: float) -> None:
    pane.louder_noise(np.asarray(EFFECTS["noise-floor"](pane.crop(), strength).hiss))


def _swinging_carrier(pane: Pane, strength: float) -> None:
    """Hear a carrier of a driver that swings in size as its lamp does, some gutters more."""
    pitch, slow = pane.sown(3).uniform(0.1, 0.42), pane.sown(4).uniform(0.11, 0.19)
    loud = strength * pane.sown(5).uniform(0.8, 1.7, len(GUTTERS_M))[pane.crop().device("rx")]
    swing = 1 + 0.45 * np.cos(2 * np.pi * (slow * AXIS + pane.rng.random((len(loud), 1))))
    wave = swing * np.exp(2j * np.pi * pitch * AXIS) * pane.phase()[:, None]
    pane.now = pane.now + (loud * pane.sigma)[:, None] * wave
    pane.noise_by = pane.noise_by * _beside(loud)
    pane.sigma = pane.sigma * np.sqrt(1 + 0.5 * (1 + 0.45**2 / 2) * loud**2)


def _beside(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside such a carrier [n]: counted on a grid."""
    steps = (np.arange(150) + 0.5) / 150
    rings = np.sqrt(-2 * np.log(1 - steps))[:, None, None]
    beat = (1 + 0.45 * np.cos(2 * np.pi * steps[:40] * 3.75))[None, :, None]
    turn = np.exp(2j * np.pi * steps[::6])[None, None, :]
    tried = np.linspace(0, 8, 33)
    spread = [float(np.abs(rings * turn + one * beat).std()) for one in tried]
    return np.asarray(np.interp(loud, tried, spread)) / spread[0]


def _held(pane: Pane, strength: float) -> None:
    """Hold envelopes that cannot fall faster than a capacitor is discharged."""
    keeps = 1 - 0.22 / (0.35 + strength)
    size = np.abs(pane.now)
    floor = size.copy()
    for k in range(1, size.shape[1]):
        after = pane.since[:, k] > 2
        floor[:, k] = np.where(after, np.maximum(size[:, k], keeps * floor[:, k - 1]), size[:, k])
    pane.now = pane.now * floor / np.maximum(size, 1e-9)


def _wrong_pairs(pane: Pane, strength: float) -> None:
    """Read a memory of two banks in wrong order, in a part of records: neighbours change place."""
    struck = pane.rng.random((len(pane.table), len(AXIS) // 16 + 1)) < min(0.45 * strength, 0.95)
    struck = struck.repeat(16, axis=1)[:, : len(AXIS)] & (pane.since > 2)
    partner = AXIS.astype(np.intp) ^ 1
    both = struck & struck[:, partner]
    pane.now = np.where(both, pane.now[:, partner], pane.now)


def _dropped(pane: Pane, strength: float) -> None:
    """Drop samples that are weak, to save room, once a first path has been found."""
    weak = np.abs(pane.now) < 1.15 * strength**0.5 * pane.sigma[:, None]
    pane.now = np.where(weak & (pane.since > 5), 0.0, pane.now)


def _truncated(pane: Pane, strength: float) -> None:
    """Cut off what is less than a step, toward zero, as a shift of words with a sign's size."""
    step = 0.7 * strength * np.median(pane.sigma)
    pane.now = step * (np.trunc(pane.now.real / step) + 1j * np.trunc(pane.now.imag / step))
    noise = np.random.default_rng(817).standard_normal((9000, 2))
    tried = np.geomspace(0.02, 12, 60)
    left = [np.linalg.norm(one * np.trunc(noise / one), axis=1).std() for one in tried]
    ratio = np.interp(
        step / pane.sigma, tried, np.array(left) / np.linalg.norm(noise, axis=1).std()
    )
    pane.noise_by = pane.noise_by * np.maximum(ratio, 0.03)


def _dull(pane: Pane, strength: float) -> None:
    """Ask more of a first path, and time the upper part of its rise."""
    pane.dull = 0.8 * strength


WAVES: dict[str, Callable[[Pane, float], None]] = {
    "specular-reflections": _panes,
    "ground-bounce": _foil,
    "obstructed-path": _behind_tanks,
    "small-scale-fading": _leaves_sway,
    "diffuse-tail": _leaf_clutter,
    "pulse-ringing": _open_stub,
    "noise-floor": _lamp_drivers,
    "narrowband-interference": _swinging_carrier,
    "envelope-held": _held,
    "weak-samples-dropped": _dropped,
    "samples-in-wrong-pairs": _wrong_pairs,
    "quantisation": _truncated,
    "late-detection": _dull,
}
"""In the order in which they grow; those of rows grow between house and radio."""
RADIO = ("pulse-ringing", "noise-floor", "narrowband-interference", *ODD, "quantisation",
         "late-detection")  # fmt: skip


def grow(pane: Pane, names: tuple[str, ...], strength: float) -> None:
    """Let effects grow on waveforms: those of the house, of rows, of the radio."""
    house = [name for name in WAVES if name in names and name not in RADIO]
    radio = [name for name in WAVES if name in names and name in RADIO]
    for name in house:
        WAVES[name](pane, strength)
    for name in names:
        if name not in WAVES:
            pane.take(EFFECTS[name](pane.crop(), strength))
    for name in radio:
        WAVES[name](pane, strength)
