"""What an author writes, and what it becomes.

In: classes with declared parameters and the equation of one sample (`Block`), or a generator over the unit cube
(`Optimizer`), each registered under the name of its file. Out: the chain of blocks in signal order, with one entry of
theta for each parameter of each axis.
"""
