"""What the fairground hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.fairground_effects import EFFECTS, meadow_ray
from bench.challenge.families.fairground_rides import BOOTHS_M, FLANKS
from bench.challenge.families.fairground_rides import LAWS as RANGE_LAWS
from bench.challenge.families.fairground_till import METRES, STEP, Till, chatter

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the fairground's tables of ranges."""
QUEER = ("highest-carry-lost", "runs-of-one-word", "quadrature-fails")
UNSEEN = ("wheel-set-askew", "louder-of-two-kept", "sazhens-from-one-booth")  # in ranges alone
LAWS = {name: RANGE_LAWS[name] for name in RANGE_LAWS if name not in UNSEEN}
LAWS.update({name: Law() for name in QUEER})
"""What nobody's library has."""
SIDES = 0.8  # of what meets a wagon's side, returned


def _wagons(till: Till, strength: float) -> None:
    """Hear wagons' sides, which end: an image is heard where it is met between both ends."""
    ticket, struck = till.ticket(), till.heard() * till.first()
    seats, roofs = ticket.seats(), ticket.roofs()
    for axis, plane, begin, end, height in FLANKS:
        near, far = np.abs(seats[:, axis] - plane), np.abs(roofs[:, axis] - plane)
        part = near / np.maximum(near + far, 1e-6)
        met = seats + part[:, None] * (roofs - seats)
        along = met[:, 1 - axis]
        inside = _edged(along - begin) * _edged(end - along) * _edged(height + 1.0 - met[:, 2])
        way = np.sqrt(ticket.way**2 + 4 * near * far)
        dents = ticket.by_link(till.rng.uniform, 0.55, 1.1)
        share = np.minimum(1.2 * strength**0.5 * SIDES * dents * inside * ticket.way / way, 0.85)
        till.copy(share * till.phase(), np.maximum(way - ticket.way, 1.0) / METRES, struck)


def _edged(inside_m: Floats) -> Floats:
    """Return 0 well outside of a wagon's end, and 1 well inside, as fringes blur it [n]."""
    return np.asarray(1 / (1 + np.exp(-inside_m / 0.6)))


def _meadow(till: Till, strength: float) -> None:
    longer, share = meadow_ray(till.ticket(), strength)
    till.copy(share, longer / METRES, till.heard())


def _behind_lorries(till: Till, strength: float) -> None:
    """Lose, behind lorries, what comes straight: it comes by one side, by the other, by both."""
    ticket, heard = till.ticket(), till.heard()
    lorries = ticket.chance(0.2)
    till.muffle(1 - 0.982 * lorries[:, None] * till.sounds() * till.first())
    scale = 0.5 * (1 + strength)
    one = scale * ticket.by_link(till.rng.uniform, 2.3, 4.2)
    other = one + ticket.by_link(till.rng.uniform, 1.0, 4.0)
    for late, size in ((one, 0.37), (other, 0.32), (one + other, 0.22), (2 * one + other, 0.15)):
        share = lorries * size * ticket.by_link(till.rng.triangular, 0.75, 1.0, 1.25)
        till.copy(share * till.phase(), late, heard)


def _suzuki(till: Till, strength: float) -> None:
    """Fade as Suzuki has it (1977): a log-normal mean that sways, and beside it waves of chance."""
    knots = len(STEP) // 7 + 3
    shift = till.rng.random((till.rows, 1))
    left = np.floor(STEP / 7 + shift).astype(np.intp)
    part = STEP / 7 + shift - left
    drawn = till.rng.standard_normal((3, till.rows, knots))
    here, there = (np.take_along_axis(drawn, np.stack([left + k] * 3), axis=2) for k in (0, 1))
    mean_db, real, imaginary = (here * (1 - part) + there * part) / np.hypot(1 - part, part)
    loose = min(0.15 * strength, 0.7)
    wave = np.sqrt(1 - loose) + np.sqrt(loose / 2) * (real + 1j * imaginary)
    size = np.abs(wave) * 10 ** (min(1.3 * strength, 3.5) * mean_db / 20)
    till.muffle(1 + till.sounds() * (size / np.sqrt(np.mean(size**2)) - 1))


def _rayleigh_hump(till: Till, strength: float) -> None:
    """Scatter off people all about: as many as there are at a distance, so a Rayleigh's hump."""
    past = np.maximum(till.past - 3.5, 0.0) / 17.0
    power = 0.03 * strength * past * np.exp(-0.5 * past**2)
    till.now = till.now + till.top()[:, None] * np.sqrt(power / 2) * chatter(till.rng, till.rows)


def _triple_transit(till: Till, strength: float) -> None:
    """Ring as a filter of surface waves does: what runs across it three times, a little blurred."""
    late, turn = till.fixed(1).uniform((6.5, 0.0), (9.0, 6.28))
    heard = till.heard()
    for apart, part in ((-1.1, 0.25), (0.0, 0.5), (1.1, 0.25)):
        share = np.full(till.rows, 0.42 * min(strength, 2.4) * part * np.exp(1j * turn))
        till.copy(share, np.full(till.rows, late + apart), heard)


def _generators(till: Till, strength: float) -> None:
    till.hiss(EFFECTS["noise-floor"](till.ticket(), strength).db("hiss"))


