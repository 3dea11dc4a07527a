"""An identified model for other programs: C99, FMU, MATLAB, tables."""
