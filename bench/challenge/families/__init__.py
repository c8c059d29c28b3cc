"""Makers of recordings and simulated tables that share no code with the library or each other.

Each family is a world of its own (geometry, radio, forms of every effect), written with numpy
and pandas alone, so that a diagnosis is proven on input its own generator did not make. A family
is a module with KNOWN (effects it can hide), LAWS (what it can hide that no library has), CAUSES
(the covariate each acts through), RARELY (whose cause it can make rare) and `tables(drawn, seed)`;
those that change another simulator's rows have `known(drawn, seed)` and `hidden_in` or `conceal`.
What a long one can hide is in a module beside it, `<family>_effects`; the waveforms of a family
that is asked for both are in `<family>_waves`.
"""
