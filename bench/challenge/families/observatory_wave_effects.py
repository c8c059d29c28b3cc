"""What the observatory hides in waveforms: effects in forms of their own, oddities of its plates.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.observatory_effects import EFFECTS, off_the_floor
from bench.challenge.families.observatory_hall import HALL_M, SCONCES, Exposure
from bench.challenge.families.observatory_hall import LAWS as LAWS_OF_ROWS
from bench.challenge.families.observatory_plate import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Plate,
    sky,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "charges-trail-from-size-to-size", "wells-spill-to-both-sides", "faint-ones-clipped-by-sigmas",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["canne-from-one-sconce"]
LATE = 8.0  # samples past first paths from which plates are odd
PLASTER, MARBLE, GLASS = 2.73, 7.074, 6.31  # permittivities of walls
WALLS: tuple[tuple[int, float, float], ...] = (
    (0, 0.0, MARBLE), (0, HALL_M[0], PLASTER), (1, 0.0, PLASTER), (1, HALL_M[1], GLASS),
    (2, HALL_M[2], PLASTER),
)  # fmt: skip
"""Which axis walls and the roof are square to, where they are in m, of what."""
NEXT = 3.0  # samples past which walls are heard
PIER_M, GRIPS, LAPS = 0.42, 0.5, 4  # half of an iron pier; nepers a radian; how often round
ALIKE_FOR = 5  # samples for which chances are alike
SLOW, STRETCHED = 13.0, 0.62  # samples; power of time in tails
RING, CUTOFF, BEGINS, DIES = 38, 0.9, 3.0, 14.0  # samples; radians each; samples; to 1 / e
CHIP, SWINGS = 7, 0.55  # samples a chip of a time signal's phase; radians that it goes either way
WINDOW = 5  # samples in which noise is read
LEFT = 0.4  # of a charge that is not passed on
TRIED: Complexes = sky(np.random.default_rng(2708), 140)  # noise to try readings on
REGISTER = 511  # chips until a phase goes as before


def returned(dense: float, straight: Floats) -> Floats:
    """Return what walls return of waves that come so straight [n], in size, of both ways mixed.

    By angles of what comes and of what goes on, whose sines have the ratio of refraction (Fresnel).
    """
    comes = np.arccos(straight.clip(1e-4, 1 - 1e-4))
    goes = np.arcsin(np.sin(comes) / np.sqrt(dense))
    across = np.sin(comes - goes) / np.sin(comes + goes)
    along = np.tan(comes - goes) / np.tan(comes + goes)
    return np.asarray(np.hypot(across, along) / np.sqrt(2))


def by_walls(shot: Exposure, walls: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return ways in m by a wall or by two that meet, and what these return, [n] each."""
    image, left = shot.inner.copy(), np.ones(shot.rows)
    for axis, where, _ in (WALLS[k] for k in walls):
        image[:, axis] = 2 * where - image[:, axis]
    run = shot.outer - image
    way = np.sqrt((run**2).sum(axis=1))
    for axis, _, dense in (WALLS[k] for k in walls):
        left = left * returned(dense, np.abs(run[:, axis]) / way)
    return way, left


def _walls(plate: Plate, strength: float) -> None:
    """Hear four walls and the roof, and the corners between these, by images.

    What a wall right behind an antenna returns is its antenna's own.
    """
    shot, direct = plate.shot(), plate.by_air() * plate.leading()
    corners = [*product((0, 1), (2, 3)), *((k, 4) for k in range(4))]
    for walls in [*((k,) for k in range(5)), *corners]:
        way, left = by_walls(shot, walls)
        bare = shot.per_link(lambda n: plate.rng.uniform(0.25, 1.0, n))
        late = (way - shot.far) / METRES
        share = 1.5 * np.sqrt(strength) * bare * left * shot.far / way * (late > NEXT)
        plate.repeat(direct, share.clip(max=0.8) * plate.phases(), late)


def _floor(plate: Plate, strength: float) -> None:
    longer, share = off_the_floor(plate.shot(), strength)
    plate.repeat(plate.by_air(), share, longer / METRES)


def round_the_pier(turned: Floats, half_m: Floats) -> tuple[Floats, Floats]:
    """Return how much later waves are that have crept so far round, in m, and how much is left.

    `turned` in radians [n], round a pier of half `half_m` [n].
    """
    return turned * half_m, np.exp(-GRIPS * turned)


