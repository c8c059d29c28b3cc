"""Effects a diagnosis fits beyond the library: values per device, curves, the unnamed one."""
