"""Where a model fails, and what it is missing.

In: a fitted model and its records. Out: the misfit by record, branch, rate and so on; every effect scored, the best
refitted; a verdict, the staircase of effects that bring the error down, and the drive that tells rivals apart.
"""
