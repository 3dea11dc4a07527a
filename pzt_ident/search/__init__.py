"""Model and records as a function on the unit cube, and the search for its minimum.

In: a chain, records, and what the job says of the parameters. Out: the best point and its loss, value and
standard error of each parameter (`Estimate`), and a comparison of the optimizers.
"""
