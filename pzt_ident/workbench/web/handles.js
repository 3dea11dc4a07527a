import { element } from "./parts.js";
import { number } from "./signals.js";

/** Handles in a plot over time, each moved by dragging or by the arrow keys: {name, kind, read(), write(value)} in the
 * units of the axis. `changed(done)` follows every move. */
export class Handles {
  constructor(plot, changed) {
    Object.assign(this, { plot, changed, items: [] });
    plot.watchers.push(() => this.place());
  }

  show(handles) {
    for (const { node } of this.items) node.remove();
    this.items = handles.map((handle) => ({ ...handle, node: this.node(handle) }));
    this.place();
  }

  node({ name, kind, read, write }) {
    const node = element(this.plot.root, "div", { class: `handle ${kind}`, role: "slider", tabindex: 0, "aria-label": name, "aria-orientation": "horizontal" });
    element(node, "span", {}, name);
    let held = false;
    const move = (value, done) => { write(value); this.place(); this.changed(done); };
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
      move(read() + (sign * (this.plot.x.high - this.plot.x.low)) / 200, true);
    });
    return node;
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
