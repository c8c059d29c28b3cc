"""A mutation run: small faults planted one by one, each of which some test must notice.

    make mutants                                    # every target of targets.toml, sampled
    python -m tests.mutation --target metrics       # some of them
    python -m tests.mutation --samples 0            # every mutant there is

Own code, because the two known tools do not fit: mutmut 3 copies the project and runs it from
there, which entry points, source hashes and an editable install do not survive, and it wraps
every method, which torch's exporter does not; cosmic-ray edits the files in place and starts a
fresh Python per mutant, which here is four seconds of imports. This one imports the libraries
once, forks, gives the fork one mutated module and runs that module's own tests in it. The files
are never touched.
"""
