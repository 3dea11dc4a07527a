"""Readers of file formats, one file each, found by being here.

In: the path of a file that begins or is named as the reader declares. Out: its columns (`Table`), none of them loaded.
A reader declares SUFFIXES, and MAGIC where the format has first bytes of its own, and imports heavy libraries in its
functions alone.
"""
