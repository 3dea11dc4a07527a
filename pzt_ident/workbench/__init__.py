"""The local web page: the story of the command line with the mouse.

In: clicks and dropped files. Out: the same commands, run on the same folders.
"""
