"""Templates of a device plug-in."""
