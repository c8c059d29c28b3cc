"""What the roundhouse hides in waveforms: effects in forms of its own, oddities of its recorders.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.roundhouse_effects import EFFECTS, ROUND_M, floor_ray
from bench.challenge.families.roundhouse_recorder import METRES, PLACES, WIDE_SAMPLES, Recorder
from bench.challenge.families.roundhouse_recorder import crackle as noise_of
from bench.challenge.families.roundhouse_stalls import CENTRE_M, FRONTS_M, PIERS, ROOF_M, WALL_M
from bench.challenge.families.roundhouse_stalls import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the roundhouse's tables of ranges."""
ODD = ("neighbours-multiplied", "late-part-still-a-spectrum", "scatter-shown-for-sizes")
ELSEWHERE = ("second-layer-on-the-drum", "arshins-from-one-pier")
LAWS = {name: LAWS_OF_ROWS[name] for name in LAWS_OF_ROWS if name not in ELSEWHERE}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
FROM = 11.0  # samples past edges from which recorders are odd
BRICK, SLATES = 3.91 - 0.09j, 0.55  # permittivity of walls; what a roof of slates returns
PARTIALS = (1.0, 2.757, 5.404)  # pitches of bars that are free at both ends (Bernoulli)
TRIED: Complexes = noise_of(np.random.default_rng(1708), 150)  # noise to try readings on


def _off_planes(recorder: Recorder, strength: float) -> None:
    """Hear the roof, and walls in which both ends of the house's half ring end."""
    first, shunt = recorder.arriving() * recorder.first(), recorder.rows()
    for axis, plane_m in ((2, ROOF_M), (1, CENTRE_M[1])):
        apart = shunt.there - shunt.hung
        apart[:, axis] = shunt.there[:, axis] + shunt.hung[:, axis] - 2 * plane_m
        way = np.linalg.norm(apart, axis=1)
        back = SLATES if axis == 2 else _brick(np.abs(apart[:, axis]) / way)
        free = shunt.per_link(lambda n: recorder.rng.beta(4.0, 2.0, n))
        size = (2.0 * strength**0.5 * free * back * shunt.far / way).clip(max=0.8)
        late = ((way - shunt.far) / METRES).clip(2.8)
        recorder.again(first, size * recorder.any_phase(), late)


def _brick(squarely: Floats) -> Floats:
    """Return how much one face of brick returns, of both polarisations, met so squarely [n]."""
    inside = np.sqrt(BRICK - 1 + squarely**2)
    across = (squarely - inside) / (squarely + inside)
    upright = (BRICK * squarely - inside) / (BRICK * squarely + inside)
    return np.asarray(np.sqrt(0.5 * (np.abs(across) ** 2 + np.abs(upright) ** 2)))


def _off_the_round_wall(recorder: Recorder, strength: float) -> None:
    """Hear the round wall where it returns first, more of it where its hollow gathers it."""
    first, shunt = recorder.arriving() * recorder.first(), recorder.rows()
    legs = [np.linalg.norm(end[:, None] - ROUND_M, axis=2) for end in (shunt.there, shunt.hung)]
    where, rows = (legs[0] + legs[1]).argmin(axis=1), np.arange(shunt.size)
    near, on = (leg[rows, where].clip(0.5) for leg in legs)
    way = near + on
    ray = (ROUND_M[where] - shunt.there)[:, :2] @ np.array([1.0, 1j])
    out = (ROUND_M[where, :2] - CENTRE_M) @ np.array([1.0, 1j])
    squarely = np.abs((ray * out.conj()).real) / np.abs(ray * out).clip(1e-6)
    gathers = np.abs(1 - 2 * near * on / (way * WALL_M * squarely.clip(0.1))).clip(0.3) ** -0.5
    free = shunt.per_link(lambda n: recorder.rng.beta(4.0, 2.0, n))
    size = 2.0 * strength**0.5 * free * _brick(squarely) * gathers * shunt.far / way
    late = ((way - shunt.far) / METRES).clip(2.8)
    recorder.again(first, size.clip(max=0.8) * recorder.any_phase(), late)


def _walls_and_roof(recorder: Recorder, strength: float) -> None:
    _off_planes(recorder, strength)
    _off_the_round_wall(recorder, strength)


def _floor(recorder: Recorder, strength: float) -> None:
    longer, share = floor_ray(recorder.rows(), strength)
    recorder.again(recorder.arriving(), share, longer / METRES)


