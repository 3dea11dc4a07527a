"""The local web page: the command line's workflow with the mouse.

In: clicks and dropped files. Out: the same commands, run in the same folders.
"""
