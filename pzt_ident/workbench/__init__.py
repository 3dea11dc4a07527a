"""The local web page: the story of the command line with the mouse. It runs the same commands on the same folders."""
