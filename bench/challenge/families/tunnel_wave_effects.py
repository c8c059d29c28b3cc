"""What the tunnel hides in waveforms: effects in forms of its own, and oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.tunnel_effects import BORE_M, EFFECTS, WAVELENGTH_M, trackbed_ray
from bench.challenge.families.tunnel_effects import LAWS as RANGE_LAWS
from bench.challenge.families.tunnel_probe import (
    EARLIER,
    SAMPLE_M,
    WIDE_SAMPLES,
    Probe,
    postponed,
    responses,
)

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "range-rounding", "material-delay",
    "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the tunnel's tables of ranges."""
_KEPT = (
    "soot-on-radomes", "traction-current", "jet-fan-two", "lining-sweats", "niche-resurveyed",
    "niches-crossed",
)  # fmt: skip
_OWN = ("leaky-feeder", "stuck-bins", "logarithmic-amplifier")
LAWS = {name: RANGE_LAWS[name] for name in _KEPT} | dict.fromkeys(_OWN, Law())
"""What nobody's library has."""


def _inverters(probe: Probe, strength: float) -> None:
    ledger = probe.ledger()
    EFFECTS["noise-floor"](ledger, strength)
    probe.add_noise(ledger.noise_db)


def _feeder_echoes(probe: Probe, strength: float) -> None:
    """Go up and down a mismatched feeder, again and again, always as long."""
    there, back = probe.arriving(), 0.21 * min(strength, 2.5)
    turn = np.exp(1j * probe.kept(1).uniform(-1, 1))
    for times in (1, 2, 3):
        again = postponed(there, np.full(probe.rows, 5.4 * times))
        probe.waves = probe.waves + turn * (-back) ** times * again


def _steel(probe: Probe, strength: float) -> None:
    """Echo from gates at both portals, steel plates on both walls, and a duct below the roof."""
    ledger, there = probe.ledger(), probe.arriving()
    for axis, plane in ((0, 0.0), (0, BORE_M[0]), (1, 0.0), (1, BORE_M[1]), (2, BORE_M[2])):
        image = ledger.tags_at()
        image[:, axis] = 2 * plane - image[:, axis]
        longer = ledger.more_than_true(image)
        size = min(0.34 * strength, 0.9) * ledger.away / (ledger.away + longer) * probe.phases()
        probe.waves = probe.waves + size[:, None] * postponed(there, longer / SAMPLE_M)


def _sparse_tail(probe: Probe, strength: float) -> None:
    """Add few arrivals of exponential power, of which fewer and weaker come later."""
    after = np.maximum(probe.since - 3.5, 0)
    comes = probe.rng.random(after.shape) < 0.45 * np.exp(-after / 90)
    power = 0.03 * strength * probe.rng.exponential(1, after.shape) * np.exp(-after / 19)
    turn = np.exp(2j * np.pi * probe.rng.random(after.shape))
    taps = comes * (after > 0) * np.sqrt(power) * turn * probe.height()[:, None]
    wide = 2 * WIDE_SAMPLES
    shape = responses(np.array([15.0]))
    both = np.fft.fft(taps, wide, axis=1) * np.fft.fft(shape, wide, axis=1)
    probe.waves = probe.waves + np.fft.ifft(both, axis=1)[:, 15 : 15 + WIDE_SAMPLES]


def _two_carriers(probe: Probe, strength: float) -> None:
    """Hear two carriers that beat, louder in some frames than in others."""
    apart = probe.kept(2).uniform(0.07, 0.21)
    lower = probe.kept(3).uniform(-0.35, 0.1)
    loud = strength * probe.rng.gamma(6, 1.25 / 6, probe.rows)
    when = np.arange(WIDE_SAMPLES)
    for turns, part in ((lower, 0.8), (lower + apart, 0.6)):
        carrier = np.exp(2j * np.pi * turns * when)[None] * probe.phases()[:, None]
        probe.waves = probe.waves + (part * loud * probe.sigma)[:, None] * carrier
    tried = _sizes_with_carriers(loud)
    probe.noise_factor = probe.noise_factor * tried
    probe.sigma = probe.sigma * np.sqrt(1 + loud**2 / 2)


def _sizes_with_carriers(loud: Floats) -> Floats:
    """Return how much more sizes of noise scatter with both carriers [n], by trial."""
    rng, grid = np.random.default_rng(615), np.linspace(0, 12, 40)
    noise, turns = rng.normal(size=(2, 15000)) * 1.0, rng.uniform(0, 2 * np.pi, (2, 15000))
    beat = 0.8 * np.exp(1j * turns[0]) + 0.6 * np.exp(1j * turns[1])
    spread = [float(np.abs(noise[0] + 1j * noise[1] + one * beat).std()) for one in grid]
    return np.asarray(np.interp(loud, grid, np.array(spread) / spread[0]))


