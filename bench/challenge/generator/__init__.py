"""Makes concealed cases: hidden physics in recordings that otherwise are the simulator's own.

Shares no code with `bench.physics` (an import contract holds it to that) and uses other functional
forms: a clock that walks at random instead of a constant, a slab with its inner reflections
instead of one excess delay, a tabulated and skewed bias instead of the published curve. numpy only.
"""
