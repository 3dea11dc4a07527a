"""What is wrong with a measurement and can be seen before any model: single readings, gaps, joints, ends of a range.

In: records. Out: phrases about each record that say what, where and what to do (`fault_phrases`).
"""

from pzt_ident.data.faults.phrases import fault_phrases

__all__ = ["fault_phrases"]
