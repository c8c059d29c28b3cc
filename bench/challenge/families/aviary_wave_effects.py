"""What the aviary hides in waveforms: effects in forms of its own, oddities of its listeners.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.aviary_effects import EFFECTS, off_the_ground
from bench.challenge.families.aviary_grounds import DEEP_M, NESTBOXES, WAVE_M, WIDE_M
from bench.challenge.families.aviary_grounds import LAWS as LAWS_OF_ROWS
from bench.challenge.families.aviary_listener import (
    METRES,
    TICKS,
    WIDE_SAMPLES,
    Listener,
    murmur,
)
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the aviary's tables of ranges."""
ODD = ("late-sizes-summed-in-threes", "sizes-fold-over", "harmonic-means-kept")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if "unit" not in law.forms}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
FROM = 10.0  # samples after arrivals from which listeners are odd
ROCK, CRAGS_M = 6.8, 0.009  # permittivity; how rough rock is
PANE, PANE_M = 6.31, 0.0066  # of glass; how thick
CARRIERS, APART, SYMBOL = 6, 0.83, 34  # of a video link; radians a sample; samples
KEEPS = 0.82  # of a step: so far codes are kept
TRIED: Complexes = murmur(np.random.default_rng(2109), 140)  # noise to try readings on


def rock(straight: Floats) -> Floats:
    """Return what rough rock returns of upright waves that come so straight [n], in size."""
    root = np.sqrt(ROCK - 1 + straight**2)
    rough = np.exp(-0.5 * (4 * np.pi * CRAGS_M / WAVE_M * straight) ** 2)
    return np.asarray(np.abs((straight - root) / (straight + root)) * rough)


def panes(straight: Floats) -> Floats:
    """Return what a pane returns, off both of its faces and between (Airy 1833) [n], in size."""
    root = np.sqrt(PANE - 1 + straight**2)
    face = (straight - root) / (straight + root)
    turn = np.exp(-4j * np.pi * PANE_M / WAVE_M * root)
    return np.asarray(np.abs(face * (1 - turn) / (1 - face**2 * turn)))


def _rock_and_panes(listener: Listener, strength: float) -> None:
    """Hear the wall of rock in the north, and panes in the west, east and south."""
    watch, air = listener.watch(), listener.heard() * listener.first()
    sides = ((1, DEEP_M, rock), (1, 0.0, panes), (0, 0.0, panes), (0, WIDE_M, panes))
    for axis, plane_m, returns in sides:
        image = watch.there.copy()
        image[:, axis] = 2 * plane_m - image[:, axis]
        way = np.sqrt(((image - watch.hung) ** 2).sum(axis=1))
        back = returns(np.abs(image - watch.hung)[:, axis] / way)
        clear = watch.by_link(lambda n: listener.rng.beta(4.0, 1.8, n))
        share = (2.1 * np.sqrt(strength) * clear * back * watch.far / way).clip(max=0.8)
        later = ((way - watch.far) / METRES).clip(2.9)
        listener.repeat(air, share * listener.whirled(), later)


def _ground(listener: Listener, strength: float) -> None:
    longer, share = off_the_ground(listener.watch(), strength)
    listener.repeat(listener.heard(), share, longer / METRES)


def _behind_trunks(listener: Listener, strength: float) -> None:
    """Lose what comes straight behind trunks: it comes off those about, one after the other."""
    watch, air = listener.watch(), listener.heard()
    hidden = watch.behind(0.21)
    listener.fade(-35.0 * hidden[:, None] * listener.first())
    late = 1.5 + 1.7 * strength**0.7 * watch.by_link(lambda n: 0.15 + listener.rng.beta(1.5, 2, n))
    for order in range(8):
        size = 0.52 * hidden * 0.83**order * listener.rng.uniform(0.55, 1.2, listener.rows)
        listener.repeat(air, size * listener.whirled(), late)
        late = late + watch.by_link(lambda n: 0.8 + listener.rng.exponential(2.4, n))


