"""Effects a diagnosis fits beyond the library: values per device, curves, the unnamed one.

They are ordinary effects, so a simulator written by a diagnosis runs anywhere `bench simulate`
does.
"""
