"""From a job to a folder of results.

In: a `Job`. Out: `result.json`, `diagnosis.json` or `improvement.json` with signals, misfits and events beside them,
each file whole or not there; a run that was killed goes on from its checkpoints.
"""
