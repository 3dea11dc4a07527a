// Zooming, panning and marking of a plot with wheel, mouse, fingers and keys.

const STEP = 1.25; // of a zoom by key
const FLAT = 15; // px: a box of less height zooms in time only

/** Let `plot` be zoomed and panned. `mode()` is what a drag does: "pan", "zoom" or "mark"; with Shift it draws a box.
 * The wheel over a plot along time zooms in time, with Ctrl or Alt in height. `moved(plot)` follows a new view, `point(i)` the cursor, `mark(xs, ys)` a box (null, null: none), `reset()` a double
 * click. `wheel`: "focused" leaves the wheel to the page unless the plot has the focus. */
export function listen(plot, { mode = () => "pan", moved = () => {}, point = () => {}, mark = () => {}, reset = () => {}, wheel = "always" }) {
  const { root } = plot, pointers = new Pointers(plot, { mode, moved, point, mark });
  const go = (x, y) => pointers.go(x, y);
  root.addEventListener("wheel", (event) => {
    if (!plot.scene || (wheel === "focused" && document.activeElement !== root)) return;
    event.preventDefault();
    const factor = Math.exp(0.0015 * Math.max(-300, Math.min(300, event.deltaY * (event.deltaMode ? 30 : 1))));
    if (plot.along && (event.ctrlKey || event.altKey)) go(plot.view.x, around(plot.y, pointers.place(event)[1], factor));
    else zoom(plot, factor, ...pointers.place(event), go);
  }, { passive: false });
  root.addEventListener("pointerdown", (event) => plot.scene && event.button <= 0 && pointers.down(event));
  root.addEventListener("pointermove", (event) => plot.scene?.series && pointers.move(event));
  for (const kind of ["pointerup", "pointercancel"]) root.addEventListener(kind, (event) => pointers.up(event));
  root.addEventListener("pointerleave", () => !pointers.start && point(null));
  root.addEventListener("dblclick", () => reset());
  root.addEventListener("keydown", (event) => key(plot, event, go, reset));
}

/** Mouse and fingers on a plot: one drags or points, two pinch. */
class Pointers {
  constructor(plot, { mode, moved, point, mark }) {
    Object.assign(this, { plot, mode, moved, point, mark, fingers: new Map(), start: null, last: null, pinch: 0 });
  }

  place(event) {
    const box = this.plot.root.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  go(x, y) {
    this.plot.look(x, y);
    this.moved(this.plot);
  }

  modeOf(event) { return event.shiftKey ? "zoom" : this.mode(); }

  down(event) {
    this.fingers.set(event.pointerId, this.place(event));
    if (this.fingers.size === 2) [this.pinch, this.start] = [apart(this.fingers), null];
    else [this.start, this.last] = [this.place(event), this.place(event)];
    this.plot.root.setPointerCapture(event.pointerId);
  }

  move(event) {
    const { plot, fingers } = this, [px, py] = this.place(event), go = (x, y) => this.go(x, y);
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, [px, py]);
    if (fingers.size === 2) {
      const [[x0, y0], [x1, y1]] = [...fingers.values()];
      zoom(plot, this.pinch / apart(fingers), (x0 + x1) / 2, (y0 + y1) / 2, go);
      this.pinch = apart(fingers);
    } else if (!this.start) this.point(plot.nearest(px, py));
    else if (this.modeOf(event) === "pan") {
      pan(plot, px - this.last[0], py - this.last[1], go);
      this.last = [px, py];
    } else {
      plot.boxAcross = plot.along && (this.modeOf(event) === "mark" || Math.abs(py - this.start[1]) < FLAT);
      plot.box = [...this.start, px, py];
      plot.drawTop();
    }
  }

  up(event) {
    const { plot } = this, { box } = plot;
    this.fingers.delete(event.pointerId);
    [this.start, plot.box] = [null, null];
    if (!box || event.type === "pointercancel") return;
    const sorted = (a, b) => (a < b ? [a, b] : [b, a]);
    const dragged = Math.hypot(box[2] - box[0], box[3] - box[1]) > 4;
    const xs = sorted(plot.x.value(box[0]), plot.x.value(box[2])), ys = sorted(plot.y.value(box[1]), plot.y.value(box[3]));
    if (this.modeOf(event) === "zoom") dragged ? this.go(xs, plot.boxAcross ? plot.view.y : ys) : plot.drawTop();
    else dragged ? this.mark(xs, ys) : this.mark(null, null);
  }
}

function apart(fingers) {
  const [[x0, y0], [x1, y1]] = [...fingers.values()];
  return Math.max(10, Math.hypot(x1 - x0, y1 - y0));
}

/** The ends of a scale after a zoom about a pixel. */
function around(scale, at, factor) {
  return [scale.value(at + (scale.from - at) * factor), scale.value(at + (scale.to - at) * factor)];
}

function zoom(plot, factor, px, py, go) {
  const full = plot.scene.x.range, [low, high] = around(plot.x, px, factor);
  if (!plot.along) return go([low, high], around(plot.y, py, factor));
  const within = [Math.max(low, full[0]), Math.min(high, full[1])];
  go(within[0] <= full[0] && within[1] >= full[1] ? null : within, plot.view.y);
}

function pan(plot, dx, dy, go) {
  const shifted = (scale, by) => [scale.value(scale.from - by), scale.value(scale.to - by)];
  if (!plot.along) return go(shifted(plot.x, dx), shifted(plot.y, dy));
  const [low, high] = shifted(plot.x, dx), full = plot.scene.x.range;
  const x = plot.view.x && low >= full[0] && high <= full[1] ? [low, high] : plot.view.x;
  if (x || plot.view.y) go(x, plot.view.y && shifted(plot.y, dy));
}

/** Plus and minus zoom, Page Up and Down and Alt with an arrow pan, 0 shows all. */
function key(plot, event, go, reset) {
  if (!plot.scene) return;
  const middle = [(plot.x.from + plot.x.to) / 2, (plot.y.from + plot.y.to) / 2];
  const far = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  if (event.key === "+" || event.key === "=") zoom(plot, 1 / STEP, ...middle, go);
  else if (event.key === "-") zoom(plot, STEP, ...middle, go);
  else if (event.key === "PageUp") pan(plot, 0.2 * plot.width, 0, go);
  else if (event.key === "PageDown") pan(plot, -0.2 * plot.width, 0, go);
  else if (event.altKey && far) pan(plot, ...far.map((part) => 60 * part), go);
  else if (event.key === "0" || event.key === "Home") reset();
  else return;
  event.preventDefault();
}