def _past_wagons(probe: Probe, strength: float) -> None:
    """Hear next to nothing straight on some links, and a train of arrivals later."""
    ledger, there = probe.ledger(), probe.arriving()
    parked = ledger.of_link(lambda n: (ledger.rng.random(n) < 0.22).astype(np.float64))
    begins = ledger.of_link(lambda n: ledger.rng.triangular(1.6, 3.5, 8.5, n))
    begins = begins * (0.5 + 0.5 * strength)
    open_now = np.clip((probe.since + 7) / 3, 0, 1) / (1 + np.exp(2.5 * (probe.since - 7)))
    probe.amplify(1 - 0.98 * parked[:, None] * open_now)
    for number, size in enumerate((0.25, 0.45, 0.4, 0.3, 0.2, 0.12)):
        turned = parked * size * probe.phases()
        probe.waves = probe.waves + turned[:, None] * postponed(there, begins + 1.7 * number)


def _mid_rise(probe: Probe, strength: float) -> None:
    """Round components to odd halves of a step: there is no zero."""
    ratio = 1.2 * strength
    step = (ratio * probe.sigma)[:, None]
    halves = [np.floor(part / step) + 0.5 for part in (probe.waves.real, probe.waves.imag)]
    probe.waves = np.asarray(step * (halves[0] + 1j * halves[1]), np.complex128)
    tried = np.random.default_rng(616).normal(size=(2, 40000))
    steps = ratio * (np.floor(tried / ratio) + 0.5)
    factor = float(np.hypot(*steps).std() / np.hypot(*tried).std())
    probe.noise_factor = probe.noise_factor * max(factor, 0.02)
    probe.sigma = probe.sigma * max(float(steps.std()), 0.5)


def _nakagami(probe: Probe, strength: float) -> None:
    """Fade by Nakagami's law, three samples or so alike."""
    shape = 2.6 / min(strength, 3.0)
    power = probe.rng.gamma(shape, 1 / shape, (probe.rows, WIDE_SAMPLES + 2))
    alike = np.sqrt((power[:, :-2] + power[:, 1:-1] + power[:, 2:]) / 3)
    probe.amplify(np.where(probe.since > -6, alike, 1.0))


def _off_the_trackbed(probe: Probe, strength: float) -> None:
    longer, size = trackbed_ray(probe.ledger(), strength)
    turned = size * np.exp(-2j * np.pi * longer / WAVELENGTH_M)
    probe.waves = probe.waves + turned[:, None] * postponed(probe.arriving(), longer / SAMPLE_M)


def _not_alert(probe: Probe, strength: float) -> None:
    """Take as a first path what stands out several times more."""
    probe.alert = 1 + 2.5 * strength


def _feeder_cable(probe: Probe, strength: float) -> None:
    """Hear what a leaky cable below the roof takes along, at 0.88 of the speed of light."""
    ledger = probe.ledger()
    along = np.abs(ledger["tx_x_m"] - ledger["rx_x_m"]) / 0.88
    legs = np.zeros(probe.rows)
    for end in ("tx", "rx"):
        legs += np.hypot(ledger[f"{end}_y_m"] - BORE_M[1] / 2, ledger[f"{end}_z_m"] - BORE_M[2])
    late = np.maximum(along + legs - ledger.away, 0) / SAMPLE_M
    size = 0.28 * strength * probe.height() * probe.phases()
    probe.waves = probe.waves + size[:, None] * responses(probe.arrival + EARLIER + late)


def _stuck(probe: Probe, strength: float) -> None:
    """Read the same value from some words of the memory in every frame."""
    rng = probe.kept(4)
    words = rng.choice(np.arange(4, WIDE_SAMPLES - 4), 9, replace=False)
    stuck = 2.6 * strength * rng.uniform(0.6, 1.4, 9) * np.exp(2j * np.pi * rng.random(9))
    probe.waves[:, words] = stuck * np.median(probe.sigma)


def _logarithmic(probe: Probe, strength: float) -> None:
    """Bend large sizes down as a logarithm does; small ones stay."""
    size = np.abs(probe.waves)
    knee = 14 * probe.sigma[:, None] / min(strength, 3.0)
    bent = knee * np.log1p(size / knee)
    probe.waves = probe.waves * bent / np.maximum(size, 1e-9)


WAVES: dict[str, Callable[[Probe, float], None]] = {
    "noise-floor": _inverters,
    "pulse-ringing": _feeder_echoes,
    "specular-reflections": _steel,
    "diffuse-tail": _sparse_tail,
    "narrowband-interference": _two_carriers,
    "obstructed-path": _past_wagons,
    "quantisation": _mid_rise,
    "small-scale-fading": _nakagami,
    "ground-bounce": _off_the_trackbed,
    "late-detection": _not_alert,
    "leaky-feeder": _feeder_cable,
    "stuck-bins": _stuck,
    "logarithmic-amplifier": _logarithmic,
}
STAGES = (
    "noise-floor", "narrowband-interference", "power-bias", "level-control",
    "logarithmic-amplifier", "stuck-bins", "quantisation", "late-detection", "range-rounding",
)  # fmt: skip
"""What the receiver does, in its order; all else is on the way to it."""


def pass_through(probe: Probe, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms pass through effects."""
    order = {name: stage for stage, name in enumerate(STAGES, 1)}
    for name in sorted(names, key=lambda one: order.get(one, 0)):
        if name in WAVES:
            WAVES[name](probe, strength)
            continue
        ledger = probe.ledger()
        EFFECTS[name](ledger, strength)
        probe.settle(ledger)
