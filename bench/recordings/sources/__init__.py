"""Named data sets. Each source says whether its files are here, how to get them, and reads them."""
