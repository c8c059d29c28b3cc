"""What is compared: rows checked, split by link, observables and covariates."""
