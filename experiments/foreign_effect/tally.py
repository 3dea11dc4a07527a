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
    work = [r["work"] / r["cpu"] for r in rows]
    verdicts = defaultdict(int)
    for row in rows:
        verdicts[row["verdict"]] += 1
    said = ", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items(), key=lambda v: -v[1]))
    wrong = sum(bool(r["extra"]) for r in rows)
    return (
        f"| {name} | {len(rows)} | {_share(rows, 'exact')} | {_share(rows, 'in_class')} | {wrong} | "
        f"{_quantile(floors, 0.5):.2f} / {_quantile(floors, 0.9):.2f} | {_quantile(cpu, 0.5):.0f} / "
        f"{_quantile(cpu, 0.95):.0f} | {_quantile(work, 0.5):.2f} / {_quantile(work, 0.05):.2f} | {said} |"
    )


def _head(name):
    return (
        f"| {name} | cases | exact | in class | with a wrong name | floors left, median / 90 % | "
        "CPU s, median / 95 % | work / CPU, median, 5 % | verdicts |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )


def _grouped(rows, keys):
    groups = defaultdict(list)
    for row in rows:
        for key in keys(row):
            groups[key].append(row)
    return [_line(key, groups[key]) for key in sorted(groups)]


def _family(rows):
    """Bouc-Wen fitted to another family: is the memory named, and what is hidden beside it?"""
    if not rows:
        return []
    lines = [
        "| Bouc-Wen fitted to another family | cases | memory named | in class | effect named | in class | "
        "with a wrong name | floors left, median / 90 % | CPU s, median / 95 % | work / CPU, median, 5 % | verdicts |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, length in (("without an effect", 1), ("with one effect", 2)):
        if some := [r for r in rows if len(r["truth"]) == length]:
            counts = [_found(some, i, key) if i < length else "" for i in (0, 1) for key in ("named", "missed")]
            cells = _line(name, some).split(" | ")
            lines.append(" | ".join([*cells[:2], *counts, *cells[4:]]))
    lines += [
        "",
        "| case | base | Bouc-Wen leaves, alone / with plays | hidden | floors, by record | named | suspects ",
    ]
    lines[-1] += "| verdict | floors left | CPU s |"
    lines.append("|" + "---|" * 10)
    for row in rows:
        seen = " ".join(f"{value:.0f}" for values in row["seen"].values() for value in values)
        alone, beside = row["bouc_wen"]
        cells = [row["seed"], row["base"], f"{alone:.0f} / {beside:.1f}", " ".join(_forms(row)[1:]), seen]
        cells += [" ".join(row["named"]), " ".join(row["suspects"]), row["verdict"], row["floors"], f"{row['cpu']:.0f}"]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return [*lines, ""]


def _found(rows, i, key):
    """In how many rows the i-th true effect is named, or not missed."""
    count = sum((r["truth"][i] in r[key]) == (key == "named") for r in rows)
    return f"{count}/{len(rows)}"


def _ties(rows):
    """Campaigns that ended in a class of several effects, and what the proposed drive made of it."""
    rows = [r for r in rows if r["kind"] in ("loops", "one_frequency")]
    if not rows:
        return []
    lines = [
        "| campaign | cases | ended in a tie | the truth in it | a drive proposed and played | tie gone | truth kept | "
        "exact after it |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind in sorted({r["kind"] for r in rows}):
        some = [r for r in rows if r["kind"] == kind]
        tied = [r for r in some if r["tied"]]
        played = [r["followed"] for r in tied if "followed" in r]
        shares = [_share(tied, "in_class"), f"{len(played)}/{len(tied)}"]
        shares += [f"{sum(bool(r['named']) and not r['tied'] for r in played)}/{len(played)}"]
        shares += [_share(played, "in_class"), _share(played, "exact")]
        lines.append(f"| {kind} | {len(some)} | {len(tied)} | " + " | ".join(shares) + " |")
    lines += ["", "| tie | truth | cannot be told apart | named after the drive | still tied | verdict | floors left |"]
    lines += ["|---|---|---|---|---|---|---|"]
    for row in (r for r in rows if r["tied"]):
        groups, after = "; ".join(" ".join(group) for group in row["tied"]), row.get("followed")
        said = ["no drive proposed", "", "", ""]
        if after:
            still = "; ".join(" ".join(group) for group in after["tied"])
            said = [" ".join(after["named"]), still, after["verdict"], str(after["floors"])]
        lines.append(
            f"| {row['kind']} {row['seed']} | {' '.join(row['truth'])} | {groups} | " + " | ".join(said) + " |"
        )
    return [*lines, ""]


def _noise(rows):
    """The noise floors that the tool took from the records of x over the noise of its sensor."""
    lines = ["| noise floor over the noise, x | cases | median | within a fifth | least | largest |"]
    lines.append("|---|---|---|---|---|---|")
    for name, memory in (("white", False), ("with a memory", True)):
        if ratios := [r["noise"] for r in rows if r["coloured"] == memory and not math.isnan(r["noise"])]:
            close = sum(1 / 1.2 <= ratio <= 1.2 for ratio in ratios)
            cells = [len(ratios), f"{_quantile(ratios, 0.5):.2f}", f"{close}/{len(ratios)}"]
            cells += [f"{min(ratios):.2f}", f"{max(ratios):.2f}"]
            lines.append(f"| {name} | " + " | ".join(map(str, cells)) + " |")
    return [*lines, ""]


def markdown(rows):
    """Tables by kind, effect, form, base, bounds, mechanics, other axis, way ahead; at the end what went wrong."""
    parts = [_head("kind"), *_grouped(rows, lambda r: [r["kind"]]), ""]
    parts += [*_family([r for r in rows if r["kind"] == "family"]), *_ties(rows)]
    proper = [r for r in rows if r["truth"]]
    if proper:
        parts += [_head("effect"), *_grouped(proper, lambda r: r["truth"]), ""]
        parts += [_head("form"), *_grouped(proper, _forms), ""]
    for name in ("base", "bounds", "mechanics", "y", "coloured"):
        parts += [_head(name), *_grouped(rows, lambda r, name=name: [str(r[name])]), ""]
    if begun := [r for r in rows if r.get("ahead")]:
        parts += [_head("ahead"), *_grouped(begun, lambda r: [f"{r['kind']}: {r['ahead']}"]), ""]
    parts += _noise(rows)
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
