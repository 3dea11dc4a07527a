"""Tables of a count: by kind, and by what the lottery drew."""

import math
from collections import defaultdict


def _share(rows, key):
    return f"{sum(bool(r[key]) for r in rows)}/{len(rows)}"


def _quantile(values, share):
    values = sorted(v for v in values if not math.isnan(v))
    return values[min(int(share * len(values)), len(values) - 1)] if values else math.nan


def _line(name, rows):
    floors, cpu = [r["floors"] for r in rows], [r["cpu"] for r in rows]
    verdicts = defaultdict(int)
    for row in rows:
        verdicts[row["verdict"]] += 1
    said = ", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items(), key=lambda v: -v[1]))
    wrong = sum(bool(r["extra"]) for r in rows)
    return (
        f"| {name} | {len(rows)} | {_share(rows, 'exact')} | {_share(rows, 'in_class')} | {wrong} | "
        f"{_quantile(floors, 0.5):.2f} / {_quantile(floors, 0.9):.2f} | {_quantile(cpu, 0.5):.0f} / "
        f"{_quantile(cpu, 0.95):.0f} | {said} |"
    )


def _head(name):
    return (
        f"| {name} | cases | exact | in class | with a wrong name | floors left, median / 90 % | "
        "CPU s, median / 95 % | verdicts |\n"
        "|---|---|---|---|---|---|---|---|"
    )


def _grouped(rows, keys):
    groups = defaultdict(list)
    for row in rows:
        for key in keys(row):
            groups[key].append(row)
    return [_line(key, groups[key]) for key in sorted(groups)]


def markdown(rows):
    """Tables by kind, effect, form, base, bounds, mechanics and other axis; at the end the cases that went wrong."""
    parts = [_head("kind"), *_grouped(rows, lambda r: [r["kind"]]), ""]
    proper = [r for r in rows if r["truth"]]
    if proper:
        parts += [_head("effect"), *_grouped(proper, lambda r: r["truth"]), ""]
        parts += [_head("form"), *_grouped(proper, _forms), ""]
    for name in ("base", "bounds", "mechanics", "y", "coloured"):
        parts += [_head(name), *_grouped(rows, lambda r, name=name: [str(r[name])]), ""]
    parts += ["| case | truth | forms | named | verdict | floors left | CPU s |", "|---|---|---|---|---|---|---|"]
    for row in rows:
        if not row["in_class"]:
            parts.append(
                f"| {row['kind']} {row['seed']} | {' '.join(row['truth'])} | {' '.join(row['forms'])} | "
                f"{' '.join(row['named'])} | {row['verdict']} | {row['floors']} | {row['cpu']:.0f} |"
            )
    return "\n".join(parts) + "\n"


def _forms(row):
    return [f"{effect}: {form}" for effect, form in zip(row["truth"], row["forms"], strict=True)]
