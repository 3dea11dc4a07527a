"""Measured channels.

In: the files that a job names, or arrays. Out: records on uniform time grids in SI units (`Record`), their noise
floors, and `signals.nc`, where measurement, model and residual stand side by side.
"""
