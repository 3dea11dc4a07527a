"""The state in which a record starts, one file each; the file name is the word in the job."""
