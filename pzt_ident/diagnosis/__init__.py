"""Where a model fails and what is missing."""
