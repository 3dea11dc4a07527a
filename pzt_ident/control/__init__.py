"""The identified model put to work: its inverse, a closed loop around it, and its export."""
