"""One module per kind of kernel; small functions that each write one piece of C."""