def _slow_wave(listener: Listener) -> Complexes:
    """Return waves of chance of power 1 that change over some samples [n, k]."""
    turns = 2 * np.pi * np.fft.fftfreq(WIDE_SAMPLES)
    loose = listener.rng.normal(size=(listener.rows, WIDE_SAMPLES, 2)) @ np.array([1.0, 1.0j])
    passed = np.exp(-0.5 * (turns * 5.5) ** 2)
    made = np.fft.ifft(loose * passed, axis=1) * WIDE_SAMPLES
    return np.asarray(made / np.sqrt(2 * (passed**2).sum()))


def _loo(listener: Listener, strength: float) -> None:
    """Fade as Loo (1985) has it below trees: a bell of decibels, and scatter of Rayleigh's."""
    share = min(0.23 * strength**0.7, 0.65)
    bell_db = 2.1 * np.sqrt(strength) * _slow_wave(listener).real * np.sqrt(2)
    by = np.sqrt(1 - share) * 10 ** (bell_db / 20) + np.sqrt(share) * _slow_wave(listener)
    listener.wave = listener.wave + listener.heard() * (
        np.abs(by) / np.sqrt((np.abs(by) ** 2).mean()) - 1
    )


def _among_trees(listener: Listener, strength: float) -> None:
    """Come out of crowns near and far, which are met ever less: by a power of how late it is."""
    since = listener.since.clip(0.0)
    power = 0.085 * (1 + (since / 12.0) ** 2) ** -1.4 * listener.after(3.0, 3.0)
    listener.hiss(np.sqrt(strength * power / 2) * listener.tall()[:, None])


def _packet(listener: Listener, strength: float) -> None:
    """Ring by a packet, as waves on a crystal's face go by a second comb."""
    drawn = listener.shared(1)
    middle, pitch = drawn.uniform(9.0, 12.0), drawn.uniform(-1.3, 1.3)
    air, wave = listener.heard(), listener.wave.copy()
    for lag in range(3, 26):
        part = 0.25 * min(strength, 2.4) ** 0.8 * np.exp(-0.5 * ((lag - middle) / 4.0) ** 2)
        wave[:, lag:] += part * np.exp(1j * pitch * lag) * air[:, :-lag]
    listener.wave = wave


def _misters(listener: Listener, strength: float) -> None:
    db = EFFECTS["noise-floor"](listener.watch(), strength).noise_db
    listener.louder_noise(np.zeros(listener.rows) + db)


def _read(listener: Listener, of: Floats, tried: Floats, made: list[Floats]) -> None:
    """Tell of noise by how sizes of it scatter as tried, at what is `of` a row [n]."""
    by = np.array([one.std() for one in made]) / np.abs(TRIED).std()
    listener.noise_by = listener.noise_by * np.interp(of, tried, by).clip(0.04)


def _video_link(listener: Listener, strength: float) -> None:
    """Hear a drone's video link: some carriers side by side, each with a phase for a symbol."""
    drawn = listener.shared(2)
    begins, near = drawn.uniform(-3.0, 3.0), drawn.gamma(5.0, 0.2, NESTBOXES)
    count = WIDE_SAMPLES // SYMBOL + 2
    quarters = listener.rng.integers(4, size=(listener.rows, CARRIERS, count))
    symbol = ((TICKS + listener.rng.integers(SYMBOL, size=(listener.rows, 1))) // SYMBOL).astype(
        int
    )
    tone = np.zeros((listener.rows, WIDE_SAMPLES), np.complex128)
    for k in range(CARRIERS):
        quarter = np.take_along_axis(quarters[:, k], symbol, axis=1)
        tone += np.exp(1j * ((begins + k * APART) * TICKS + 0.5 * np.pi * quarter))
    tone /= np.sqrt(CARRIERS)
    size = 1.5 * strength * near[listener.watch().box]
    listener.wave = listener.wave + (listener.sigma * size)[:, None] * tone
    tried, some = np.linspace(0.0, 16.0, 49), np.resize(tone, TRIED.shape)
    _read(listener, size, tried, [np.abs(TRIED + one * some) for one in tried])
    listener.sigma = listener.sigma * np.sqrt(1 + 0.5 * size**2)


