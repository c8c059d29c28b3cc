"""What the supermarket hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.market_desk import METRES, PLACES, Desk, bumps, grain, put_off
from bench.challenge.families.market_effects import EFFECTS, floor_ray
from bench.challenge.families.market_plan import CARRIER_GHZ, LIGHT
from bench.challenge.families.market_plan import LAWS as RANGE_LAWS

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "exchange-motion",
)  # fmt: skip
"""Effects that are those of the supermarket's tables of ranges."""
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms},
    **{name: Law() for name in ("labels-answer", "sums-wrap", "gain-droops")},
}
"""What nobody's library has."""


def _tills(desk: Desk, strength: float) -> None:
    desk.louder(EFFECTS["noise-floor"](desk.goods(), strength).hiss * np.ones(len(desk.table)))


def _unmatched_cable(desk: Desk, strength: float) -> None:
    """Hear all again, and once more, from both ends of a cable: each time turned and weaker."""
    there = desk.heard()
    late, turn = desk.fixed(1).uniform(5.5, 8.0), np.exp(2j * np.pi * desk.fixed(2).random())
    for times in (1, 2, 3):
        part = (0.34 * min(strength, 2.4) ** 0.7) ** times * turn**times
        desk.now = desk.now + part * put_off(there, np.full(len(there), late * times))


def _clusters(desk: Desk, strength: float) -> None:
    """Scatter in clusters, which come by chance: each rises at once, and decays by itself."""
    power = np.zeros_like(desk.after)
    for _ in range(5):
        at = 3 + desk.rng.exponential(14.0, len(power))[:, None]
        loud = desk.rng.exponential(1.0, len(power))[:, None] * np.exp(-at / 30)
        own = np.maximum(desk.after - at, 0)
        power = power + loud * np.exp(-own / 8) * (desk.after > at)
    rough = np.sqrt(0.013 * strength * power / 2) * grain(desk.rng, len(power))
    smooth = (rough + np.roll(rough, 1, axis=1)) / np.sqrt(2)
    desk.now = desk.now + desk.first()[:, None] * np.where(desk.after > 2, smooth, 0)


def _swelling_tone(desk: Desk, strength: float) -> None:
    """Hear an oscillator that swells and ebbs within a few samples: a carrier and two bands."""
    pitch, swell = desk.fixed(3).uniform(0.05, 0.45), desk.fixed(4).uniform(0.13, 0.21)
    loud = 1.4 * strength * desk.rng.weibull(4.0, len(desk.table))
    starts = desk.rng.random((len(loud), 1))
    wave = np.exp(2j * np.pi * pitch * PLACES) * (
        1 + 0.6 * np.cos(2 * np.pi * (swell * PLACES + starts))
    )
    desk.now = desk.now + (loud * desk.sigma * desk.spun())[:, None] * wave
    desk.noise_by = desk.noise_by * _beside(loud)
    desk.sigma = desk.sigma * np.sqrt(1 + loud**2 * 1.18 / 2)