def _crept(plate: Plate, strength: float) -> None:
    """Lose what comes straight behind things: what is left creeps round a pier, both ways."""
    shot, air = plate.shot(), plate.by_air()
    hidden = shot.cut_off(0.2)
    plate.dim(-36.0 * hidden[:, None] * plate.leading())
    half = PIER_M * shot.per_link(lambda n: plate.rng.uniform(0.7, 1.5, n))
    nearer = shot.per_link(lambda n: plate.rng.uniform(0.5, 2.0, n))
    for lap, side in product(range(LAPS), (0, 1)):
        turned = lap * np.pi + np.where(side, np.pi - 0.4 * nearer, nearer)
        late, left = round_the_pier(turned, half * (0.4 + 0.6 * strength**0.7))
        loud = hidden * left * plate.rng.uniform(0.6, 1.2, plate.rows)
        plate.repeat(air, loud * plate.phases(), 0.9 + 1.0 * strength**0.7 + late / METRES)


def _drifting(plate: Plate, power: Floats) -> Floats:
    """Return chances, ALIKE_FOR samples apart [n, m], at all samples, from one to the next."""
    place = PLACES / ALIKE_FOR + plate.rng.random((plate.rows, 1))
    low = np.floor(place).astype(np.int64)
    near = [np.take_along_axis(power, low + k, axis=1) for k in (0, 1)]
    return np.asarray(near[0] + (place - low) * (near[1] - near[0]))


def _k_law(plate: Plate, strength: float) -> None:
    """Fade by Jakeman's and Pusey's K law (1976): speckle of patches that are unlike themselves."""
    count = WIDE_SAMPLES // ALIKE_FOR + 3
    patches = plate.rng.gamma(1.6, 1 / 1.6, (plate.rows, count))
    power = _drifting(plate, patches * plate.rng.exponential(1.0, patches.shape))
    by = power ** min(0.34 * strength**0.5, 0.7)
    plate.wave = plate.wave + plate.by_air() * (by / np.sqrt(np.mean(by**2)) - 1)


def _stretched(plate: Plate, strength: float) -> None:
    """Reverberate by a stretched exponential, as of many unlike ones (Kohlrausch 1854)."""
    since = plate.since.clip(0.0) / SLOW
    power = 0.023 * np.exp(-(since**STRETCHED)) * plate.past(3.2, 3.4)
    plate.fog(np.sqrt(0.5 * strength * power) * plate.peak()[:, None])


def guided() -> Floats:
    """Return what a tube leaves of a blow, sample by sample [RING]: above its cutoff alone.

    Its phase goes by a root of squares: at first fast, then ever nearer to the cutoff.
    """
    lags = np.arange(RING, dtype=np.float64)
    since = np.sqrt((lags**2 - BEGINS**2).clip(0.0))
    tone = np.cos(CUTOFF * since) * np.sqrt(BEGINS / lags.clip(BEGINS))
    return np.asarray((lags > BEGINS - 1) * tone * np.exp(-lags / DIES))


def _tube(plate: Plate, strength: float) -> None:
    """Ring as the tube that antennas are in: a guide of waves."""
    turn = plate.alike(1).uniform(0.0, 2 * np.pi)
    part = 0.36 * min(strength, 2.4) ** 0.8 * np.exp(1j * turn)
    air, more = plate.by_air(), np.zeros_like(plate.wave)
    for lag, tap in enumerate(guided()):
        more[:, lag:] += tap * air[:, : WIDE_SAMPLES - lag]
    plate.wave = plate.wave + part * more


def _drive(plate: Plate, strength: float) -> None:
    plate.brighten_ground(
        EFFECTS["noise-floor"](plate.shot(), strength).noise_db + np.zeros(plate.rows)
    )


