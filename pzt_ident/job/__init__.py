"""The job file: read, checked and edited.

In: YAML text. Out: a frozen `Job`, every word of it checked, or one error that lists all faults with line, value and
remedy; and the text with an effect, a block or a value changed, comments kept.
"""