def _beside(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside such a tone [n], by trial."""
    rng = np.random.default_rng(763)
    noise = rng.standard_normal((9000, 2)) @ [1, 1j]
    swell = 1 + 0.6 * np.cos(2 * np.pi * rng.random(9000))
    sizes = np.arange(0, 9, 0.2)
    return np.asarray(np.interp(loud, sizes, [np.abs(noise + s * swell).std() for s in sizes])) / (
        float(np.abs(noise).std())
    )


def _behind_tins(desk: Desk, strength: float) -> None:
    """Hear, on some links, almost nothing straight: a hump that swells by and by from shelves."""
    goods, there = desk.goods(), desk.heard()
    struck = goods.per_link(lambda n: (desk.rng.random(n) < 0.24) * 1.0)
    late = goods.per_link(lambda n: 2.0 + desk.rng.weibull(2.0, n) * 4.0) * (0.45 + 0.55 * strength)
    early = np.clip((desk.after + 5) / 2, 0, 1) * np.clip((9 - desk.after) / 3, 0, 1)
    desk.lose(1 - 0.982 * struck[:, None] * early)
    for step in range(9):
        size = (
            0.2
            * struck
            * np.sqrt(step + 1.5)
            * np.exp(-step / 4)
            * desk.rng.rayleigh(0.9, len(late))
        )
        echo = (size * desk.spun())[:, None] * put_off(there, late + 1.3 * step)
        desk.now = desk.now + echo


def _no_zero(desk: Desk, strength: float) -> None:
    """Round to steps that have no zero, as wide as the converter's gain makes them."""
    ratio = 0.009 * strength * np.abs(desk.now).max(axis=1) / desk.sigma
    step = (ratio * desk.sigma)[:, None]
    now = desk.now
    desk.now = step * (np.floor(now.real / step) + 0.5 + 1j * (np.floor(now.imag / step) + 0.5))
    noise = np.random.default_rng(764).standard_normal((2, 10000))
    grid = np.linspace(0.05, 7, 48)
    rounded = [one * (np.floor(noise / one) + 0.5) for one in grid]
    spread = np.array([np.hypot(*one).std() for one in rounded]) / np.hypot(*noise).std()
    desk.noise_by = desk.noise_by * np.maximum(np.interp(ratio, grid, spread), 0.02)
    desk.sigma = desk.sigma * np.maximum(np.interp(ratio, grid, [o.std() for o in rounded]), 0.6)


def _by_chance(desk: Desk, strength: float) -> None:
    """Fade by Weibull's law, alike for three samples, by another draw each time."""
    shape = 6.5 / np.sqrt(strength)
    cells = desk.rng.weibull(shape, (len(desk.table), len(PLACES) // 3 + 2))
    cells = cells / np.sqrt(np.square(cells).mean())
    begin = desk.rng.integers(0, 3, len(cells))[:, None]
    gain = np.take_along_axis(cells, (PLACES.astype(np.intp) + begin) // 3, axis=1)
    gain = (gain + np.roll(gain, 1, axis=1)) / 2
    desk.lose(np.where(desk.after > -4.5, gain, 1.0))


def _on_stone(desk: Desk, strength: float) -> None:
    longer, returned = floor_ray(desk.goods(), strength)
    turned = returned * np.exp(-2j * np.pi * CARRIER_GHZ * longer / LIGHT)
    desk.now = desk.now + turned[:, None] * put_off(desk.heard(), longer / METRES)


def _higher_quota(desk: Desk, strength: float) -> None:
    """Wait for more of a lobe's energy before it is timed."""
    desk.quota = min(desk.quota * (1 + 1.1 * strength), 0.85)


def _labels(desk: Desk, strength: float) -> None:
    """Hear labels at the shelf that send the pulse back, all after the same time, shifted."""
    answers = desk.goods().per_link(lambda n: (desk.rng.random(n) < 0.6) * 1.0)
    late = 33.0 + desk.rng.normal(0, 0.4, len(answers))
    size = 0.16 * strength**0.5 * answers * desk.first() * desk.spun()
    desk.now = desk.now + size[:, None] * bumps(desk.begun + late) * np.exp(0.9j * PLACES)


def _wrap(desk: Desk, strength: float) -> None:
    """Add up in words that are too short: what is above them starts again below."""
    parts = np.stack([desk.now.real, desk.now.imag])
    limit = np.abs(parts).max(axis=(0, 2)) / (1 + 0.3 * min(strength, 2.5))
    bound = limit[:, None]
    wrapped = np.mod(parts + bound, 2 * bound) - bound
    desk.now = wrapped[0] + 1j * wrapped[1]


def _droops(desk: Desk, strength: float) -> None:
    """Lose gain after a strong sample, and win it back slowly: noise and all."""
    pull = np.abs(desk.now) * (desk.after > -4) / desk.first()[:, None]
    kernel = np.exp(-np.arange(120) / 22.0)
    size = 2 * len(PLACES)
    summed = np.fft.irfft(np.fft.rfft(pull, size) * np.fft.rfft(kernel, size), size)
    fed = np.maximum(summed[:, : len(PLACES)], 0)
    desk.now = desk.now / (1 + 0.16 * strength * np.roll(fed, 3, axis=1))


WAVES: dict[str, Callable[[Desk, float], None]] = {
    "noise-floor": _tills,
    "pulse-ringing": _unmatched_cable,
    "diffuse-tail": _clusters,
    "narrowband-interference": _swelling_tone,
    "obstructed-path": _behind_tins,
    "quantisation": _no_zero,
    "small-scale-fading": _by_chance,
    "ground-bounce": _on_stone,
    "late-detection": _higher_quota,
    "labels-answer": _labels,
    "sums-wrap": _wrap,
    "gain-droops": _droops,
}
STAGES = {
    "pulse-ringing": 2, "noise-floor": 3, "narrowband-interference": 3, "gain-droops": 4,
    "level-control": 4, "power-bias": 5, "sums-wrap": 5, "quantisation": 6, "late-detection": 7,
}  # fmt: skip
"""Where in a radio effects are; what is not named is before it."""


def go_through(desk: Desk, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms go through effects, stage by stage."""
    for name in sorted(names, key=lambda one: STAGES.get(one, 1)):
        if name in WAVES:
            WAVES[name](desk, strength)
        else:
            desk.charge(EFFECTS[name](desk.goods(), strength))
