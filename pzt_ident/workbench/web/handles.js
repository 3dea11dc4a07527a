import { element } from "./parts.js";
import { number } from "./signals.js";

/** Handles in a plot over time, each moved by dragging or by the arrow keys: {name, kind, read(), write(value)} in the
 * units of the axis. `changed(done)` follows every move. */
export class Handles {
  constructor(plot, changed) {
    Object.assign(this, { plot, changed, items: [] });
    plot.watchers.push(() => this.place());
  }

  /** Show these and no others. One that stays keeps its element, and with it the keyboard's focus. */
  show(handles) {
    const before = new Map(this.items.map((item) => [item.kind, item]));
    this.items = handles.map((handle) => Object.assign(before.get(handle.kind) ?? this.created(handle), handle));
    for (const item of before.values()) if (!this.items.includes(item)) item.node.remove();
    this.place();
  }

  created({ name, kind }) {
    const item = {};
    const node = element(this.plot.root, "div", { class: `handle ${kind}`, role: "slider", tabindex: 0, "aria-label": name, "aria-orientation": "horizontal" });
    element(node, "span", {}, name);
    let held = false;
    const move = (value, done) => { item.write(value); this.place(); this.changed(done); };
    node.addEventListener("pointerdown", (event) => { event.stopPropagation(); held = true; node.setPointerCapture(event.pointerId); });
    node.addEventListener("pointermove", (event) => {
      event.stopPropagation();
      if (held) move(this.plot.x.value(event.clientX - this.plot.root.getBoundingClientRect().left), false);
    });
    for (const kind of ["pointerup", "pointercancel"])
      node.addEventListener(kind, (event) => { event.stopPropagation(); if (held) [held] = [false, this.changed(true)]; });
    node.addEventListener("dblclick", (event) => event.stopPropagation());
    node.addEventListener("keydown", (event) => {
      const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10 }[event.key];
      if (!sign) return;
      event.preventDefault();
      event.stopPropagation();
      move(item.read() + (sign * (this.plot.x.high - this.plot.x.low)) / 200, true);
    });
    return Object.assign(item, { node });
  }

  place() {
    const { plot } = this;
    if (!plot.scene || !plot.edge) return;
    for (const { node, read } of this.items) {
      const px = plot.x.px(read());
      node.style.left = `${px}px`;
      node.hidden = px < plot.edge.left - 14 || px > plot.width;
      node.classList.toggle("end", px > 0.7 * plot.width);
      const [low, high] = plot.scene.x.range;
      for (const [key, value] of [["aria-valuemin", low], ["aria-valuemax", high], ["aria-valuenow", read()]]) node.setAttribute(key, Number(value.toPrecision(6)));
      node.setAttribute("aria-valuetext", number(read(), 4));
    }
  }
}
