"""Simulation, exact and fast.

In: a chain of blocks, a record, and candidates (theta, in SI units). Out: their responses, the errors they leave, and
the sums of squares of these. Each block is compiled once and runs over many candidates as SIMD lanes.
"""
