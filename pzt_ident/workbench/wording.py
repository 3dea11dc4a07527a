"""The sentences of the command line in the words of the page: fields, roles and buttons in the place of a job's keys,
options and files."""

from __future__ import annotations

import re

KEY = r"(?=[: ]|$)"
SIGNALS = (
    (r"\bchannels\.axes\.(\w+)\.(drive|response)\.unit" + KEY, r"unit of the \2 of \1"),
    (r"\bchannels\.axes\.(\w+)\.(drive|response)(?:\.\w+)?" + KEY, r"\2 of \1"),
    (r"\bchannels\.axes\.(\w+)" + KEY, r"axis \1"),
    (r"\bchannels\.time\.unit" + KEY, "unit of the time"),
    (r"\bchannels\.time" + KEY, "time"),
    (r": (\w+)\.(drive|response)(?=: )", r": \2 of \1"),
    (r"\btime: time\b", "time"),
)
FIELDS = (
    (r"\brecords\[\d+\]\.(?:rows|time)(?:\[\d\])?" + KEY, "“From” and “to”"),
    (r"\brecords\[\d+\]\.settle" + KEY, "“not scored for”"),
    (r"\brecords\[\d+\]\.sample_rate" + KEY, "sample rate"),
    (r"\brecords\[\d+\]\.", ""),
    (r"^name(?=: )", "name of the job"),
    (r"\bparameters\.(\S+)\.bounds\[0\]" + KEY, r"lower bound of \1"),
    (r"\bparameters\.(\S+)\.bounds\[1\]" + KEY, r"upper bound of \1"),
    (r"\bparameters\.(\S+)\.(bounds|value)" + KEY, r"\2 of \1"),
    (r"\bparameters\.(\S+?)" + KEY, r"\1"),
    (r"\boptimizers\[\d+\]\.(?!name)(\w+)" + KEY, r"\1 of the optimizer"),
    (r"\boptimizers\[\d+\](?:\.name)?" + KEY, "optimizer"),
    (r"\b(model|effect)s?\[\d+\]" + KEY, r"\1"),
)
REMEDIES = (
    (
        r"give what is before it and after it records of their own with `rows: [^`]*` and `rows: [^`]*`",
        "divide the record there",
    ),
    (r"give each a record of its own, by `rows: [^`]*` and `rows: [^`]*`", "divide the record there"),
    (r"give what is before and after(?: it)? a record of its own, by `rows`", "divide the record there"),
    (r"(the row|it|them) out by `rows`(?: or `(?:settle|time)`)?", r"\1 out by cropping the record"),
    (r"(the row |it )out with `rows`", r"\1out by cropping the record"),
    (r"cut them with `rows`", "crop the records"),
    (r"widen `rows`(?: or `time`, or decimate less)?", "take more of the record"),
    (r"leave `time` out and give `sample_rate`", "give the time the role “not used”, and type the sample rate"),
    (r"give the record a `sample_rate: 1 kHz`, or the job a `time` channel", "type it, or choose a column of time"),
    (r"write \[first, last\], the earlier first", "end it after its start"),
    (r"write \[low, high\], the lower first", "write the lower one first"),
    (r"fix it with `value: (\S+)`", r"fix the parameter at \1"),
    (r"there are (\d+) rows, \[0, \1\] takes all", r"there are \1 rows"),
    (r"give the parameter `bounds` or a `value`", "give the parameter bounds, or fix it"),
    (r"give one of them `use: identify`|give at least one record `use: identify`", "choose one for identification"),
    (r"a shorter `settle`", "score it sooner"),
    (
        r"write it in the header, as in [^,]*, or in the job: `unit: \w+` of this channel",
        "type its unit beside its name",
    ),
    (r"see `pzt-ident list blocks`", "under “Choose blocks”"),
    (r"missing key '(drive|response)'", r"there is no \1"),
    (r"add `(drive|response): \.\.\.`", r"choose its column"),
    (r"the same command with --improve says why", "improve one to see why"),
    (r"or give --rate", "or type the rate"),
    (r"give more with --budget", "give more CPU time under “Optimizers”"),
    (r"under `limits`", "in the job file"),
    (r"give another folder with --out", "start the workbench in another folder"),
)
OTHERS = (
    (r"^\S*\.ya?ml(?::\d+:\d+)?: (?=\S)", ""),
    (r"^\S*\.ya?ml has (\d+) faults$", r"\1 entries have to be corrected:"),
    (r"`([^`\n]*)`", r"\1"),
    (r"(?<!\S)--(\w+)(?:-(\w+))?", r"\1 \2"),
    (r"(?<![^\s:])(?:[^\s/:'\"]+/)*\.\./(?:[^\s/:'\"]+/)*", ""),
)


def in_page_words(text: str) -> str:
    """A message of the command line for someone who sees the page alone."""
    for pattern, words in (*OTHERS[:2], *SIGNALS, *FIELDS, *REMEDIES, *OTHERS[2:]):
        text = re.sub(pattern, words, text, flags=re.MULTILINE)
    return text
