"""The command line: each command calls a function of another folder and prints what it returns.

In: the arguments of a command. Out: text or JSON on the terminal, and an exit code.
"""
