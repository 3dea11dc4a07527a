"""Tables, figures and the HTML report of a finished run. Everything here reads results; nothing is fitted here.

In: a folder of results. Out: `report.html`, `tables/` (CSV, LaTeX) and `figures/` (SVG, PDF).
"""
