"""Where a model fails, and what it is missing.

In: a fitted model and its records. Out: the misfit by record, branch, rate and so on; the scores of all effects and
refits of the best; a verdict; the staircase of effects that reduce the error; and the drive that separates rivals.
"""