def _walking_tone(till: Till, strength: float) -> None:
    """Hear an oscillator that nothing locks: its phase walks, and rows hear it fade by chance."""
    pitch = till.fixed(2).uniform(-0.4, 0.4)
    own = till.fixed(3).gamma(6.0, 1 / 6.0, len(BOOTHS_M))[till.ticket().booth]
    size = 1.7 * strength * own * till.rng.rayleigh(0.8, till.rows)
    steps = till.rng.normal(2 * np.pi * pitch, 0.35, till.now.shape)
    tone = np.exp(1j * np.cumsum(steps, axis=1)) * till.phase()[:, None]
    till.now = till.now + np.reshape(size * till.sigma, (-1, 1)) * tone
    till.hisses = till.hisses * _among_noise(size)
    till.sigma = till.sigma * np.sqrt(1 + 0.5 * size**2)


def _among_noise(size: Floats) -> Floats:
    """Return how many times more sizes scatter with such a tone among them [n]: by trial."""
    noise = np.random.default_rng(987).normal(size=(2, 22000))
    tried = np.arange(0.0, 8.0, 0.25)
    spread = [np.hypot(noise[0] + one, noise[1]).std() for one in tried]
    return np.asarray(np.interp(size, tried, spread) / spread[0])


def _usual(till: Till, late: NDArray[np.bool_]) -> Floats:
    """Return the root of the mean of late powers [n, 1]."""
    power = np.sum(late * np.abs(till.now) ** 2, axis=1, keepdims=True)
    return np.asarray(np.sqrt(power / np.sum(late, axis=1, keepdims=True).clip(1.0)))


def _carry(till: Till, strength: float) -> None:
    """Lose the highest carry of late sizes: what is too large for a word begins anew at zero."""
    late = till.since(10.0) > 0.5
    size, word = np.abs(till.now), 1.45 * _usual(till, late) / strength**0.4
    lost = np.where(late, np.mod(size, word), size)
    till.now = till.now * lost / np.maximum(size, 1e-9)


def _runs(till: Till, strength: float) -> None:
    """Repeat a late word until a size is another by much: so a coder of runs writes it."""
    late = till.since(10.0) > 0.5
    much = 0.42 * strength**0.7 * _usual(till, late)[:, 0]
    size = np.abs(till.now)
    word = size.copy()
    for k in range(1, size.shape[1]):
        same = late[:, k] & (np.abs(size[:, k] - word[:, k - 1]) < much)
        word[same, k] = word[same, k - 1]
    till.now = till.now * word / np.maximum(size, 1e-9)


def _quadrature(till: Till, strength: float) -> None:
    """Lose of late samples one of both components, by degrees; the other is read louder for it."""
    part = min(0.55 * strength, 1.0) * till.since(10.0)
    turn = till.phase()[:, None]
    spun = till.now * turn
    kept = spun.real * np.sqrt(2 - np.square(1 - part)) + 1j * spun.imag * (1 - part)
    till.now = kept / turn


def _shaped(till: Till, strength: float) -> None:
    """Round to steps and carry what is left into the next sample: a loop that shapes its noise."""
    step = 1.15 * strength * float(np.median(till.sigma))
    till.now = _carried(till.now.real, step) + 1j * _carried(till.now.imag, step)
    noise = chatter(np.random.default_rng(988), 90)
    tried = np.linspace(0.2, 4.0, 30)
    spread = [np.hypot(_carried(noise.real, one), _carried(noise.imag, one)).std() for one in tried]
    by = np.interp(step / till.sigma, tried, np.array(spread) / np.abs(noise).std())
    till.hisses = till.hisses * np.maximum(by, 0.05)


def _carried(values: Floats, step: float) -> Floats:
    """Return values [n, k] in steps, of which each has what the one before left over."""
    out, over = np.empty_like(values), np.zeros(len(values))
    for k in range(values.shape[1]):
        wanted = values[:, k] + over
        out[:, k] = step * np.rint(wanted / step)
        over = wanted - out[:, k]
    return out


def _numb(till: Till, strength: float) -> None:
    """Ask more of a first pulse, and take a place higher up its tangent."""
    till.numb = 0.95 * strength


WAVES: dict[str, Callable[[Till, float], None]] = {
    "specular-reflections": _wagons,
    "ground-bounce": _meadow,
    "obstructed-path": _behind_lorries,
    "small-scale-fading": _suzuki,
    "diffuse-tail": _rayleigh_hump,
    "pulse-ringing": _triple_transit,
    "noise-floor": _generators,
    "narrowband-interference": _walking_tone,
    "highest-carry-lost": _carry,
    "runs-of-one-word": _runs,
    "quadrature-fails": _quadrature,
    "quantisation": _shaped,
    "late-detection": _numb,
}
IN_THE_AIR = 5  # of them, before what is of rows


def go_through(till: Till, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms go through effects: those in the air, those of rows, those of the radio."""
    every = list(WAVES)
    for name in every[:IN_THE_AIR]:
        if name in names:
            WAVES[name](till, strength)
    for name in names:
        if name not in WAVES:
            till.deal(EFFECTS[name](till.ticket(), strength))
    for name in every[IN_THE_AIR:]:
        if name in names:
            WAVES[name](till, strength)
