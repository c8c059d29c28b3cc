"""Seeded hostile input for every command: tables, simulators, result files, plug-ins, options.

    make fuzz                                       # 600 cases
    python -m tests.fuzz --cases 100 --seed 3       # others
    python -m tests.fuzz --only 17 --seed 3         # one again, its output shown

Asked of every case: exit code 0 or 2, no traceback, no Python warning, no control character in the
output, at most one line of error, JSON where JSON was asked for, an end within 60 seconds (of
processor time where a busy machine gives it less), nothing half-written and no input changed. A
case is made from its seed and number alone.

Most cases run in a fork of a process that has imported everything (a tenth of a second each); one
in twenty as a Python of its own, as a user starts it.
"""
