"""What the library does not have: a law over the covariates, or a fault of the set-up.

search.py    which structures there are, fitted and ranked on working links
judge.py     whether sealed links bear the best one out
forms.py, structures.py, faults.py    the grammar
"""