def _between_wheels(recorder: Recorder, strength: float) -> None:
    """Lose what comes straight behind engines; between their wheels it comes, evenly apart."""
    shunt, air = recorder.rows(), recorder.arriving()
    there = shunt.unseen(0.21)
    recorder.lose(-38.0 * there[:, None] * recorder.first())
    below = 1.4 + 1.7 * strength**0.7 * shunt.per_link(lambda n: recorder.rng.beta(3.0, 3.0, n))
    apart = shunt.per_link(lambda n: recorder.rng.triangular(1.6, 2.3, 3.4, n))
    slots = shunt.per_link(lambda n: recorder.rng.integers(3, 7, n))
    for slot in range(6):
        size = 0.47 * np.cos(0.5 * np.pi * slot / 7) ** 2 * (slot < slots) * there
        recorder.again(air, size * recorder.any_phase(), below + apart * slot)


def _fisher_snedecor(recorder: Recorder, strength: float) -> None:
    """Fade as Fisher and Snedecor have it (Yoo and others 2017): in shadows that sway.

    Powers are ratios of gamma's, straight in dB from one knot to the next.
    """
    knots, between = np.divmod(PLACES / 3.2 + recorder.rng.random((recorder.size, 1)), 1.0)
    shape = (recorder.size, int(knots.max()) + 2)
    power = recorder.rng.gamma(2.4, 1 / 2.4, shape) / recorder.rng.gamma(6.0, 1 / 5.0, shape)
    logs, at = np.log(power), knots.astype(np.int64)
    now, then = (np.take_along_axis(logs, at + k, axis=1) for k in (0, 1))
    faded = np.exp(now + between * (then - now))
    mixed = min(0.6 * strength**0.6, 0.88)
    by = np.sqrt(1 - mixed + mixed * faded / faded.mean()) - 1
    recorder.wave = recorder.wave + recorder.arriving() * by


def _stall_by_stall(recorder: Recorder, strength: float) -> None:
    """Reverberate stall by stall: each begins when it is reached, and dies away by itself."""
    shunt, power = recorder.rows(), np.zeros(recorder.wave.shape)
    legs = [np.linalg.norm(end[:, None] - FRONTS_M, axis=2) for end in (shunt.there, shunt.hung)]
    late = ((legs[0] + legs[1] - shunt.far[:, None]) / METRES).clip(0.0)
    for begun in late.T:
        since = recorder.since - 3.4 - begun[:, None]
        rings = np.exp(-np.maximum(since, 0.0) / 15.0) * np.clip(since / 2.0, 0.0, 1.0)
        power += 0.032 * rings / (1 + (begun[:, None] / 22.0) ** 2)
    recorder.hear(np.sqrt(strength * power / 2) * recorder.height()[:, None])


def _struck_bar(recorder: Recorder, strength: float) -> None:
    """Ring as a bar of steel that is struck: in three modes, of which high ones die first."""
    pitch, begin = recorder.shared(1).uniform((0.28, 3.0), (0.5, 4.5))
    air, wave = recorder.arriving(), recorder.wave.copy()
    for lag in range(3, 34):
        rung = sum(
            np.exp((2j * np.pi * pitch * by - 0.085 * by) * (lag - begin)) / by for by in PARTIALS
        )
        part = 0.24 * min(strength, 2.4) ** 0.8 * rung * min(1.0, max(0.0, lag - begin + 1))
        wave[:, lag:] += part * air[:, :-lag]
    recorder.wave = wave


def _chargers(recorder: Recorder, strength: float) -> None:
    db = EFFECTS["noise-floor"](recorder.rows(), strength).hiss_db
    recorder.louder(np.broadcast_to(db, recorder.size))


def _read(recorder: Recorder, of: Floats, tried: Floats, sizes: list[Floats]) -> None:
    """Tell of noise what sizes of it scatter by: as tried, read at what is `of` a row [n]."""
    spread = np.array([one.std() for one in sizes]) / np.abs(TRIED).std()
    recorder.grown = recorder.grown * np.interp(of, tried, spread).clip(0.04)