def read_noise(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter in windows of WINDOW, as plates tell of noise."""
    count = sizes.shape[1] // WINDOW
    windows = sizes[:, : count * WINDOW].reshape(-1, WINDOW)
    return float(np.sqrt(windows.var(axis=1, ddof=1).mean()))


def _tell(plate: Plate, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    read = [read_noise(np.abs(made(float(one)))) for one in tried]
    by = np.interp(of, tried, read) / read_noise(np.abs(TRIED))
    plate.told_noise = plate.told_noise * by.clip(0.05)


def chips() -> Floats:
    """Return chips of 1 and -1 that a register of nine bits gives until it begins anew [511]."""
    state, made = 1, []
    for _ in range(REGISTER):
        made.append(2.0 * (state & 1) - 1.0)
        state = state >> 1 | ((state ^ state >> 4) & 1) << 8
    return np.array(made)


def time_signal(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers whose phase goes to and fro by chips, as DCF77's does [rows, k]."""
    begin = rng.integers(0, REGISTER * CHIP, (rows, 1))
    place = (begin + np.arange(WIDE_SAMPLES)) // CHIP % REGISTER
    phase = SWINGS * chips()[place] + rng.uniform(0.0, 2 * np.pi, (rows, 1))
    return np.asarray(np.exp(1j * phase))


def _signal(plate: Plate, strength: float) -> None:
    """Hear a sender of time signals, some sconces more."""
    drawn = plate.alike(2)
    pitch, near = drawn.uniform(-1.2, 1.2), drawn.gamma(9.0, 1 / 9.0, SCONCES).clip(0.5, 1.8)
    size = 1.5 * strength * near[plate.shot().sconce]
    tone = time_signal(plate.rng, plate.rows) * np.exp(1j * pitch * PLACES)
    plate.wave = plate.wave + (size * plate.sigma)[:, None] * tone
    some = np.resize(tone, TRIED.shape)
    _tell(plate, size, np.linspace(0.0, 16.0, 49), lambda one: TRIED + one * some)
    plate.sigma = plate.sigma * np.sqrt(1 + size**2 / 2)


def combed(waves: Complexes, step: float) -> Complexes:
    """Return waveforms at the nearest cells' middles of a honeycomb whose cells are so wide.

    These are those of two lattices of rectangles, of which the nearer is taken.
    """
    tall = step * np.sqrt(3.0)
    found = []
    for shift in (0.0, 0.5):
        across = step * (np.rint(waves.real / step - shift) + shift)
        found.append(across + 1j * tall * (np.rint(waves.imag / tall - shift) + shift))
    nearer = np.abs(waves - found[0]) <= np.abs(waves - found[1])
    return np.asarray(np.where(nearer, found[0], found[1]))


def _combed(plate: Plate, strength: float) -> None:
    """Convert by a honeycomb of grains."""
    step = 1.5 * strength * float(np.median(plate.sigma))
    plate.wave = combed(plate.wave, step)
    _tell(plate, step / plate.sigma, np.geomspace(0.05, 12.0, 60), lambda one: combed(TRIED, one))


def _deaf(plate: Plate, strength: float) -> None:
    """Ask more of first tops, as where lamps were too near once."""
    plate.deaf = strength


def _shown(plate: Plate, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    late = min(part, 1.0) * plate.past(LATE)
    by = sizes / np.maximum(np.abs(plate.wave), 1e-9)
    plate.wave = plate.wave * (1 + late * (by - 1))


def trailed(sizes: Floats, left: float) -> Floats:
    """Return sizes [n, k], each of which leaves a part to the next, which does so again."""
    made = sizes.copy()
    for place in range(1, sizes.shape[1]):
        made[:, place] = (1 - left) * sizes[:, place] + left * made[:, place - 1]
    return made


def _trailed(plate: Plate, strength: float) -> None:
    """Pass late sizes from well to well as charges, some of which stay behind."""
    _shown(plate, trailed(np.abs(plate.wave), min(LEFT * (1 + 0.4 * strength), 0.85)),
           1.1 * strength)  # fmt: skip


def spilled(sizes: Floats, full: Floats) -> Floats:
    """Return sizes [n, k] of which none holds more than is full [n]: half spills to each side."""
    over = (sizes - full[:, None]).clip(0.0)
    sides = np.pad(over / 2, ((0, 0), (2, 2)))
    return np.asarray(sizes - over + sides[:, :-4] + sides[:, 4:])


def _spilled(plate: Plate, strength: float) -> None:
    """Let wells that are full spill two samples to both sides."""
    _shown(plate, spilled(np.abs(plate.wave), 1.1 * plate.sigma), strength)


def clipped(sizes: Floats, times: float) -> Floats:
    """Return sizes [n, k]: mean those of a dozen that are further from it than so many sigmas."""
    wide = np.pad(sizes, ((0, 0), (6, 5)), "edge")
    windows = np.lib.stride_tricks.sliding_window_view(wide, 12, axis=1)
    mean, sigma = windows.mean(axis=2), windows.std(axis=2)
    return np.where(np.abs(sizes - mean) > times * sigma, mean, sizes)


def _clipped(plate: Plate, strength: float) -> None:
    """Clip late sizes by sigmas, as if what is unlike its neighbours were cosmic rays."""
    _shown(plate, clipped(np.abs(plate.wave), 0.8), strength)


WAVES: dict[str, Callable[[Plate, float], None]] = {
    "obstructed-path": _crept, "specular-reflections": _walls, "ground-bounce": _floor,
    "small-scale-fading": _k_law, "diffuse-tail": _stretched, "pulse-ringing": _tube,
    "noise-floor": _drive, "narrowband-interference": _signal,
    IN_LATE_SIZES[0]: _trailed, IN_LATE_SIZES[1]: _spilled, IN_LATE_SIZES[2]: _clipped,
    "quantisation": _combed, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they do once waves have been IN_THE_HALL, before plates see them."""
IN_THE_HALL = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the observatory's tables of ranges."""


def put_in(plate: Plate, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows bear, and what plates do."""
    for name in WAVES:
        if name in names and name in IN_THE_HALL:
            WAVES[name](plate, strength)
    for name in sorted({*names} - {*WAVES}):
        plate.bear(EFFECTS[name](plate.shot(), strength))
    for name in WAVES:
        if name in names and name not in IN_THE_HALL:
            WAVES[name](plate, strength)
