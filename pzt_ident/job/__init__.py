"""The job file as a typed, frozen thing.

In: YAML text. Out: a `Job` whose every word is checked, or one error that lists all faults with line, value and remedy;
and the text again with an effect, a block or a value changed, comments kept.
"""