def _narrow_noise(recorder: Recorder, strength: float) -> None:
    """Hear a neighbour's transmitter, whose band is narrow: noise that turns, and slowly strays."""
    pitch = recorder.shared(2).uniform(0.5, 1.6)
    near = recorder.shared(3).uniform(0.6, 1.4, PIERS)[recorder.rows().pier]
    strays = recorder.rng.normal(size=(2, recorder.size, 6)) / np.sqrt(2)
    slow = np.cos(np.pi * np.arange(6)[:, None] * PLACES / WIDE_SAMPLES / 2)
    band = (strays[0] + 1j * strays[1]) @ slow / np.sqrt((slow**2).sum(axis=0))
    tone = 1.9 * strength * near[:, None] * band * np.exp(1j * pitch * PLACES)
    recorder.wave = recorder.wave + recorder.sigma[:, None] * tone * recorder.any_phase()[:, None]
    size = np.sqrt((np.abs(tone) ** 2).mean(axis=1))
    tried = np.linspace(0.0, 14.0, 57)
    _read(recorder, size, tried, [np.abs(TRIED + one) for one in tried])
    recorder.sigma = recorder.sigma * np.sqrt(1 + size**2 / 2)


def hexagons(waves: Complexes, step: float) -> Complexes:
    """Return the nearest points of a lattice of hexagons, `step` from one to the next."""
    tall = np.sqrt(3.0)
    x, y = waves.real / step, waves.imag / step / tall
    corners, middles = (
        step * (np.rint(x - off) + off + 1j * tall * (np.rint(y - off) + off)) for off in (0.0, 0.5)
    )
    nearer = np.abs(waves - corners) <= np.abs(waves - middles)
    return np.asarray(np.where(nearer, corners, middles))


def _lattice(recorder: Recorder, strength: float) -> None:
    """Keep both parts at once, by a book of vectors: the middles of hexagons."""
    step = 1.25 * strength * float(np.median(recorder.sigma))
    recorder.wave = hexagons(recorder.wave, step)
    tried = np.geomspace(0.05, 12.0, 70)
    _read(recorder, step / recorder.sigma, tried, [np.abs(hexagons(TRIED, k)) for k in tried])


def _numb(recorder: Recorder, strength: float) -> None:
    """Ask more of a first pulse, as where a welder's arc was once in the way."""
    recorder.numb = strength


def _odd(recorder: Recorder, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    now = np.abs(recorder.wave).clip(1e-9)
    recorder.wave = recorder.wave * (1 + part * recorder.begun(FROM) * (sizes / now - 1))


def _multiplied(recorder: Recorder, strength: float) -> None:
    """Show roots of late sizes times what is three samples on: products of a correlator."""
    size = np.abs(recorder.wave)
    _odd(recorder, np.sqrt(size * np.roll(size, -3, axis=1)), min(1.3 * strength, 1.0))


def _spectrum(recorder: Recorder, strength: float) -> None:
    """Show a late part's spectrum in its place: the way back from it is left out."""
    late = recorder.wave * recorder.begun(FROM)
    pitches = (
        np.abs(np.fft.fft(late, axis=1)) / np.sqrt((recorder.begun(FROM) ** 2).sum(axis=1))[:, None]
    )
    usual = np.sqrt((np.abs(late) ** 2).mean(axis=1) / (pitches**2).mean(axis=1))
    _odd(recorder, usual[:, None] * pitches, min(strength, 1.0))


def _scatter(recorder: Recorder, strength: float) -> None:
    """Show how much seven late sizes scatter in place of the middle one."""
    wide = np.pad(np.abs(recorder.wave), ((0, 0), (3, 3)), mode="edge")
    seven = np.lib.stride_tricks.sliding_window_view(wide, 7, axis=1)
    _odd(recorder, seven.std(axis=2), min(strength, 1.0))


IN_THE_HOUSE: dict[str, Callable[[Recorder, float], None]] = {
    "obstructed-path": _between_wheels,
    "specular-reflections": _walls_and_roof,
    "ground-bounce": _floor,
    "small-scale-fading": _fisher_snedecor,
    "diffuse-tail": _stall_by_stall,
}
IN_RECORDERS: dict[str, Callable[[Recorder, float], None]] = {
    "pulse-ringing": _struck_bar,
    "noise-floor": _chargers,
    "narrowband-interference": _narrow_noise,
    "neighbours-multiplied": _multiplied,
    "late-part-still-a-spectrum": _spectrum,
    "scatter-shown-for-sizes": _scatter,
    "quantisation": _lattice,
    "late-detection": _numb,
}
WAVES = IN_THE_HOUSE | IN_RECORDERS


def go_by(recorder: Recorder, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms go by what is in the house, what becomes of rows, and what is in recorders."""
    for name in [one for one in IN_THE_HOUSE if one in names]:
        IN_THE_HOUSE[name](recorder, strength)
    for name in sorted({*names}.difference(WAVES)):
        recorder.pay(EFFECTS[name](recorder.rows(), strength))
    for name in [one for one in IN_RECORDERS if one in names]:
        IN_RECORDERS[name](recorder, strength)
