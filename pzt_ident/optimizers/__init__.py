"""Optimizers over the unit cube, one file each; the file name is the word in the job."""
