/** Progress of a diagnosis, from the lines of its `events.jsonl` as they arrive. */
export class Progress {
  constructor(onChange) {
    this.onChange = onChange;
    this.clear();
  }

  clear() {
    Object.assign(this, { sentence: "", scored: [] });
  }

  update({ event, said: sentence, ...facts }) {
    if (event === "fitted" && facts.done === 1) this.clear();
    this.sentence = sentence ?? this.sentence;
    if (event === "scored") this.scored.push(facts);
    if (sentence) this.onChange();
  }
}
