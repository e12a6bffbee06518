// Result in the page: members, steps, fields. Numbers are unpacked at first use; the floats of a step are dropped when
// another step is shown.

const COMPLIANT = { force_strain: ["material_force", 0], moment_strain: ["material_moment", 3] }; // force, index of its first compliance

class Result {
  /** Reads the result of a load case, by its number. */
  constructor(number) {
    this.bytes = (name) => bytesOf(`${number}/${name}`);
    Object.assign(this, jsonOf(`${number}/description`));
    this.packed = new Map();
    this.held = new Map();
    this.heldStep = -1;
    this.reference = this.withEnds(this.floats("reference")); // x, y, z from the middle; tag 1 at the first, 2 at the last sample of a member
    this.arcLength = this.floats("arc_length");
    this.dimensions = this.floats("dimensions"); // width, height, wall, web
    this.restTriad = this.floats("rest_triad");
    const path = new Packed(this.bytes("series"), this.units_of.series);
    this.path = { rows: path.rows, values: path.columns() };
  }

  withEnds(places) {
    const made = new Float32Array(4 * this.samples);
    for (let i = 0; i < this.samples; ++i) made.set(row(places, i), 4 * i);
    this.first_sample.forEach((first, member) => {
      made[4 * first + 3] = 1;
      made[4 * this.lastSample(member) + 3] = 2;
    });
    return made;
  }

  /** Returns an array of the page; null if there is none of that name. */
  floats(name) {
    return this.units_of[name] ? new Packed(this.bytes(name), this.units_of[name]).floats() : null;
  }

  /** Returns a quantity of a step as integers, stored as differences to the extrapolation of later steps; null if missing. */
  unpacked(quantity, step) {
    const name = (number) => `${quantity}-${number}`;
    const held = (number) => this.packed.get(name(number));
    let end = step;
    while (this.units_of[name(end)] && !held(end)) end += 1;
    for (let i = end - 1; i >= step; --i) {
      const later = held(i + 1) ? [held(i + 1), held(i + 2)].filter(Boolean) : [];
      this.packed.set(name(i), new Packed(this.bytes(name(i)), this.units_of[name(i)], later));
    }
    return held(step) || null;
  }

  /** Returns an array of a step, null if the step does not have it. */
  ofStep(name, step) {
    if (step !== this.heldStep) this.held.clear();
    this.heldStep = step;
    if (!this.held.has(name)) {
      const packed = this.unpacked(name, step);
      this.held.set(name, packed ? packed.floats() : this.strains(name, step));
    }
    return this.held.get(name);
  }

  /** Rounds a value to the digits that the page knows, at most four: stored values are multiples of a unit. */
  known(value, name, step, member, column) {
    const packed = this.unpacked(name, step);
    const [force, first] = COMPLIANT[name] || [];
    const unit = packed ? packed.units[column]
      : Math.abs(this.compliance[this.sections[member]][first + column]) * this.unpacked(force, step).units[column];
    if (!value || !unit) return value;
    return Number(value.toPrecision(clamp(Math.floor(Math.log10(Math.abs(value) / unit)) + 1, 1, 4)));
  }

  /** Computes strains, which the page does not store: compliances of each section times forces; null for other quantities. */
  strains(name, step) {
    if (!COMPLIANT[name]) return null;
    const [force, first] = COMPLIANT[name];
    const values = this.ofStep(force, step).slice();
    this.first_sample.forEach((start, member) => {
      const compliance = this.compliance[this.sections[member]];
      for (let k = 3 * start; k < 3 * this.lastSample(member) + 3; ++k) values[k] *= compliance[first + (k % 3)];
    });
    return values;
  }

  /** Returns the value of a field at a sample; NaN if there is none. */
  valueAt(field, step, sample) {
    if (field.of_members) return field.of_members[this.memberOf(sample)];
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

  /** Returns the values of a followed number for each step of the run, then for each critical point. */
  series(name) {
    const { values, rows } = this.path;
    const at = this.series_names.indexOf(name);
    return values.subarray(at * rows, (at + 1) * rows);
  }

  unitOfLength() {
    return this.units[0];
  }
}

/** State that is shown: a step or a critical state, with an amplitude of a mode. */
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
    this.triad = this.result.ofStep("triad", step) || this.result.restTriad;
    this.isAligned = this.triad === this.result.restTriad; // without triads in the page round sections follow their line
  }

  /** Shows a critical state moved along its mode; the sections are those of the nearest step. */
  showMode(number) {
    const { result } = this;
    const place = result.modes[number].step;
    const nearest = result.steps.reduce((best, step, i) =>
      Math.abs(step.place - place) < Math.abs(result.steps[best].place - place) ? i : best, 0);
    this.showStep(nearest);
    this.modeNumber = number;
    this.mode = result.floats(`mode-${number}`);
    this.displacement = result.floats(`critical-displacement-${number}`) || this.zero;
  }

  /** Returns section axis 1, 2 or 3 at a sample, aligned with the drawn line. */
  axis(number, sample) {
    const { result, triad } = this;
    const own = [0, 1, 2].map((i) => turned(Array.from(triad.subarray(4 * sample, 4 * sample + 4)), [i === 0, i === 1, i === 2].map(Number)));
    if (!this.isAligned && this.scale === 1) return own[number - 1];
    const tag = result.reference[4 * sample + 3];
    const chord = sum(this.position(tag === 2 ? sample : sample + 1), this.position(tag === 1 ? sample : sample - 1), -1);
    const length = norm(chord);
    if (!(length > 0)) return own[number - 1];
    const along = chord.map((part) => part / length);
    const cosine = dot(own[0], along);
    if (cosine < -0.9) return own[number - 1];
    const quaternion = [1 + cosine, ...cross(own[0], along)];
    const size = Math.hypot(...quaternion);
    return turned(quaternion.map((part) => part / size), own[number - 1]);
  }

  /** Returns the position of a sample relative to the middle of the structure. */
  position(sample) {
    const at = sum(row(this.result.reference, sample, 4), row(this.displacement, sample), this.scale);
    return this.mode ? sum(at, row(this.mode, sample), this.amplitude) : at;
  }
}
