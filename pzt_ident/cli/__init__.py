"""The command line: thin callers of what the other folders do.

In: the words of a command. Out: text or JSON on the terminal, an exit code.
"""
