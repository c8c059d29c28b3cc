"""What the saltworks hide in waveforms: effects in forms of their own, oddities of their gauges.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.saltworks_effects import EFFECTS, off_the_ground
from bench.challenge.families.saltworks_gauge import METRES, PLACES, WIDE_SAMPLES, Gauge, lapping
from bench.challenge.families.saltworks_pans import LAWS as LAWS_OF_ROWS
from bench.challenge.families.saltworks_pans import VANES, WAVE_M, WORKS_M, Haul

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "late-part-left-as-residues", "sixteens-in-order-of-reversed-bits", "remainders-carried-on",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["ken-from-one-vane"]
LATE = 10.0  # samples past first paths from which gauges are odd
FACES: tuple[tuple[int, float, float, complex], ...] = (
    (0, -2.6, 7.5, 3.91 - 0.11j), (0, WORKS_M[0] + 3.4, 9.0, 90.0 - 900.0j),
    (1, -2.2, 6.0, 1.99 - 0.4j), (1, WORKS_M[1] + 2.7, 8.5, 3.91 - 0.11j),
)  # fmt: skip
"""The boiling house, a store of steel, a palisade, a mill: axis, where, how high in m, what of."""
ORDERS, STAVE_M, DUTY = 6, 0.16, 0.42  # of a fence; from stave to stave; part that is open
ALIKE_FOR = 4  # samples for which two clusters last
UNLIKE = 0.45  # of what one part scatters, the other does
PACE, LONG, STEEP = 11.0, 55.0, 0.85  # samples; samples; of tails, between both
RING, BEGINS, RADIANS, DIES = 34, 1.0, 0.62, 17.0  # samples; samples; a sample; samples to 1 / e
BIT, SWING, SOFT = 11, 0.3, 3.0  # samples a bit; radians a sample; samples that edges last
WINDOW = 6  # samples in which noise is read
BLOCK = 16  # of sizes in order of their numbers' bits reversed
TRIED: Complexes = lapping(np.random.default_rng(2608), 140)  # noise to try readings on


def leontovich(dense: complex, straight: Floats) -> Floats:
    """Return what faces return of waves that come so straight [n]: by impedance (1948)."""
    opposes = 1 / np.sqrt(dense)
    ways = [(straight - opposes) / (straight + opposes),
            (opposes * straight - 1) / (opposes * straight + 1)]  # fmt: skip
    return np.asarray(np.sqrt(np.mean(np.abs(ways) ** 2, axis=0)))


def by_a_face(haul: Haul, axis: int, face_m: float) -> tuple[Floats, Floats, Floats]:
    """Return ways by a face in m, how high on it these are, and how straight [n]."""
    image = haul.below.copy()
    image[:, axis] = 2 * face_m - image[:, axis]
    run = haul.above - image
    way = np.linalg.norm(run, axis=1)
    part = np.abs(image[:, axis] - face_m) / np.abs(run[:, axis]).clip(1e-6)
    return way, image[:, 2] + part * run[:, 2], np.abs(run[:, axis]) / way


def _faces(gauge: Gauge, strength: float) -> None:
    """Hear the boiling house, a store, a palisade and a mill, by images, as high as they are."""
    haul, direct = gauge.haul(), gauge.came() * gauge.foremost()
    for axis, face_m, high_m, dense in FACES:
        way, high, straight = by_a_face(haul, axis, face_m)
        bare = haul.each(lambda n: gauge.rng.beta(4.0, 2.0, n))
        back = 1.8 * np.sqrt(strength) * leontovich(dense, straight) * bare
        share = np.where(high < high_m, back * haul.far / way, 0.0).clip(max=0.8)
        gauge.once_more(direct, share * gauge.spun(), ((way - haul.far) / METRES).clip(2.6))


def _ground(gauge: Gauge, strength: float) -> None:
    longer, share = off_the_ground(gauge.haul(), strength)
    gauge.once_more(gauge.came(), share, longer / METRES)


def order_m(order: int, behind: Floats) -> Floats:
    """Return how much longer a grating's order comes than the straight one, in m [n]."""
    sine = order * WAVE_M / (STAVE_M * 3.2)
    return np.asarray(behind * (1 / np.sqrt(1 - sine**2) - 1))


def _fence(gauge: Gauge, strength: float) -> None:
    """Lose what comes straight behind things: a fence's staves send it on by orders of a grating.

    The higher one is, the later and the weaker: by how wide gaps are (Fraunhofer).
    """
    haul, air = gauge.haul(), gauge.came()
    hidden = haul.shut_off(0.2)
    gauge.weaken(-35.0 * hidden[:, None] * gauge.foremost())
    behind = haul.each(lambda n: gauge.rng.uniform(4.0, 9.0, n)) * (0.45 + 0.55 * strength**0.7)
    for order in range(1, ORDERS):
        loud = 0.85 * np.abs(np.sinc(order * DUTY)) ** 0.5 * gauge.rng.uniform(0.4, 0.9, gauge.rows)
        late = 0.9 + 1.3 * strength**0.7 + order_m(order, behind) / METRES
        gauge.once_more(air, hidden * loud * gauge.spun(), late)


