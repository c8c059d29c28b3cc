"""Templates of a model package ($$ stands for one $)."""
