import { element } from "./parts.js";
import { requestJson } from "./session.js";

/** The model of this step on many devices. `page` has act(name, body) and open(url), which goes to the page of the lot. */
export class Devices {
  constructor(root, page) {
    Object.assign(this, { root, page, key: "", pattern: "lot/*/", improve: false });
  }

  show({ job, lot }) {
    const key = JSON.stringify([job?.files, lot]);
    if (key === this.key) return;
    this.key = key;
    this.root.replaceChildren();
    element(this.root, "h2", {}, "The same model on many devices");
    element(this.root, "p", { class: "quiet" }, `Each device is a folder in that of the workbench, with files of the names ${job.files.join(", ")}${job.files.length > 1 ? "" : ", or one file"}.`);
    const pattern = element(element(element(this.root, "p", { class: "bar" }), "label", {}, "Folders or files "), "input", { value: this.pattern, "aria-label": "Folders or files of the devices" });
    pattern.addEventListener("input", () => { this.pattern = pattern.value; });
    const label = element(element(this.root, "p"), "label"), improve = element(label, "input", { type: "checkbox", ...(this.improve && { checked: "" }) });
    label.append("Find out what each of them misses, and add it");
    improve.addEventListener("change", () => { this.improve = improve.checked; });
    const bar = element(this.root, "p", { class: "bar" });
    element(bar, "button", { type: "button", class: "strong", "data-acts": "", id: "identify-lot" }, "Identify all").addEventListener("click", () => this.start());
    if (lot) element(bar, "button", { type: "button" }, "Show all devices").addEventListener("click", () => this.page.open(lot.url));
  }

  async start() {
    if (!(await this.page.act("fleet", { pattern: this.pattern, improve: this.improve }))) return;
    for (;;) {
      const { of, running, url } = await requestJson("lot");
      if (of) return this.page.open(url);
      if (!running) return;
      await new Promise((resolve) => setTimeout(resolve, 300));
    }
  }
}
