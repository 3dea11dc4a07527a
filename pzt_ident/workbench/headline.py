"""The two lines at the head of the page: the verdict, and the one thing to do next."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pzt_ident.workbench.runner import RESUME

DOING = {
    "run": "The model is being fitted.",
    "diagnose": "Each effect of the catalogue is being tried.",
    "improve": "What is missing is being added, effect by effect.",
    "control": "The drive for the reference is being computed.",
    "fleet": "The model is being identified on every device.",
}
State = Mapping[str, Any]


def error(state: State) -> str:
    """What is shown as an error: a warning, or a failure that the headline does not say."""
    return str(state["warning"] or ("" if state["failure"].endswith(RESUME) else state["failure"]))


def headline(state: State) -> dict[str, Any]:
    """`verdict` and `next` as sentences, and `action`: the change that `next` means, None where there is none."""
    verdict, following, action = _headline(state)
    return {"verdict": verdict, "next": following, "action": action}


def _headline(state: State) -> tuple[str, str, dict[str, Any] | None]:
    if not state["steps"]:
        return "Drop a measurement.", "Then confirm its columns.", None
    if state["running"]:
        return DOING.get(state["stage"], "The command is being started."), "", act("stop", {}, "Stop")
    if state["failure"]:
        what, resumes, _ = state["failure"].partition(f" {RESUME}")
        verdict, following = (what, RESUME) if resumes else ("The last command failed.", "Resume tries it again.")
        return verdict, following, act("run", {}, "Resume")
    result, diagnosis = state["result"], state["diagnosis"]
    if result and not diagnosis:
        floors = state["steps"][-1]["floors"]
        left = f": it leaves an RMSE of {floors:.2g} noise floors" if floors else ""
        return f"The model is fitted{left}.", "Find out what it misses.", act("run", {}, "Diagnose")
    if not result:
        return "The job is ready.", "Identify the model.", act("run", {}, "Identify")
    return (diagnosis["reason"], *_next(diagnosis, improved=bool(state["steps"][-1].get("diagnosed"))))


def _next(diagnosis: State, improved: bool) -> tuple[str, dict[str, Any] | None]:
    best = next((item for item in diagnosis["candidates"] if item["decision"] == "missing"), None)
    if best:
        name = best.get("item", best["effect"])
        following = f"Add {name}, and see whether the error falls."
        if diagnosis["verdict"] == "inconclusive" and diagnosis["next_experiment"]:
            following = f"Add {name}, or measure again with the proposed drive, which tells them apart."
        return following, act("add", {"effect": name}, f"Add {name}")
    if diagnosis["verdict"] == "adequate":
        return "Put the model to work: drop a reference to follow, or export it.", None
    if diagnosis["verdict"] == "refused":
        return "Narrow the bounds of the parameters, or choose another model.", None
    if improved:
        return "Measure again, let an improvement take more CPU time, or put the model to work.", None
    return "Let two effects be tried together, and each in its other forms.", act("improve", {}, "Improve")


def act(name: str, body: dict[str, Any], label: str) -> dict[str, Any]:
    return {"name": name, "body": body, "label": label}
