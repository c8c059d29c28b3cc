"""The Makefile beside exported C: the self-test on this machine, and the size of the object."""

from __future__ import annotations


def makefile() -> str:
    """Return the text of the Makefile."""
    return "\n".join(
        [
            "# make         builds and runs the self-test on this machine",
            "# make object  compiles uwb_predict.o alone; for a Cortex-M4F:",
            "#   make object CC=arm-none-eabi-gcc \\",
            "#     ARCH='-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16'",
            "CC ?= cc",
            "ARCH ?=",
            "CFLAGS ?= -O2",
            "# -ffp-contract=off: sums rounded as they were when agreement was checked",
            "STRICT = -std=c99 -Wall -Wextra -Wconversion -pedantic",
            "FLAGS = $(STRICT) $(CFLAGS) $(ARCH) -ffp-contract=off -fno-math-errno",
            "",
            ".PHONY: test object clean",
            "",
            "test: uwb_selftest",
            "\t./uwb_selftest",
            "",
            "uwb_selftest: uwb_selftest.c uwb_predict.c uwb_predict.h",
            "\t$(CC) $(FLAGS) -o $@ uwb_selftest.c uwb_predict.c",
            "",
            "object: uwb_predict.o",
            "",
            "uwb_predict.o: uwb_predict.c uwb_predict.h",
            "\t$(CC) $(FLAGS) -c -o $@ uwb_predict.c",
            "",
            "clean:",
            "\trm -f uwb_selftest uwb_predict.o",
            "",
        ]
    )


def licence() -> str:
    """Return the note on what may be done with exported files."""
    return "\n".join(
        [
            "uwb_predict.c and uwb_predict.h were written by uwb-bench, which is licensed under",
            "the Apache License 2.0 (https://www.apache.org/licenses/LICENSE-2.0); you may use",
            "them under the same terms. The polynomials of exp and log, where they are in it, are",
            "those of the Cephes library (S. Moshier), free for any use.",
            "",
            "The constants are a model trained on the data set named in REPORT.md, and the rows of",
            "uwb_selftest.c are ten of its recordings: the licence of that data set applies to",
            "them. Leave uwb_selftest.c out of what you pass on where it does not allow that.",
            "",
        ]
    )
