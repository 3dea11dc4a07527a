"""Identify hysteresis models of piezo stages, see where they fail and which physical effect is missing."""

__version__ = "0.1.0"
