"""Tables, figures and the page of a finished run. Everything here reads results; nothing computes one.

In: a folder of results. Out: `report.html`, `tables/` (CSV, LaTeX) and `figures/` (SVG, PDF).
"""