def _clustered(gauge: Gauge) -> Floats:
    """Return sizes of chance, of power 1: two clusters whose parts are unlike [n, k]."""
    count = WIDE_SAMPLES // ALIKE_FOR + 3
    parts = gauge.rng.normal(size=(2, 2, gauge.rows, count)) ** 2
    power = (parts[0] + UNLIKE * parts[1]).sum(axis=0) / (2 + 2 * UNLIKE)
    place = PLACES / ALIKE_FOR + gauge.rng.random((gauge.rows, 1))
    low = place.astype(np.int64)
    left, right = (np.take_along_axis(power, low + k, axis=1) for k in (0, 1))
    return np.asarray(np.sqrt(left + (place - low) * (right - left)))


def _eta_mu(gauge: Gauge, strength: float) -> None:
    """Fade as eta and mu have it (Yacoub 2007): two clusters, whose parts scatter unlike."""
    by = _clustered(gauge) ** min(0.9 * strength**0.5, 1.6)
    gauge.wave = gauge.wave + gauge.came() * (by / np.sqrt((by**2).mean()) - 1)


def _schechter(gauge: Gauge, strength: float) -> None:
    """Reverberate by a power of the time since at first, at last exponentially (Schechter 1976)."""
    since = gauge.off.clip(0.0)
    power = 0.021 * (1 + since / PACE) ** -STEEP * np.exp(-since / LONG) * gauge.from_(3.4, 3.5)
    gauge.hear(np.sqrt(0.5 * strength * power) * gauge.tall()[:, None])


def bessel(at: Floats) -> Floats:
    """Return Bessel's J0 at places [n]: the mean of a cosine round a circle."""
    round_ = np.cos(np.pi * (np.arange(48) + 0.5) / 48)
    return np.asarray(np.cos(at[:, None] * round_).mean(axis=1))


def _hanging(gauge: Gauge, strength: float) -> None:
    """Ring as a chain does that hangs on the vane: by Bessel's J0, which falls by a root."""
    turn, slew = gauge.same(1).uniform((0.0, -0.5), (2 * np.pi, 0.5))
    lags = np.arange(RING)
    taps = (
        0.26
        * min(strength, 2.4) ** 0.8
        * bessel(np.asarray(RADIANS * (lags - BEGINS), np.float64))
        * (lags > BEGINS)
    )
    taps = taps * np.exp(-lags / DIES + 1j * (turn + slew * lags))
    size = WIDE_SAMPLES + RING
    spectrum = np.fft.fft(gauge.came(), size, axis=1) * np.fft.fft(taps, size)
    gauge.wave = gauge.wave + np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES]


def _mills(gauge: Gauge, strength: float) -> None:
    gauge.roar(EFFECTS["noise-floor"](gauge.haul(), strength)["noise"] + np.zeros(gauge.rows))


