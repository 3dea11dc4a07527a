"""Simulation of many candidates at once.

In: a chain of blocks, a record, and candidates (theta, in SI units). Out: their responses, the errors (model
minus measurement), and the sums of squared errors. Each block is compiled once and runs over candidates as SIMD lanes.
"""
