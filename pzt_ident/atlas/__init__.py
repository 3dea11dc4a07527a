"""The atlas of effects and the manual: one offline page, made from declarations, docstrings and simulations.

In: the registry of blocks and optimizers, the schema of the job, chapters in Markdown. Out: `atlas.html`.
"""
