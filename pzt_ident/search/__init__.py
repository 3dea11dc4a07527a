"""Model and records as a function on the unit cube, and the search of its minimum.

In: a chain, records, and what the job says of the parameters. Out: the best point, what it is worth, what the data
determine of it (`Estimate`), and how the optimizers compare.
"""
