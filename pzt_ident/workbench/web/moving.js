import { request } from "./session.js";

/** The model's response to values that are being moved: one request is under way at a time, and only the newest values
 * are asked for next. `draw(records, rmse)` gets a map of record and axis to {places, values}. */
export class Moving {
  constructor(draw, fail) {
    Object.assign(this, { draw, fail, wanted: null, underWay: false, stopped: false });
  }

  ask(at, values, effect = null) {
    this.wanted = { at, values, effect: effect ?? "" };
    if (!this.underWay) this.next();
  }

  /** Ask for nothing more, and draw no answer that is still to come. */
  stop() { [this.wanted, this.stopped] = [null, this.underWay]; }

  async next() {
    this.underWay = true;
    for (let reply = null; this.wanted || reply; ) {
      const asked = this.wanted, answer = asked && this.answer(asked);
      this.wanted = null;
      if (reply && !this.stopped) this.draw(reply.records, reply.rmse);
      if (asked) this.stopped = false;
      await new Promise(requestAnimationFrame);
      reply = null;
      try {
        reply = await answer;
      } catch (error) {
        this.wanted = null;
        this.fail(error);
      }
    }
    this.underWay = false;
  }

  async answer(asked) {
    const key = `${asked.at} ${asked.effect}`;
    return this.decode(await (await request("simulate", { ...asked, positions: key !== this.known })).arrayBuffer(), key);
  }

  /** A line of JSON, then the values of every record and axis as little-endian 32-bit floats. The samples at which they
   * are come with the first answer for a step. */
  decode(buffer, key) {
    const end = new Uint8Array(buffer).indexOf(10);
    const { records, rmse } = JSON.parse(new TextDecoder().decode(buffer.slice(0, end)));
    if (key !== this.known) [this.known, this.places] = [key, records.map(({ positions }) => Uint32Array.from(positions))];
    const floats = new Float32Array(buffer.slice(end + 1)), found = new Map();
    let first = 0;
    records.forEach(({ name, axis, use, points }, place) => {
      found.set([name, axis, use].filter(Boolean).join("|"), { places: this.places[place], values: floats.subarray(first, first + points) });
      first += points;
    });
    return { records: found, rmse };
  }
}
