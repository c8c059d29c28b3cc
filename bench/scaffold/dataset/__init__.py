"""Templates of a data set package ($$ stands for one $)."""
