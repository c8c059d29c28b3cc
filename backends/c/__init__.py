"""From an ONNX file to C99 for a microcontroller, and that C compiled for this machine.

`emit.generate` is the entry; `run` compiles what it writes and calls it.
"""
