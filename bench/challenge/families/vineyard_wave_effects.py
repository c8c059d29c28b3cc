"""What the vineyard hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.vineyard_box import METRES, TICK, WIDE_SAMPLES, Box, rustle
from bench.challenge.families.vineyard_effects import EFFECTS, grass_ray
from bench.challenge.families.vineyard_slope import LAWS as RANGE_LAWS
from bench.challenge.families.vineyard_slope import PLOT_M, WALL_M, WAVE_M

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the vineyard's tables of ranges."""
ODD = ("fours-written-backwards", "block-exponent-stuck", "dither-left-in")
RANGES_ALONE = ("wheels-slip-downhill", "shoots-topped", "pieds-from-one-stake")
LAWS = {name: law for name, law in RANGE_LAWS.items() if name not in RANGES_ALONE}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
HUT_M = PLOT_M[0] + 3.1  # across, where huts of sheet iron stand along the last alley
STONES_M = 0.012  # how uneven a dry wall is
LATER = 10.0  # samples past arrivals from which oddities are


def _wall_and_huts(box: Box, strength: float) -> None:
    """Hear the wall of the terrace above, huts along the last alley, and the corner of both."""
    rows, heard = box.rows(), box.heard() * box.front()
    tx, rx = rows.at("tx"), rows.at("rx")
    for across, up, share in ((False, True, 0.75), (True, False, 0.85), (True, True, 0.6)):
        image = tx.copy()
        image[:, 0] = 2 * HUT_M - tx[:, 0] if across else tx[:, 0]
        image[:, 1] = 2 * WALL_M - tx[:, 1] if up else tx[:, 1]
        way = np.linalg.norm(rx - image, axis=1)
        steep = np.abs(rx - image)[:, 1] / way if up else np.zeros(len(way))
        even = np.exp(-0.5 * (2 * np.pi * STONES_M * steep / WAVE_M) ** 2)
        own = rows.by_link(lambda n: box.rng.uniform(0.7, 1.25, n))
        size = np.minimum(1.5 * strength**0.5 * share * even * own * rows.metres / way, 0.8)
        box.echo(heard, size * box.phases(), (way - rows.metres).clip(min=1.0) / METRES)


def _grass(box: Box, strength: float) -> None:
    longer, share = grass_ray(box.rows(), strength)
    box.echo(box.heard(), share, longer / METRES)


def _behind_pickers(box: Box, strength: float) -> None:
    """Lose, behind pickers and crates, what comes straight: rays over and round come by turns."""
    rows, heard = box.rows(), box.heard()
    behind = rows.chosen(0.22)
    box.weaken(1 - 0.98 * behind[:, None] * box.there() * box.front())
    late = (0.5 + 0.5 * strength) * rows.by_link(lambda n: box.rng.triangular(2.6, 3.6, 6.0, n))
    size = 0.44 * behind
    for _ in range(4):
        box.echo(heard, size * box.phases(), late)
        size = size * rows.by_link(lambda n: box.rng.uniform(0.55, 0.85, n))
        late = late + rows.by_link(lambda n: box.rng.gamma(2.0, 1.1, n))


def _swaying(box: Box, strength: float) -> None:
    """Fade by canes that sway: by logarithms that are normal, alike for some samples."""
    spread = min(0.3 * strength**0.7, 0.7)
    white = box.rng.standard_normal((len(box.table), WIDE_SAMPLES + 6))
    window = np.array([1.0, 2.0, 3.0, 3.0, 3.0, 2.0, 1.0])
    window /= np.linalg.norm(window)
    alike = sum(w * white[:, k : k + WIDE_SAMPLES] for k, w in enumerate(window))
    sizes = np.exp(spread * np.asarray(alike) - spread**2)  # as much power as before
    kept = 1 + box.there() * (sizes - 1)
    box.now = kept * box.now
    lost = np.sqrt(np.maximum(1 - np.minimum(kept, 1.0) ** 2, 0.0))
    box.add_noise(lost * box.sigma[:, None])


def _rows_behind_rows(box: Box, strength: float) -> None:
    """Scatter from row behind row of leaves: by a power of how late, as open country does."""
    past = np.maximum(box.since - 3.0, 0.0)
    power = 0.05 * strength * (1 + past / 7.0) ** -1.7 * box.late(3.0, 3.0)
    rough = np.sqrt(power / 2) * rustle(box.rng, len(box.table))
    box.now = box.now + box.height()[:, None] * rough


def _whip(box: Box, strength: float) -> None:
    """Ring on as a whip that is bent: a swing that falls off, from three samples on."""
    pitch, turn = box.same(1).uniform((0.35, 0.0), (0.65, 2 * np.pi))
    heard, part = box.heard(), 0.21 * min(strength, 2.3) ** 0.75
    for late in range(3, 15):
        swing = np.exp(-(late - 3) / 4.5 + 1j * (turn + pitch * late)) * min((late - 2) / 3, 1.0)
        moved = np.zeros_like(heard)
        moved[:, late:] = heard[:, :-late]
        box.now = box.now + part * swing * moved


def _boar_fence(box: Box, strength: float) -> None:
    blight = EFFECTS["noise-floor"](box.rows(), strength)
    box.raise_noise(np.asarray(blight.hiss))


