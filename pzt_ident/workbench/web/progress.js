/** What a diagnosis is at, from the lines of its `events.jsonl` as they come. */
export class Progress {
  constructor(changed) {
    this.changed = changed;
    this.clear();
  }

  clear() {
    Object.assign(this, { said: "", scored: [] });
  }

  take({ event, said, ...facts }) {
    if (event === "fitted" && facts.done === 1) this.clear();
    this.said = said ?? this.said;
    if (event === "scored") this.scored.push(facts);
    if (said) this.changed();
  }
}
