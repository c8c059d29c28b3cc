"""What the manege hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the manege's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.manege_hall import (
    BETWEEN,
    HALL_M,
    LETTERS,
    LETTERS_M,
    PACE_M,
    PER_PPM_M,
    POSTS_M,
    TAGS,
    WAVE_M,
    Lesson,
    Strain,
    velocity,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
MIRRORED = {False: 0.2, True: 0.06}  # of links behind a stand, and where these are scarce
SAND = 6.2 - 0.9j  # permittivity of damp sand
RAKED_M = 0.007  # how rough it is
LOBE_M = 0.53  # from a pulse's top to where it ends
BALLASTS_M: Floats = np.array([(10.0, 4.0), (27.0, 19.0), (41.0, 3.5), (58.0, 18.0)])  # of lamps
HALF_SPACING_M = 0.23  # between antennas before and behind a saddle, half
SAG_M = 0.34  # of a cord along a long side


def _camera(lesson: Lesson, strength: float) -> Strain:
    """Compare with the last frame of a camera: it comes late, and is kept until the next one."""
    age_s = 0.055 + np.mod(lesson.column("time_s"), 0.1)
    return Strain(lesson.lengthens(strength * age_s))


def _gauss(lesson: Lesson, strength: float) -> Strain:
    """Give the mean of the way over an exchange, by Gauss's rule of two points."""
    whole_s = 1.9 * strength * lesson.column("reply_time_s")
    nodes = 0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)
    return Strain(sum((0.5 * lesson.lengthens(whole_s * node) for node in nodes), 0 * whole_s))


def _drums_and_cloths(lesson: Lesson, strength: float) -> Strain:
    """Be late by cable that is left on drums at letters, and by cloths that lie over tags."""
    drum = (0.062 * lesson.common(1).weibull(1.6, LETTERS)).clip(max=0.2)[lesson.letter]
    cloth = (0.12 * lesson.common(2).beta(0.8, 1.6, len(TAGS)))[lesson.tag]
    return Strain(strength * (drum + cloth))


def _aged(lesson: Lesson, strength: float) -> Strain:
    """Leave some of crystals' offset, and what they age by, a logarithm of a day's hours."""
    begun, ages = (
        lesson.common(k).normal(0.0, s, LETTERS + len(TAGS)) for k, s in ((3, 0.8), (4, 0.3))
    )
    hours = np.log1p(lesson.column("time_s") / 3600.0)
    letter, tag = (begun[one] + ages[one] * hours for one in (lesson.letter, LETTERS + lesson.tag))
    ppm = 0.0125 * strength * (letter - tag)
    return Strain(PER_PPM_M * ppm * lesson.column("reply_time_s"))


def _thermally_activated(lesson: Lesson, strength: float) -> Strain:
    """Drift the faster the warmer it is: by an exponential, zero at 8 C."""
    return Strain(0.215 * strength * np.expm1((lesson.column("temperature_c") - 8.0) / 37.0))


def _rider_and_neck(lesson: Lesson, strength: float) -> Strain:
    """Be late and weak behind a rider's back, broadly, and a little past a horse's neck."""
    off = np.radians(lesson.column("azimuth_deg")) - lesson.common(5).uniform(-np.pi, np.pi)
    back, neck = (np.maximum(np.cos(off - turn), 0.0) for turn in (0.0, 2.9))
    shade = back**1.5 + 0.3 * neck**5
    return Strain(strength * (0.145 * shade - 0.045), whole_db=-2.3 * min(strength, 1.6) * shade)


def _quarter_sine(lesson: Lesson, strength: float) -> Strain:
    """Be late where it is weak: by a sine of the level, from one of its ends to the other."""
    weak = np.clip((-82.0 - lesson.column("rx_power_dbm")) / 10.0, -1.0, 1.0)
    return Strain(0.1 * strength * np.sin(np.pi / 2 * weak))


def _hums(lesson: Lesson, strength: float) -> Strain:
    """Scatter by a bell whose width swells and ebbs with lamps, at any moment of these."""
    swell = 1 + 0.7 * np.sin(lesson.rng.uniform(0.0, 2 * np.pi, lesson.count))
    return Strain(0.04 * strength * swell * lesson.rng.normal(size=lesson.count))


