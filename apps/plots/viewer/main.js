// Application: connects the parts and forwards the actions of the user to them.

const MODE_SHARE = 0.12; // largest displacement of a mode over the size of the structure
const HIDDEN_SHARE = 0.9; // of the squared motion of a mode along the line of sight, beyond which the view is changed
const VISIBLE_SHARE = 0.1; // largest displacement over the size of the structure after automatic scaling
const PLAY_SECONDS = 6;
const FILM_SECONDS = 2 * Math.PI; // two periods of a mode
const VIEWS = { xy: [90, -90], xz: [0, -90], yz: [0, 0], iso: [35.264, -45] }; // elevation, azimuth
const ROOM = [130, 70, 96, 72]; // margins around the structure [pixels]: left, right, top, bottom

class App {
  constructor() {
    const { cases } = jsonOf("pages");
    cases.forEach((name, number) => byId("case").append(option(number, name)));
    byId("cases-section").hidden = cases.length < 2;
    this.look(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    this.open(0);
  }

  /** Shows a load case, by its number, with the settings of the one before. */
  open(number) {
    const before = this.result && this.field.name;
    this.stopPlay();
    this.result = new Result(number);
    this.panel = new Panel(this.result, before);
    this.painter = new Painter(byId("scene"), this.result);
    this.shape = new Shape(this.result);
    this.shape.scale = Number(byId("scale").value);
    this.marks = new Marks(byId("marks").getContext("2d"), this.result);
    this.picker = new Picker(this.result);
    this.curve = new Curve(byId("curve"), this.result, (place) => this.choose(place));
    this.marked = [-1, -1];
    byId("step").max = this.result.steps.length - 1;
    byId("loads").checked = this.marks.groups().length <= MOST_MARKS;
    byId("steps").hidden = this.result.stable.length < 2;
    if (before === undefined) {
      this.camera = new Camera(...this.result.camera);
      byId("ghost").checked = this.result.samples < 20000;
      this.resize();
      this.fit();
    }
    this.drawCurve();
    this.showStep(this.result.steps.length - 1);
    if (this.result.preview && this.result.modes.length > 0) {
      this.showMode(0);
      this.swing();
    }
    cancelAnimationFrame(this.wait);
    this.draw();
  }

  // ---- what is shown

  get field() {
    return this.result.fields[byId("field").value];
  }

  showStep(step) {
    this.stopSwing();
    this.shape.showStep(clamp(step, 0, this.result.steps.length - 1));
    byId("step").value = this.shape.step;
    this.showState();
  }

  showMode(number) {
    this.stopSwing();
    this.shape.showMode(number);
    byId("step").value = this.shape.step;
    this.shape.amplitude = byId("amplitude").value * MODE_SHARE * this.result.size;
    this.turnToMode();
    this.showState();
  }

  /** Changes the view if the mode moves along the line of sight, where it would not be visible. */
  turnToMode() {
    const { mode } = this.shape;
    let [along, all] = [0, 0];
    for (let i = 0; i < this.result.samples; ++i) {
      along += dot(row(mode, i), this.camera.toward) ** 2;
      all += norm(row(mode, i)) ** 2;
    }
    if (along <= HIDDEN_SHARE * all) return;
    this.camera.look(...VIEWS.iso);
    this.fit();
  }

  /** Shows a place on the path: a step of the run; critical points are numbered after all steps. */
  choose(place) {
    const steps = this.result.stable.length;
    if (place >= steps) return this.showMode(place - steps);
    const distance = (step) => Math.abs(step.place - place);
    const nearest = this.result.steps.reduce((best, step) => (distance(step) < distance(best) ? step : best));
    return this.showStep(this.result.steps.indexOf(nearest));
  }

  /** Passes the current state to all parts that show it. */
  showState() {
    const { shape, result } = this;
    const { place } = result.steps[shape.step];
    const row_ = shape.modeNumber >= 0 ? result.stable.length + shape.modeNumber : place;
    this.panel.showMode(shape.modeNumber);
    this.panel.showValues(place);
    this.curve.show(row_);
    this.words = this.describe();
    byId("step-text").textContent = this.words[1];
    this.showColors();
  }

  describe() {
    const { shape, result } = this;
    const scaled = shape.scale === 1 ? "" : ` · displacements × ${numberText(shape.scale, 4)}`;
    if (result.preview) return [result.title, shape.modeNumber >= 0 ? `not solved · ${result.modes[shape.modeNumber].kind}` : "not solved"];
    if (shape.modeNumber >= 0) {
      const mode = result.modes[shape.modeNumber];
      return [result.title, `${mode.kind} at ${placeOfMode(mode)}${scaled}`];
    }
    const step = result.steps[shape.step];
    const stable = { true: "stable", false: "not stable", neutral: "neutral", unknown: "stability unknown" }[step.stable];
    return [result.title, `step ${step.number} of ${result.steps[result.steps.length - 1].number} · λ = ${numberText(step.factor, 6)}${this.stageWords(step.factor)} · ${stable}${scaled}`];
  }

  /** Returns the growing stage of several and its share, as text. */
  stageWords(factor) {
    const { stages } = this.result;
    if (stages < 2 || factor < 0 || factor > stages) return "";
    const stage = Math.max(1, Math.ceil(factor - 1e-9));
    const share = factor - stage + 1;
    return ` (stage ${stage} ${share > 1 - 1e-9 ? "full" : `at ${numberText(100 * share, 3)} %`})`;
  }

  /** Sets the values that colour the state; a mode is coloured by its magnitude. */
  showColors() {
    const { shape, result, field } = this;
    const values = new Float32Array(result.samples);
    const isMode = shape.modeNumber >= 0 && !field.names;
    for (let i = 0; i < result.samples; ++i) {
      const value = isMode ? norm(row(shape.mode, i)) : result.valueAt(field, shape.step, i);
      values[i] = Number.isNaN(value) ? 1e30 : field.names ? value % STOPS.names.length : value;
    }
    byId("field").disabled = isMode;
    this.shownField = isMode ? { label: "mode, largest = 1", unit: "" } : field;
    this.range = isMode ? [0, 1] : field.names ? [0, STOPS.names.length - 1] : this.rangeOf(field);
    this.colors = isMode ? "magnitude" : field.names ? "names" : field.signed ? "signed" : "magnitude";
    this.panel.showExtremes(field, isMode ? -1 : shape.step);
    this.painter.setColors(this.colors);
    this.painter.setShape(shape, values);
    this.picker.forget();
    this.redraw();
  }

  /** Returns the range of colours: symmetric about zero for signed fields, from zero for magnitudes. */
  rangeOf(field) {
    const pairs = byId("range").value === "step" ? [field.extremes[this.shape.step]] : field.extremes;
    const largest = pairs.flatMap((pair) => pair || []).reduce((a, b) => Math.max(a, Math.abs(b)), 0);
    return [field.signed ? -largest : 0, largest];
  }

  // ---- the picture

  /** Returns the settings for painter and marks. */
  view() {
    const checked = (id) => byId(id).checked;
    const farthest = this.result.hull.reduce((far, point) => Math.max(far, norm(point)), this.result.size);
    return { camera: this.camera, look: this.theme, range: this.range, colors: this.colors, field: this.shownField, words: this.words,
      diagram: this.shape.modeNumber < 0 && this.result.fields.find((field) => field.name === byId("diagram").value), rangeOf: (field) => this.rangeOf(field),
      ghost: checked("ghost"), supports: checked("supports"), loads: checked("loads"), marked: this.marked, ratio: this.ratio,
      thickness: Number(byId("thickness").value), reach: 4 * farthest * Math.max(1, this.shape.scale) + norm(this.camera.target) };
  }

  draw() {
    this.wait = 0;
    const view = this.view();
    this.painter.draw(this.shape, view);
    this.marks.draw(this.shape, view);
  }

  redraw() {
    if (!this.wait) this.wait = requestAnimationFrame(() => this.draw());
  }

  resize() {
    const { clientWidth, clientHeight } = byId("stage");
    this.ratio = window.devicePixelRatio || 1;
    for (const id of ["scene", "marks"]) {
      byId(id).width = Math.max(1, Math.round(clientWidth * this.ratio));
      byId(id).height = Math.max(1, Math.round(clientHeight * this.ratio));
    }
    this.camera.resize(clientWidth, clientHeight);
    this.picker.forget();
    this.redraw();
  }

  fit() {
    const { shape, result } = this;
    const points = [...result.hull];
    if (shape.scale !== 1) for (let i = 0; i < result.samples; ++i) points.push(shape.position(i));
    const narrow = this.camera.width < 520;
    this.camera.fit(points, narrow ? [90, 15, 50, 50] : ROOM);
    this.moved();
  }

  moved() {
    this.picker.forget();
    this.redraw();
  }

  look(theme) {
    this.theme = theme;
    document.documentElement.dataset.look = theme;
  }

  drawCurve() {
    this.curve.draw(byId("abscissa").value, byId("ordinate").value, byId("whole").checked);
    const { place } = this.result.steps[this.shape.step];
    this.curve.show(this.shape.modeNumber >= 0 ? this.result.stable.length + this.shape.modeNumber : place);
  }

  setScale(scale) {
    if (!(scale >= 0 && Number.isFinite(scale))) return;
    byId("scale").value = Number(scale.toPrecision(4));
    this.shape.scale = Number(byId("scale").value);
    this.showState();
  }

  visibleScale() {
    const { displacement } = this.shape;
    let largest = 0;
    for (let i = 0; i < this.result.samples; ++i) largest = Math.max(largest, norm(row(displacement, i)));
    return largest > 0 ? Math.max(1, (VISIBLE_SHARE * this.result.size) / largest) : 1;
  }

  // ---- motion

  play() {
    if (this.playing) return this.stopPlay();
    const count = this.result.steps.length;
    if (this.shape.step === count - 1) this.showStep(0);
    byId("play").textContent = "❚❚";
    this.playing = setInterval(() => {
      this.showStep(this.shape.step + 1);
      if (this.shape.step === count - 1) this.stopPlay();
    }, clamp((1000 * PLAY_SECONDS) / count, 40, 700));
    return undefined;
  }

  stopPlay() {
    clearInterval(this.playing);
    this.playing = 0;
    byId("play").textContent = "▶";
  }

  /** Animates the mode to both sides and back. */
  swing() {
    if (this.swinging) return this.stopSwing();
    const start = performance.now();
    const frame = (now) => {
      byId("amplitude").value = Math.sin((now - start) / 500);
      this.shape.amplitude = byId("amplitude").value * MODE_SHARE * this.result.size;
      this.moved();
      this.swinging = requestAnimationFrame(frame);
    };
    byId("swing").textContent = "stop";
    this.swinging = requestAnimationFrame(frame);
    return undefined;
  }

  stopSwing() {
    cancelAnimationFrame(this.swinging);
    this.swinging = 0;
    byId("swing").textContent = "animate";
  }

  /** Shows the values of the member at a pixel of the picture, and highlights it. */
  hover(x, y) {
    const found = this.picker.at(x, y, this.shape, this.camera, Number(byId("thickness").value));
    this.panel.showHover(found, this.shape.step, x, y);
    const marked = found ? [this.result.first_sample[found.member], this.result.lastSample(found.member)] : [-1, -1];
    if (marked[0] !== this.marked[0]) {
      this.marked = marked;
      this.redraw();
    }
    return found;
  }

  /** Returns a canvas as large as the picture, and a function that copies picture and marks to it. */
  copier(options) {
    const canvas = document.createElement("canvas");
    Object.assign(canvas, { width: byId("scene").width, height: byId("scene").height });
    const context = canvas.getContext("2d", options);
    return [canvas, () => ["scene", "marks"].forEach((id) => context.drawImage(byId(id), 0, 0))];
  }

  /** Returns the picture as a data URL. */
  picture() {
    this.marked = [-1, -1];
    this.draw();
    const [canvas, copy] = this.copier();
    copy();
    return canvas.toDataURL("image/png");
  }

  save() {
    this.hand(this.picture(), `-${this.shape.step}.png`);
  }

  /** Downloads an address as a file with this ending. */
  hand(address, ending) {
    const link = element("a");
    link.href = address;
    link.download = this.result.title.replace(/[^\p{L}\p{N}_-]+/gu, "_") + ending;
    link.click();
  }

  /** Records the steps, or two periods of a mode, as a film, in real time. */
  film() {
    if (this.filming) return;
    const [canvas, copy] = this.copier({ willReadFrequently: true, alpha: false }); // needed for recording without a graphics card
    const isMode = this.shape.modeNumber >= 0;
    const recorder = new MediaRecorder(canvas.captureStream(), { mimeType: "video/webm;codecs=vp8", videoBitsPerSecond: 8e6 });
    const parts = [];
    recorder.ondataavailable = (event) => parts.push(event.data);
    recorder.onstop = () => this.hand(URL.createObjectURL(new Blob(parts, { type: "video/webm" })), isMode ? "-mode.webm" : ".webm");
    if (!isMode) this.showStep(0);
    this.stopSwing();
    this.stopPlay();
    this.filming = true;
    let end = 0;
    const frame = () => {
      copy();
      if (performance.now() < end && (isMode || this.playing)) requestAnimationFrame(frame);
      else setTimeout(() => { this.filming = false; this.stopSwing(); recorder.stop(); }, 400); // holds the last step
    };
    recorder.onstart = () => {
      end = isMode ? performance.now() + FILM_SECONDS * 1000 : Infinity; // steps end with playing
      (isMode ? this.swing() : this.play());
      requestAnimationFrame(frame);
    };
    copy(); // a recorder without a picture at its start may stay empty
    recorder.start();
  }
}