def sticky(waves: Complexes, step: float) -> Complexes:
    """Return waveforms in whole steps, each kept until it is off by KEEPS of a step."""
    parts = np.stack([waves.real, waves.imag]) / step
    kept = np.rint(parts)
    for k in range(1, parts.shape[2]):
        holds = np.abs(parts[:, :, k] - kept[:, :, k - 1]) < KEEPS
        kept[:, :, k] = np.where(holds, kept[:, :, k - 1], kept[:, :, k])
    return np.asarray(step * (kept[0] + 1j * kept[1]))


def _by_sticky_steps(listener: Listener, strength: float) -> None:
    """Convert with a comparator that sticks: codes are kept for longer than half a step."""
    step = 1.6 * strength * float(np.median(listener.sigma))
    listener.wave = sticky(listener.wave, step)
    tried = np.geomspace(0.06, 11.0, 60)
    made = [np.abs(sticky(TRIED, float(one))[:, 24:]) for one in tried]
    _read(listener, step / listener.sigma, tried, made)


def _drowsy(listener: Listener, strength: float) -> None:
    """Ask more of first pulses, as listeners do that save their cells."""
    listener.drowsy = strength


def _instead(listener: Listener, sizes: Floats, part: float) -> None:
    """Let late sizes become others [n, k] by a part, at the phases that they have."""
    now = np.abs(listener.wave).clip(1e-9)
    by = 1 + min(part, 1.0) * listener.after(FROM) * (sizes / now - 1)
    listener.wave = listener.wave * by


def _in_threes(listener: Listener, strength: float) -> None:
    """Sum three late sizes up, by the root of three, and show that three times over."""
    first = (3 * (TICKS // 3)).astype(int)
    size = np.pad(np.abs(listener.wave), ((0, 0), (0, 2)), mode="edge")
    _instead(
        listener, (size[:, first] + size[:, first + 1] + size[:, first + 2]) / 3**0.5, strength
    )


def _folded(listener: Listener, strength: float) -> None:
    """Let late sizes that are over a limit come down again, as folding converters do."""
    size = np.abs(listener.wave)
    late = np.where(listener.since > FROM, size, np.nan)
    limit = 1.3 * np.nanmedian(late, axis=1)[:, None]
    _instead(listener, limit - np.abs(size % (2 * limit) - limit), strength)


def _harmonic(listener: Listener, strength: float) -> None:
    """Keep harmonic means of five late sizes for the middle one."""
    slow = 1 / np.abs(listener.wave).clip(1e-6)
    five = np.sum([np.roll(slow, k, axis=1) for k in range(-2, 3)], axis=0)
    _instead(listener, 5 / five, strength)


BELOW_THE_NET: dict[str, Callable[[Listener, float], None]] = {
    "obstructed-path": _behind_trunks,
    "specular-reflections": _rock_and_panes,
    "ground-bounce": _ground,
    "small-scale-fading": _loo,
    "diffuse-tail": _among_trees,
}
IN_LISTENERS: dict[str, Callable[[Listener, float], None]] = {
    "pulse-ringing": _packet,
    "noise-floor": _misters,
    "narrowband-interference": _video_link,
    "late-sizes-summed-in-threes": _in_threes,
    "sizes-fold-over": _folded,
    "harmonic-means-kept": _harmonic,
    "quantisation": _by_sticky_steps,
    "late-detection": _drowsy,
}
WAVES = BELOW_THE_NET | IN_LISTENERS


def put_in(listener: Listener, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is below the net, what becomes of rows, and what listeners do."""
    rows = sorted(name for name in names if name not in WAVES)
    for name in (one for one in BELOW_THE_NET if one in names):
        BELOW_THE_NET[name](listener, strength)
    for name in rows:
        listener.undergo(EFFECTS[name](listener.watch(), strength))
    for name in (one for one in IN_LISTENERS if one in names):
        IN_LISTENERS[name](listener, strength)