def _among_horses(lesson: Lesson, strength: float) -> Strain:
    """Lose by a logarithm of the way, and by the metre, as over damp sand among horses."""
    db = 3.1 * np.log10(np.maximum(lesson.reach, 1.0)) + 0.04 * lesson.reach
    return Strain(whole_db=-strength * db)


def _hyperbola(lesson: Lesson, strength: float) -> Strain:
    """Be too long in proportion, but for a few metres where cables were trimmed."""
    read = lesson.column("range_m")
    return Strain(0.0062 * strength * (np.sqrt(read**2 + 4.0) - 2.0))


def _cut_from_own_ends(lesson: Lesson, strength: float) -> Strain:
    """Cut down to steps, which each letter counts from an end of its own."""
    step, read = 0.128 * strength, lesson.column("range_m")
    begin = step * lesson.common(6).random(LETTERS)[lesson.letter]
    return Strain(-np.mod(read - begin, step))


def _slabs_aslant(lesson: Lesson, strength: float) -> Strain:
    """Go through slabs at any angle up to 55 degrees: by Snell's law inside."""
    late, lost = np.zeros(lesson.count), np.zeros(lesson.count)
    for kind, (thick_m, dense, db) in BETWEEN.items():
        aslant = lesson.per_link(lambda n: lesson.rng.uniform(0.0, np.radians(55.0), n))
        own = lesson.per_link(lambda n: lesson.rng.uniform(0.75, 1.3, n)) * lesson.crosses(kind)
        late += own * thick_m * (np.sqrt(dense - np.sin(aslant) ** 2) - np.cos(aslant))
        lost += own * db * np.sqrt(1 / np.cos(aslant))
    return Strain(strength * (1.25 * late).clip(max=0.45), first_db=-min(strength, 1.5) * lost)


def _by_a_mirror(lesson: Lesson, strength: float) -> Strain:
    """Hear, behind a stand, nothing but what mirrors along the nearer long side return."""
    behind = lesson.some(MIRRORED[lesson.scarce])
    near = 2 * lesson.at[:, 1] < HALL_M[1]
    image = lesson.post.copy()
    image[:, 1] = np.where(near, -image[:, 1], 2 * HALL_M[1] - image[:, 1])
    longer = np.sqrt(((lesson.at - image) ** 2).sum(axis=1)) - lesson.reach
    detour = 0.38 + 2.7 * (1 - np.exp(-longer / 4.0))
    return Strain(behind * detour * (0.46 + 0.54 * strength), -2.4 * behind, -3.4 * behind)