def _pump_telemetry(box: Box, strength: float) -> None:
    """Hear a harmonic of the well's telemetry: a tone whose size swings, at some passes more."""
    pitch = box.same(2).uniform(-1.2, 1.2)
    near = box.rows().by_link(lambda n: box.rng.gamma(4.0, 0.25, n).clip(max=2.2))
    size = 1.5 * strength * near
    swing = 1 + 0.4 * np.sin(2 * np.pi * (TICK / 61.0 + box.rng.random((len(size), 1))))
    tone = swing * np.exp(1j * pitch * TICK) * box.phases()[:, None]
    box.now = box.now + (size * box.sigma)[:, None] * tone
    box.hissed = box.hissed * _beside_tone(size)
    box.sigma = box.sigma * np.sqrt(1 + 0.54 * size**2)


def _beside_tone(size: Floats) -> Floats:
    """Return how many times more sizes scatter beside such a tone [n], in scatters: by trial."""
    noise = np.random.default_rng(1136).standard_normal((2, 16000))
    tried = np.linspace(0.0, 10.0, 41)
    spread = np.array([np.std(np.hypot(noise[0] + one, noise[1])) for one in tried])
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _sizes(box: Box) -> tuple[Floats, Floats, Floats]:
    """Return 1 where samples are late, else 0, all sizes, and roots of mean late powers [n, 1]."""
    late, size = (box.since > LATER).astype(np.float64), np.abs(box.now)
    power = np.sum(late * size**2, axis=1) / np.maximum(late.sum(axis=1), 1.0)
    return late, size, np.sqrt(power)[:, None]


def _become(box: Box, size: Floats, wanted: Floats, share: Floats) -> None:
    """Let sizes become others, in such a share [n, k]; phases stay."""
    box.now = box.now * (1 + share * (wanted / np.maximum(size, 1e-9) - 1))


def _fours(box: Box, strength: float) -> None:
    """Write late samples in words of four, some of whose bytes are in the other order."""
    late, size, _ = _sizes(box)
    begin = int(box.same(3).integers(4))
    at = np.arange(WIDE_SAMPLES)
    other = np.clip(at + 3 - 2 * ((at + begin) % 4), 0, WIDE_SAMPLES - 1)
    both = late * late[:, other]  # no word that begins before what is late
    _become(box, size, size[:, other], min(0.5 * strength, 0.95) * both)


def _exponent(box: Box, strength: float) -> None:
    """Give late samples eight by eight one exponent, stuck at what is usual: larger ones wrap."""
    late, size, usual = _sizes(box)
    most = usual * (1.9 - 0.45 * min(strength, 2.0))
    _become(box, size, np.where(size > most, np.mod(size, most), size), late)


def _dither(box: Box, strength: float) -> None:
    """Leave in late sizes the dither that was added before conversion: the same in every row."""
    late, size, usual = _sizes(box)
    pattern = box.same(4).uniform(-1.0, 1.0, WIDE_SAMPLES)
    began = np.floor(box.came).astype(np.intp)[:, None]
    turned = pattern[(np.arange(WIDE_SAMPLES) - began) % WIDE_SAMPLES]
    _become(box, size, np.maximum(size + 0.42 * strength * usual * turned, 0.0), late)


def _shifted_out(box: Box, strength: float) -> None:
    """Keep both parts in whole steps, cut down as a shift of words does, and half a step off."""
    step = 1.25 * strength * float(np.median(box.sigma))
    real, imaginary = (step * np.floor(part / step) for part in (box.now.real, box.now.imag))
    box.now = real + 1j * imaginary
    noise = np.random.default_rng(1137).standard_normal((2, 16000))
    tried = np.geomspace(0.08, 9.0, 44)
    spread = [np.std(np.hypot(*(one * np.floor(noise / one)))) for one in tried]
    times = np.interp(step / box.sigma, tried, np.array(spread) / np.std(np.hypot(*noise)))
    box.hissed = box.hissed * np.maximum(times, 0.05)


def _dull(box: Box, strength: float) -> None:
    """Ask more of what is first: where that is weak it is not heard."""
    box.dull = strength


ABROAD: dict[str, Callable[[Box, float], None]] = {
    "specular-reflections": _wall_and_huts,
    "ground-bounce": _grass,
    "obstructed-path": _behind_pickers,
    "small-scale-fading": _swaying,
    "diffuse-tail": _rows_behind_rows,
}
WITHIN: dict[str, Callable[[Box, float], None]] = {
    "pulse-ringing": _whip,
    "noise-floor": _boar_fence,
    "narrowband-interference": _pump_telemetry,
    "fours-written-backwards": _fours,
    "block-exponent-stuck": _exponent,
    "dither-left-in": _dither,
    "quantisation": _shifted_out,
    "late-detection": _dull,
}
WAVES = ABROAD | WITHIN


def befall(box: Box, names: tuple[str, ...], strength: float) -> None:
    """Let effects befall waveforms: those between antennas, those of rows, those of the radio."""
    for name, effect in ABROAD.items():
        if name in names:
            effect(box, strength)
    for name in names:
        if name not in WAVES:
            box.suffer(EFFECTS[name](box.rows(), strength))
    for name, effect in WITHIN.items():
        if name in names:
            effect(box, strength)
