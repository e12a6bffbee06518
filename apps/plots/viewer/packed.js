// Data of the page: deflated (RFC 1951) in base64, inflated once by the browser, unpacked at first use.

const PLANES = 3; // bytes of a number; the lowest bytes of all numbers come first
const MISSING = 2 ** 22; // stands for an unknown number

const inflated = new Map();

/** Inflates all data elements of the page. */
async function inflateAll() {
  await Promise.all([...document.querySelectorAll('script[type="application/octet-stream"]')].map(async (element) => {
    const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    inflated.set(element.id, new Uint8Array(await new Response(stream).arrayBuffer()));
  }));
}

/** Returns the bytes of an element of this name; undefined if there is none. */
const bytesOf = (name) => inflated.get(name);
const jsonOf = (name) => JSON.parse(new TextDecoder().decode(bytesOf(name)));

/** Numbers of the page as integer multiples of a unit for each column, one column after the other. */
class Packed {
  /** `later`: up to two later steps of the same quantity, from which this one was extrapolated. */
  constructor(bytes, units, later = []) {
    const total = bytes.length / PLANES;
    this.units = units;
    this.rows = total / units.length;
    this.whole = new Int32Array(total);
    units.forEach((unit, column) => {
      const [a, b] = later.map((step) => step.units[column]);
      const [one, two] = later.map((step) => step.whole);
      let rest = 0;
      for (let k = column * this.rows; k < (column + 1) * this.rows; ++k) {
        const folded = bytes[k] | (bytes[k + total] << 8) | (bytes[k + 2 * total] << 16);
        rest += (folded >>> 1) ^ -(folded & 1);
        let expected = 0;
        if (one) expected = clamp(Math.floor((two ? 2 * (one[k] * a) - two[k] * b : one[k] * a) / unit + 0.5), -MISSING, MISSING);
        this.whole[k] = ((rest + expected) << 8) >> 8; // sign-extends 24 bits
      }
    });
  }

  /** Returns the numbers, column after column. */
  columns() {
    const { units, rows, whole } = this;
    return Float32Array.from(whole, (number, k) => (number === MISSING ? 1e30 : number * units[Math.floor(k / rows)]));
  }

  /** Returns the numbers, row after row. */
  floats() {
    const values = new Float32Array(this.whole.length);
    const [columns, count] = [this.columns(), this.units.length];
    for (let c = 0, k = 0; c < count; ++c) for (let i = 0; i < this.rows; ++i, ++k) values[count * i + c] = columns[k];
    return values;
  }
}
