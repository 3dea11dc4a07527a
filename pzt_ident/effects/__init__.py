"""Physical effects that a job may add to its model, one file each; the file name is the word in the job."""
