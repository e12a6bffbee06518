// Text and numbers beside the picture. Names come from a scene: they are set as text, never as markup.

const byId = (id) => document.getElementById(id);
const MOST_VALUES = 60; // rows of the table
const PRECISION = "Values under the pointer are kept to 1/32,000 of the largest of their component in the step, and only digits that this " +
  "leaves are shown; the path is kept to six digits. The result file has all.";
const HOVER_ROWS = [
  ["displacement x, y, z", "displacement"], ["N, Q₂, Q₃", "material_force"], ["T, M₂, M₃", "material_moment"],
  ["γ₁, γ₂, γ₃", "force_strain"], ["κ₁, κ₂, κ₃", "moment_strain"], ["von Mises", "von_mises_stress"],
  ["normal stress", "largest_normal_stress"], ["shear stress", "largest_shear_stress"], ["utilisation", "utilisation"],
];

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function option(value, text) {
  const made = element("option", text);
  made.value = value;
  return made;
}

/** Converts "tip.reaction_force.x" to "tip: reaction force x". */
function readable(name) {
  const match = name.match(/^(.*)\.(displacement|rotation|reaction_force|reaction_moment)(?:\.(x|y|z|norm))?$/s);
  if (!match) return name;
  const component = match[3] ? ` ${match[3] === "norm" ? "(size)" : match[3]}` : "";
  return `${match[1]}: ${match[2].replace("_", " ")}${component}`;
}

class Panel {
  /** `wanted`: name of the field to be shown if available. */
  constructor(result, wanted) {
    this.result = result;
    const { preview } = result;
    for (const id of ["notes", "field", "ordinate", "abscissa", "modes", "check"]) byId(id).replaceChildren();
    document.title = result.title;
    byId("title").textContent = result.title;
    const units = result.units[0] ? `units ${result.units.join(", ")}` : "units of the scene";
    const count = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;
    const steps = preview ? "not solved" : count(result.stable.length - 1, "step");
    byId("subtitle").textContent = `${count(result.all_members, "member")} · ${steps} · ${units} · mixbeam ${result.version}`;
    for (const note of preview ? result.notes : [...result.notes, PRECISION]) byId("notes").append(element("p", note));
    byId("check-section").hidden = !preview;
    byId("values-section").hidden = byId("range").hidden = Boolean(preview);
    if (preview) {
      byId("check").append(preview.refusal ? element("p", preview.refusal, "bad") : element("p", "A run would take this scene."),
        ...preview.warnings.map((text) => element("p", `warning: ${text}`)));
    }
    this.fillFields(wanted);
    this.fillDiagrams(byId("diagram").value);
    this.fillSeries();
    this.fillModes();
  }

  fillFields(shown) {
    const vanishes = (field) => !field.names && field.extremes.every((pair) => !pair || (pair[0] === 0 && pair[1] === 0));
    this.result.fields.forEach((field, i) => byId("field").append(option(i, field.label + (vanishes(field) ? " (zero)" : ""))));
    const byName = (name) => this.result.fields.findIndex((field) => field.name === name && !vanishes(field));
    const everywhere = (i) => i >= 0 && this.result.fields[i].extremes.slice(1).every(Boolean);
    const wanted = ["von_mises", "bending", "axial_force", "torsion", "displacement"].map(byName);
    const before = this.result.fields.findIndex((field) => field.name === shown);
    byId("field").value = before >= 0 ? before : wanted.find(everywhere) ?? 0;
  }

  /** Offers diagrams of the section forces that do not vanish. */
  fillDiagrams(shown) {
    const some = this.result.fields.filter((field) => field.name in DIAGRAMS && field.extremes.some((pair) => pair && (pair[0] || pair[1])));
    byId("diagram").replaceChildren(option("", "none"), ...some.map((field) => option(field.name, field.label)));
    byId("diagram").value = some.some((field) => field.name === shown) ? shown : "";
    byId("diagram").parentElement.hidden = some.length === 0;
  }

  fillSeries() {
    for (const id of ["ordinate", "abscissa"])
      for (const name of this.result.series_names) byId(id).append(option(name, readable(name)));
    byId("ordinate").value = "load factor";
    byId("abscissa").value = this.result.abscissa;
    byId("whole-line").hidden = !this.result.modes.some((mode) => mode.before !== undefined);
    byId("path-section").hidden = this.result.stable.length < 2;
  }

  fillModes() {
    const { modes } = this.result;
    byId("modes-title").textContent = this.result.preview ? "What can move" : "Critical points and modes";
    byId("leave-mode").textContent = this.result.preview ? "at rest" : "back to the step";
    byId("modes-section").hidden = modes.length === 0;
    modes.forEach((mode, i) => {
      const button = element("button");
      button.dataset.mode = i;
      button.append(element("span", mode.kind), element("span", this.result.preview ? i + 1 : placeOfMode(mode)));
      if (mode.before !== undefined) button.title = `negative eigenvalues: ${mode.before} before, ${mode.after} after; ${mode.modes} become singular together`;
      byId("modes").append(button);
    });
  }

