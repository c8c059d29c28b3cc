"""A fitted model as files that leave the bench: C for a microcontroller, or ONNX.

chosen = from_run("1a2b..", Path("results"))    # or from_fit("remnet", "int8", "rooms", ..)
export(chosen, "c", Path("firmware"))
"""

from bench.export.chosen import Chosen, from_fit, from_run
from bench.export.write import Exported, Format, check_folder, export

__all__ = ["Chosen", "Exported", "Format", "check_folder", "export", "from_fit", "from_run"]
