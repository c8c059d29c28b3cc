"""What a law looks like to a radio engineer: a suggestion from its form and covariate, no more."""

from __future__ import annotations

from bench.discrepancy.law.material import BEHIND, FACING
from bench.discrepancy.law.structures import Structure

_OVER = {
    ("linear", "true_range_m"): "a clock or unit scale",
    ("linear", "reply_time_s"): "clocks that run apart during the reply",
    ("linear", "temperature_c"): "warming of the radio",
    ("linear", "time_s"): "a drift",
    ("linear", "radial_speed_m_per_s"): "a time shift between truth and ranges",
    ("linear", "clock_offset_ppm"): "a clock offset taken into account wrongly",
    ("logarithm", "true_range_m"): "something that follows the level in dB",
    ("inverse square", "true_range_m"): "something that follows the received power",
    ("inverse", "true_range_m"): "something that follows the received amplitude",
    ("power", "true_range_m"): "something that grows or fades with distance, but not in proportion",
    ("saturation", "true_range_m"): "a bias that levels off at long range",
    ("periodic", "true_range_m"): "two paths that interfere",
    ("periodic", "time_s"): "a cycle: heating, a scheduler, a beat of two clocks",
    ("periodic", "azimuth_deg"): "an antenna's pattern, or one that does not turn about its centre",
    ("periodic", FACING): "an antenna beside the centre that its device turns about (a lever arm)",
    ("step", "time_s"): "something that was changed at that time",
    ("parabola", "temperature_c"): "a crystal's turning point",
}
_FORM = {
    "constant": "a delay that was not calibrated",
    "linear": "something in proportion to it",
    "power": "something that grows or fades with it",
    "inverse": "something that fades with it",
    "inverse square": "something that fades with its square",
    "logarithm": "something that follows its ratio",
    "saturation": "something that levels off",
    "relaxation": "settling after the start: warm-up",
    "step": "two regimes",
    "periodic": "something that repeats",
    "parabola": "something with a turning point",
    "rounding": "a coarse register or print-out",
    "position": "a plan that is wrong, or an anchor that was moved",
    "plan": "a drawing or a survey whose axes or scale are off",
    "swap": "two labels exchanged",
    "ceiling": "a register or a filter of the firmware that cuts ranges off",
    "floor": "a survey in two dimensions",
    "unit": "a unit",
}


def looks_like(structure: Structure) -> str:
    """Return what a law looks like."""
    over = structure.columns[0] if structure.columns else ""
    if structure.form == "constant" and structure.where.startswith(BEHIND):
        return "a delay in what stands there, or a detour around it"
    said = _OVER.get((structure.form, over), _FORM[structure.form])
    return f"{said}, of a part of the rows alone" if structure.where and over == "" else said