  showMode(number) {
    for (const button of byId("modes").children) button.classList.toggle("chosen", Number(button.dataset.mode) === number);
    byId("mode-tools").hidden = number < 0;
  }

  /** Shows the extremes of a field in a step as text; none for a mode (step -1). */
  showExtremes(field, step) {
    const pair = field.extremes[step];
    const unit = field.unit ? ` ${field.unit}` : "";
    byId("extremes").textContent = step < 0 || field.names ? "" : pair ? `this step: ${numberText(pair[0])} to ${numberText(pair[1])}${unit}` : "not recorded in this step";
  }

  /** Shows quantities, displacements, reactions in a row of the series. */
  showValues(place) {
    const { series_names: names } = this.result;
    const isVector = (name) => names.includes(`${name}.norm`);
    const rows = [];
    for (const name of names) {
      if (this.isPlaceOf(name)) continue;
      const base = name.replace(/\.(x|y|z|norm)$/s, "");
      if (base !== name && isVector(base)) {
        if (name.endsWith(".x")) rows.push([readable(base), ..."xyz"].map((part, i) => (i ? this.result.series(`${base}.${part}`)[place] : part)));
      } else rows.push([name + this.placeWords(name, place), this.result.series(name)[place]]);
    }
    const shown = rows.filter((cells) => cells.slice(1).some((value) => Math.abs(value) < NO_VALUE));
    byId("values").replaceChildren(tableRow("th", ["", "x", "y", "z"]), ...shown.slice(0, MOST_VALUES).map((cells) => tableRow("td", cells)));
    if (shown.length > MOST_VALUES) byId("values").append(tableRow("td", [`and ${shown.length - MOST_VALUES} more in the result file`]));
  }

  /** Returns whether a quantity is the place of the extreme of another one. */
  isPlaceOf(name) {
    const match = name.match(/^(.*)\.(member|arc_length|side)$/s);
    return match !== null && this.result.series_names.includes(match[1]);
  }

  placeWords(name, place) {
    const { series_names: names, members, all_members: count } = this.result;
    if (!names.includes(`${name}.member`)) return "";
    const number = Math.round(this.result.series(`${name}.member`)[place]); // packed: 19 comes back as 19.0000076
    if (!(number >= 0 && number < count)) return "";
    const member = members.length === count ? members[number] : `member ${number}`;
    return ` (${member}, s = ${numberText(this.result.series(`${name}.arc_length`)[place], 4)})`;
  }

  /** Shows all values at a place on a member: { member, sample, share }. */
  showHover(found, step, x, y) {
    const { result } = this;
    const hover = byId("hover");
    hover.hidden = !found;
    if (!found) return;
    const between = (values, columns, i) => {
      const [a, b] = [0, 1].map((end) => values[columns * (found.sample + end) + i]);
      return Math.abs(a) < NO_VALUE && Math.abs(b) < NO_VALUE ? a + found.share * (b - a) : NaN;
    };
    const unit = result.unitOfLength() ? ` ${result.unitOfLength()}` : "";
    const section = result.sections[found.member] ? ` · section ${result.sections[found.member]}` : "";
    const table = element("table");
    for (const [words, name] of HOVER_ROWS) {
      const values = result.ofStep(name, step);
      if (!values) continue;
      const columns = values.length / result.samples;
      const cells = Array.from({ length: columns }, (_, i) => result.known(between(values, columns, i), name, step, found.member, i));
      if (cells.every(Number.isFinite)) table.append(tableRow("td", [words, ...cells]));
    }
    hover.replaceChildren(element("b", result.members[found.member]),
      element("div", `s = ${numberText(between(result.arcLength, 1, 0))}${unit}${section}`, "soft"), table);
    const stage = byId("stage");
    hover.style.left = `${clamp(x + 16, 4, Math.max(4, stage.clientWidth - hover.offsetWidth - 6))}px`;
    hover.style.top = `${clamp(y + 16 + hover.offsetHeight > stage.clientHeight ? y - hover.offsetHeight - 12 : y + 16, 4, stage.clientHeight)}px`;
  }
}

/** Returns the load factor of a mode, or the frequency of its vibration. */
function placeOfMode(mode) {
  if (mode.omega === undefined) return `λ = ${numberText(mode.factor, 6)}`;
  return `ω = ${numberText(mode.omega, 6)}, f = ${numberText(mode.omega / (2 * Math.PI), 6)}`;
}

/** Makes a row of a table: numbers after a word; a single one spans the last columns. */
function tableRow(kind, cells) {
  const made = element("tr");
  cells.forEach((cell, i) => {
    const isNumber = typeof cell === "number";
    const field = element(kind, isNumber ? numberText(cell, 4) : cell, isNumber ? "number" : "");
    if (i === cells.length - 1 && i < 3) field.colSpan = 4 - i;
    made.append(field);
  });
  return made;
}