def read_noise(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter within windows of WINDOW, as gauges tell of noise."""
    whole = sizes[:, : WINDOW * (sizes.shape[1] // WINDOW)]
    return float(np.sqrt(whole.reshape(len(sizes), -1, WINDOW).var(axis=2).mean()))


def _tell(gauge: Gauge, of: Floats, tried: Floats, heard: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    found = np.array([read_noise(np.abs(heard(float(one)))) for one in tried])
    by = np.interp(of, tried, found / read_noise(np.abs(TRIED)))
    gauge.by_noise = gauge.by_noise * by.clip(0.05)


def keyed(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers whose pitch is keyed by bits, with soft edges (GFSK) [rows, WIDE_SAMPLES]."""
    bits = rng.choice([-1.0, 1.0], (rows, WIDE_SAMPLES // BIT + 3))
    begin = rng.integers(0, BIT, rows)[:, None]
    index = (np.arange(WIDE_SAMPLES + 2 * BIT) + begin) // BIT
    raw = np.take_along_axis(bits, index.clip(0, bits.shape[1] - 1), axis=1)
    bell = np.exp(-0.5 * (np.arange(-BIT, BIT + 1) / SOFT) ** 2)
    size = raw.shape[1] + 2 * BIT
    spectrum = np.fft.rfft(raw, size, axis=1) * np.fft.rfft(bell / bell.sum(), size)
    pitch = SWING * np.fft.irfft(spectrum, size, axis=1)[:, 2 * BIT : 2 * BIT + WIDE_SAMPLES]
    return np.asarray(np.exp(1j * (np.cumsum(pitch, axis=1) + rng.uniform(0, 6.28, (rows, 1)))))


def _tide_gauge(gauge: Gauge, strength: float) -> None:
    """Hear a tide gauge's telemetry: a carrier whose pitch is keyed softly, some vanes more."""
    drawn = gauge.same(2)
    pitch, near = drawn.uniform(-1.1, 1.1), drawn.triangular(0.5, 0.9, 1.7, VANES)
    size = 1.45 * strength * near[gauge.haul().vane]
    tone = keyed(gauge.rng, gauge.rows) * np.exp(1j * pitch * PLACES)
    gauge.wave = gauge.wave + (gauge.sigma * size)[:, None] * tone
    some = np.resize(tone, TRIED.shape)
    _tell(gauge, size, np.linspace(0.0, 16.0, 49), lambda one: TRIED + one * some)
    gauge.sigma = gauge.sigma * np.sqrt(1 + 0.5 * size**2)


def aslant(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of whose parts the sum and the difference are whole steps."""
    both, apart = waves.real + waves.imag, waves.real - waves.imag
    both, apart = (step * np.rint(one / step) for one in (both, apart))
    return np.asarray((both + apart) / 2 + 1j * (both - apart) / 2)


def _aslant(gauge: Gauge, strength: float) -> None:
    """Convert sums and differences of both parts, each to whole steps."""
    step = 1.5 * strength * float(np.median(gauge.sigma))
    gauge.wave = aslant(gauge.wave, step)
    tried = np.geomspace(0.05, 12.0, 60)
    _tell(gauge, step / gauge.sigma, tried, lambda one: aslant(TRIED, one))


def _deaf(gauge: Gauge, strength: float) -> None:
    """Ask more of first tops, as where a winch's brushes once were in the way."""
    gauge.deaf = strength


def _shown(gauge: Gauge, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    late, was = min(part, 1.0) * gauge.from_(LATE), np.abs(gauge.wave)
    gauge.wave = gauge.wave * ((1 - late) + late * sizes / was.clip(1e-9))


def residues(sizes: Floats) -> Floats:
    """Return by how much sizes differ from lines through both before them [n, k]."""
    before, twice = (np.pad(sizes, ((0, 0), (k, 0)), "edge")[:, :-k] for k in (1, 2))
    return np.asarray(np.abs(sizes - (2 * before - twice)))


def _residues(gauge: Gauge, strength: float) -> None:
    """Leave, of late sizes, what a coder keeps that has guessed them by lines."""
    _shown(gauge, residues(np.abs(gauge.wave)), 0.85 * strength)


def reversed_bits(count: int) -> Integers:
    """Return in which order numbers below BLOCK are read, block by block [count]."""
    number = np.arange(BLOCK)
    order = sum((number >> k & 1) << (3 - k) for k in range(4))
    blocks = np.arange(0, count - BLOCK + 1, BLOCK)
    whole = (blocks[:, None] + order).ravel()
    return np.concatenate([whole, np.arange(len(whole), count)])


def _reversed(gauge: Gauge, strength: float) -> None:
    """Read late sizes in the order in which a fast transform leaves them."""
    begin = int(np.median(gauge.at) + LATE)
    order = np.concatenate([np.arange(begin), begin + reversed_bits(WIDE_SAMPLES - begin)])
    _shown(gauge, np.abs(gauge.wave)[:, order], strength)


def carried(sizes: Floats, step: Floats) -> Floats:
    """Return sizes [n, k] in whole steps [n], with what is left over added to the next."""
    return np.asarray(step[:, None] * np.diff(np.rint(np.cumsum(sizes, axis=1) / step[:, None]),
                                              axis=1, prepend=0.0))  # fmt: skip


def _carried(gauge: Gauge, strength: float) -> None:
    """Write late sizes in coarse steps, and carry each one's remainder on."""
    step = 7.0 * gauge.sigma * min(strength, 2.5) ** 0.5
    _shown(gauge, carried(np.abs(gauge.wave), step), 0.9 * strength)


WAVES: dict[str, Callable[[Gauge, float], None]] = {
    "obstructed-path": _fence, "specular-reflections": _faces, "ground-bounce": _ground,
    "small-scale-fading": _eta_mu, "diffuse-tail": _schechter, "pulse-ringing": _hanging,
    "noise-floor": _mills, "narrowband-interference": _tide_gauge,
    IN_LATE_SIZES[0]: _residues, IN_LATE_SIZES[1]: _reversed, IN_LATE_SIZES[2]: _carried,
    "quantisation": _aslant, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they owe once waves have been AT_THE_WORKS, before gauges see them."""
AT_THE_WORKS = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in (*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding")
)  # fmt: skip
"""Effects that are those of the works' tables of ranges."""


def put_in(gauge: Gauge, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is at the works, what rows owe, and what gauges do."""
    own = [name for name in WAVES if name in names]
    for name in own:
        if name in AT_THE_WORKS:
            WAVES[name](gauge, strength)
    for name in sorted({*names} - {*own}):
        gauge.owe(EFFECTS[name](gauge.haul(), strength))
    for name in own:
        if name not in AT_THE_WORKS:
            WAVES[name](gauge, strength)
