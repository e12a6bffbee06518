// The result that the page holds: members, steps, fields. Arrays are decoded when they are first looked at, those of a
// step are forgotten when another one comes.

class Result {
  constructor() {
    Object.assign(this, JSON.parse(document.getElementById("description").textContent));
    this.reference = floatsOf("reference"); // x, y, z from the middle; 1 at the first, 2 at the last sample of a member
    this.arcLength = floatsOf("arc_length");
    this.dimensions = floatsOf("dimensions"); // width, height, wall, web
    this.restTriad = floatsOf("triad-0");
    this.seriesValues = floatsOf("series");
    this.held = new Map();
    this.heldStep = -1;
  }

  /** An array of a step, null where the step does not have it. */
  ofStep(name, step) {
    if (step !== this.heldStep) this.held.clear();
    this.heldStep = step;
    if (!this.held.has(name)) this.held.set(name, floatsOf(`${name}-${step}`));
    return this.held.get(name);
  }

  /** Of one sample; NaN where there is no value. */
  valueAt(field, step, sample) {
    const values = this.ofStep(field.source, step);
    if (!values) return NaN;
    const columns = values.length / this.samples;
    const parts = field.components.map((component) => values[columns * sample + component]);
    const value = parts.length === 1 ? parts[0] : Math.hypot(...parts);
    return Math.abs(value) < NO_VALUE ? value : NaN;
  }

  memberOf(sample) {
    let low = 0;
    let high = this.first_sample.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.first_sample[middle] <= sample) low = middle;
      else high = middle;
    }
    return low;
  }

  lastSample(member) {
    return (member + 1 < this.first_sample.length ? this.first_sample[member + 1] : this.samples) - 1;
  }

  /** Values of a followed number, a row for each step of the run and then for each critical point. */
  series(name) {
    const rows = this.seriesValues.length / this.series_names.length;
    const at = this.series_names.indexOf(name);
    return this.seriesValues.subarray(at * rows, (at + 1) * rows);
  }

  unitOfLength() {
    return this.units[0];
  }
}

/** What the picture shows: a step or a critical state, with a share of a mode. */
class Shape {
  constructor(result) {
    this.result = result;
    this.zero = new Float32Array(3 * result.samples);
    this.step = 0;
    this.scale = 1;
    this.modeNumber = -1;
    this.amplitude = 0; // of the mode [length]
    this.showStep(0);
  }

  showStep(step) {
    this.step = step;
    this.modeNumber = -1;
    this.mode = null;
    this.displacement = this.result.ofStep("displacement", step);
    this.triad = this.result.ofStep("triad", step);
  }

  /** A critical state moved along its mode; the sections are those of the nearest step. */
  showMode(number) {
    const { result } = this;
    const place = result.modes[number].step;
    const nearest = result.steps.reduce((best, step, i) =>
      Math.abs(step.place - place) < Math.abs(result.steps[best].place - place) ? i : best, 0);
    this.showStep(nearest);
    this.modeNumber = number;
    this.mode = floatsOf(`mode-${number}`);
    this.displacement = floatsOf(`critical-displacement-${number}`) || this.zero;
  }

  /** Relative to the middle of the structure. */
  position(sample) {
    const at = sum(row(this.result.reference, sample, 4), row(this.displacement, sample), this.scale);
    return this.mode ? sum(at, row(this.mode, sample), this.amplitude) : at;
  }
}
