"""Mechanics between force and displacement, one file each; the file name is the word in the job."""
