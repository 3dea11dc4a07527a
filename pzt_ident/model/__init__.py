"""Blocks, optimizers and the chain of blocks.

In: classes that an author writes, with declared parameters and the equation of one sample (`Block`), or a generator
over the unit cube (`Optimizer`), each registered under the name of its file. Out: the chain of blocks in signal order,
with one entry of theta for each parameter of each axis.
"""