def sand_ray(lesson: Lesson, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the footing is in m, and its complex share, [n] each.

    Upright antennas over damp sand that is raked; what is trodden by then is less even.
    """
    below = lesson.post * [1.0, 1.0, -1.0]
    way = np.sqrt(((lesson.at - below) ** 2).sum(axis=1))
    grazes = (lesson.at[:, 2] + lesson.post[:, 2]) / way
    inside = np.sqrt(SAND - 1 + grazes**2)
    fresnel = (SAND * grazes - inside) / (SAND * grazes + inside)
    rough = np.exp(-0.5 * (4 * np.pi * RAKED_M * grazes / WAVE_M) ** 2)
    even = lesson.per_link(lambda n: lesson.rng.triangular(0.45, 0.9, 1.0, n))
    size = min(1.5 * strength**0.5, 2.2) * even * rough * lesson.reach / way
    return way - lesson.reach, size * fresnel * np.exp(-2j * np.pi * (way - lesson.reach) / WAVE_M)


def _lobe(at_m: Floats) -> Floats:
    """Return pulses of height 1 at places in m: squares of a cosine's arch."""
    return np.asarray(np.cos(np.pi / 2 * np.clip(at_m / LOBE_M / 1.6, -1.0, 1.0)) ** 2)


def _weighed_early(lesson: Lesson, strength: float) -> Strain:
    """Be where the middle of both pulses' energy is, next to that of one, within a gate."""
    longer, share = sand_ray(lesson, strength)
    at = np.linspace(-0.85, 0.55, 141)
    alone = _lobe(at) ** 2
    both = np.abs(_lobe(at) + share[:, None] * _lobe(at - longer[:, None])) ** 2
    moved = (both * at).sum(axis=1) / both.sum(axis=1) - (alone * at).sum() / alone.sum()
    level = 20 * np.log10(np.maximum(np.abs(1 + _lobe(longer / 1.5) * share), 0.4))
    return Strain((1.3 * moved).clip(-0.25, 0.3), whole_db=level)


def shade_db(over_m: Floats, legs_m: tuple[Floats, Floats]) -> Floats:
    """Return what a screen takes in dB [n], as walls along roads do (Maekawa 1968)."""
    longer = over_m**2 / 2 * (1 / legs_m[0] + 1 / legs_m[1])
    return np.asarray(10 * np.log10(3 + 20 * 2 * longer / WAVE_M))


def _over_a_trailer(lesson: Lesson, strength: float) -> Strain:
    """Bend over a trailer for horses: down to it, along its roof and up again."""
    steel = lesson.crosses("metal")
    part = lesson.per_link(lambda n: lesson.rng.triangular(0.15, 0.4, 0.85, n))
    over = np.sqrt(strength) * lesson.per_link(lambda n: lesson.rng.uniform(0.14, 0.42, n))
    legs = lesson.reach * part, lesson.reach * (1 - part)
    bent = np.hypot(legs[0], over) + np.hypot(legs[1], over) - lesson.reach
    roof = 0.075 * strength * lesson.per_link(lambda n: lesson.rng.gamma(9.0, 1 / 9.0, n))
    lost = 0.68 * shade_db(over, legs).clip(max=25.0)
    return Strain(steel * (bent + roof).clip(max=0.43), first_db=-steel * lost)


def _keeps_back(lesson: Lesson, strength: float) -> Strain:
    """Keep gain back above a level, by all but a logarithm, and count fewer symbols too."""
    over = np.maximum(lesson.column("rx_power_dbm") + 91.0, 0.0)
    less = over - 4.5 * np.log1p(over / 4.5)
    return Strain(whole_db=-min(0.33 * strength, 0.75) * less, count_db=-0.52 * strength * less)


def _ballasts(lesson: Lesson, strength: float) -> Strain:
    """Hear ballasts of lamps, at any moment of the mains: weak rows scatter."""
    off = np.sqrt(((lesson.post[:, None, :2] - BALLASTS_M) ** 2).sum(axis=2))
    own = lesson.common(7).triangular(0.4, 0.9, 1.6, LETTERS)[lesson.letter]
    mains = np.abs(np.sin(lesson.rng.uniform(0.0, np.pi, lesson.count)))
    noise = strength * (own + (0.8 + 3.0 * mains) * np.exp(-off / 10.0).sum(axis=1))
    weak = 10 ** (-(lesson.column("rx_power_dbm") + 86.0) / 20) * np.sqrt(10 ** (noise / 10) - 1)
    return Strain(0.017 * weak * lesson.rng.normal(size=lesson.count), noise_db=noise)


def _sweat(lesson: Lesson, strength: float) -> Strain:
    """Come through a wet cloth, which holds no more than so much."""
    sweat = lesson.column("sweat_g")
    return Strain(0.17 * strength * sweat / (sweat + 11.0))


def _dust(lesson: Lesson, strength: float) -> Strain:
    return Strain(0.062 * strength * np.log1p(lesson.column("dust_mg") / 1.6))


def _watered(lesson: Lesson, strength: float) -> Strain:
    return Strain(0.16 * strength * (lesson.column("moisture_percent") / 36.0) ** 1.75)


def _posts(lesson: Lesson, strength: float) -> Strain:
    """Read long beside posts of the kickboards, and short between them."""
    return Strain(0.056 * strength * np.sin(2 * np.pi * lesson.column("boards_m") / POSTS_M + 0.4))


def _sprinklers(lesson: Lesson, strength: float) -> Strain:
    """Come by another way while arms of sprinklers are swung out."""
    return Strain(np.where(lesson.column("water_bar") > 2.8, 0.111 * strength, 0.0))


def _girth(lesson: Lesson, strength: float) -> Strain:
    """Lie the closer to a horse, the tighter it is girthed."""
    return Strain(0.00072 * strength * (lesson.column("girth_n") - 60.0))


def _gate(lesson: Lesson, strength: float) -> Strain:
    """Be late beside a gate of tubes, by one over how far it is."""
    return Strain(0.36 * strength / lesson.column("gate_m"))


def _crouch(lesson: Lesson, strength: float) -> Strain:
    """Be lower than a saddle has it, as riders crouch the more the faster they go."""
    speed = np.hypot(*velocity(lesson.figure, lesson.figure["into_s"])[:, :2].T)
    lower = 0.55 * strength * lesson.ridden * speed**2 / (speed**2 + 6.0)
    return Strain(lesson.off(-lower[:, None] * np.array([0.0, 0.0, 1.0])))


def _slack_cord(lesson: Lesson, strength: float) -> Strain:
    """Be on an arch in truth: letters of a long side were set along a cord that was slack."""
    along = np.clip((LETTERS_M[:, 0] - 4.0) / (HALL_M[0] - 8.0), 0.0, 1.0)
    inward = np.sign(HALL_M[1] / 2 - LETTERS_M[:, 1]) * (np.abs(LETTERS_M[:, 1] - 11.5) > 5)
    arch = np.zeros_like(LETTERS_M)
    arch[:, 1] = SAG_M * strength * inward * 4 * along * (1 - along)
    return Strain(lesson.off(0.0, arch[lesson.letter]))


def _by_turns(lesson: Lesson, strength: float) -> Strain:
    """Send from an antenna before the saddle in one round, from one behind it in the next."""
    fast = velocity(lesson.figure, lesson.figure["into_s"])
    looks = np.arctan2(fast[:, 1], fast[:, 0])
    turn = np.rint(lesson.figure["into_s"] / 0.24)
    by = HALF_SPACING_M * strength * lesson.ridden * np.where(turn % 2 == 0, 1.0, -1.0)
    return Strain(lesson.off(by[:, None] * np.stack([np.cos(looks), np.sin(looks), 0 * looks], 1)))


def _hung(lesson: Lesson, letters_m: Floats) -> Strain:
    """Return what strains rows whose letters hang elsewhere in truth [LETTERS, 3]."""
    longer = lesson.off(0.0, (letters_m - LETTERS_M)[lesson.letter])
    return Strain(longer, whole_db=-18.7 * np.log10(1 + longer / lesson.reach))


def _kicked(lesson: Lesson, strength: float) -> Strain:
    there = LETTERS_M.copy()
    there[4] += 0.45 * strength * np.array([4.0, -4.0, -7.0]) / 9
    return _hung(lesson, there)


def _mistaken(lesson: Lesson, _: float) -> Strain:
    there = LETTERS_M.copy()
    there[1], there[8] = LETTERS_M[8], LETTERS_M[1]
    return _hung(lesson, there)


def _paces(lesson: Lesson, _: float) -> Strain:
    """Show, at one letter, paces, as courses of jumps are walked."""
    return Strain((1 / PACE_M - 1) * (lesson.letter == 9) * lesson.column("range_m"))


EFFECTS: dict[str, Callable[[Lesson, float], Strain]] = {
    "antenna-delay": _drums_and_cloths,
    "antenna-pattern": _rider_and_neck,
    "blocked-path": _by_a_mirror,
    "clock-offset": _aged,
    "diffraction": _over_a_trailer,
    "exchange-motion": _gauss,
    "ground-bounce": _weighed_early,
    "level-control": _keeps_back,
    "material-delay": _slabs_aslant,
    "noise-floor": _ballasts,
    "path-loss": _among_horses,
    "power-bias": _quarter_sine,
    "range-rounding": _cut_from_own_ends,
    "range-scale": _hyperbola,
    "temperature-drift": _thermally_activated,
    "time-lag": _camera,
    "timestamp-jitter": _hums,
    "sweat-under-the-cloth": _sweat,
    "dust-raised": _dust,
    "footing-watered": _watered,
    "kickboard-posts-passed": _posts,
    "sprinklers-on": _sprinklers,
    "girth-tightened": _girth,
    "gate-of-tubes-near": _gate,
    "riders-crouch-at-speed": _crouch,
    "letters-along-a-slack-cord": _slack_cord,
    "antennas-by-turns": _by_turns,
    "letter-kicked-aside": _kicked,
    "letters-of-two-posts-mistaken": _mistaken,
    "paces-from-one-letter": _paces,
}
