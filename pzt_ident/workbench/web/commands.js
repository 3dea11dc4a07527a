import { element } from "./parts.js";
import { once, requestJson, save } from "./session.js";

const FORMATS = { c: "C", fmu: "FMU", matlab: "MATLAB", csv: "CSV table", json: "JSON" };

/** Files to take along, the model for other programs, and the commands that do the same in a terminal. */
export class Commands {
  constructor(root, fail) {
    Object.assign(this, { root, fail, key: "" });
  }

  show({ downloads, commands, result, at }) {
    const key = JSON.stringify([downloads, commands, Boolean(result), at]);
    if (key === this.key) return;
    this.key = key;
    this.root.replaceChildren();
    if (result) this.showExport();
    if (downloads?.length) this.showFiles(downloads);
    element(this.root, "h2", {}, "The same in a terminal");
    element(this.root, "p", { class: "quiet" }, "These commands, run in the folder in which the workbench was started, repeat what was done on this page.");
    element(this.root, "pre", { id: "commands", tabindex: 0 }, commands.join("\n") || "Nothing has been done yet.");
  }

  showExport() {
    element(this.root, "h2", {}, "The model for a controller");
    const bar = element(this.root, "div", { class: "bar" });
    for (const [to, text] of Object.entries(FORMATS))
      once(element(bar, "button", { type: "button", "data-export": to }, text), () => exported(to), this.fail);
  }

  showFiles(names) {
    element(this.root, "h2", {}, "Files of this step");
    const bar = element(this.root, "div", { class: "bar downloads" });
    for (const name of names)
      once(element(bar, "button", { type: "button" }, name), () => save(`download?name=${encodeURIComponent(name)}`, name), this.fail);
  }
}

async function exported(to) {
  const { url, file } = await requestJson("export", { to });
  Object.assign(document.createElement("a"), { href: url, download: file.split("/").at(-1) }).click();
}
