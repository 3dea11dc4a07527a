"""Readers of file formats, one file a format; a file in this folder is found without being listed anywhere.

In: the path of a file. Out: its columns (`Table`), none of them loaded yet. A reader declares SUFFIXES, and MAGIC where
the format has first bytes of its own, and imports heavy libraries inside its functions.
"""
