"""Tables of the answers: a line for each kind, and one for each campaign."""

KINDS = ("single", "pair", "none", "outside")
HEAD = (
    "| kind | cases | exact | in class | with a wrong name | unexplained | floors left, median / 90 % | "
    "CPU s, median / 95 % |"
)
EACH = "| campaign | hidden | size in floors | named | verdict | floors left | CPU s |"


def _quantile(values, share, digits):
    values = sorted(value for value in values if value is not None)
    return f"{values[min(int(share * len(values)), len(values) - 1)]:.{digits}f}" if values else ""


def _kind(kind, rows):
    counts = [sum(bool(row[key]) for row in rows) for key in ("exact", "in_class", "wrong", "unexplained")]
    floors, cpu = [row["floors_left"] for row in rows], [row["cpu"] for row in rows]
    ends = [f"{_quantile(floors, 0.5, 2)} / {_quantile(floors, 0.9, 2)}"]
    ends.append(f"{_quantile(cpu, 0.5, 0)} / {_quantile(cpu, 0.95, 0)}")
    return [kind, len(rows), *counts, *ends]


def _campaign(row):
    hidden = ", ".join(row["effects"]) + (": " if row["effects"] else "") + row["what"].replace("|", r"\|")
    left = "" if row["floors_left"] is None else row["floors_left"]
    return [row["name"], hidden, row["size"], ", ".join(row["named"]), row["verdict"], left, f"{row['cpu']:.0f}"]


def _table(head, lines):
    rule = "|" + "---|" * (head.count("|") - 1)
    return [head, rule, *("| " + " | ".join(map(str, line)) + " |" for line in lines)]


def markdown(rows):
    kinds = [_kind(kind, some) for kind in KINDS if (some := [row for row in rows if row["kind"] == kind])]
    return "\n".join([*_table(HEAD, kinds), "", *_table(EACH, map(_campaign, rows))]) + "\n"
