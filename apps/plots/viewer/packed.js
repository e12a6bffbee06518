// Data of the page: deflated (RFC 1951) in base64, unpacked when they are first looked at, in any browser.

const PLANES = 3; // bytes of a number, the lowest ones of all numbers first
const MISSING = 2 ** 22; // in place of numbers that are not known
const BASES = { // of lengths and distances, and how many bits are added to each
  length: [[3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258],
    [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0]],
  distance: [[1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193,
    12289, 16385, 24577], [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13]],
};
const ORDER_OF_LENGTHS = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/** Reads bits, the lowest of a byte first. */
class Bits {
  constructor(bytes) {
    Object.assign(this, { bytes, at: 0, held: 0, count: 0 });
  }

  fill(count) {
    for (; this.count < count; this.count += 8) this.held |= this.bytes[this.at++] << this.count;
  }

  drop(count) {
    this.held >>>= count;
    this.count -= count;
  }

  take(count) {
    this.fill(count);
    const value = this.held & ((1 << count) - 1);
    this.drop(count);
    return value;
  }

  /** The next symbol of a code. */
  symbol({ longest, table }) {
    this.fill(longest);
    const entry = table[this.held & ((1 << longest) - 1)];
    this.drop(entry & 15);
    return entry >> 4;
  }

  /** A length or distance that a symbol stands for. */
  sized([bases, bits], symbol) {
    return bases[symbol] + this.take(bits[symbol]);
  }
}

/** Huffman's code of symbols with these lengths: what the next bits begin with, as 16 times the symbol and its length. */
function codeOf(lengths) {
  const longest = Math.max(1, ...lengths);
  const table = new Uint16Array(1 << longest);
  let code = 0;
  for (let length = 1; length <= longest; ++length, code <<= 1) {
    for (let symbol = 0; symbol < lengths.length; ++symbol) {
      if (lengths[symbol] !== length) continue;
      let reversed = 0;
      for (let i = 0; i < length; ++i) reversed |= ((code >> i) & 1) << (length - 1 - i);
      for (let i = reversed; i < table.length; i += 1 << length) table[i] = 16 * symbol + length;
      code += 1;
    }
  }
  return { longest, table };
}

const FIXED = [codeOf(Array.from({ length: 288 }, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8))), codeOf(Array(30).fill(5))];

/** The two codes that a block brings along. */
function codesOf(bits) {
  const [literals, distances, count] = [bits.take(5) + 257, bits.take(5) + 1, bits.take(4) + 4];
  const first = Array(19).fill(0);
  for (let i = 0; i < count; ++i) first[ORDER_OF_LENGTHS[i]] = bits.take(3);
  const code = codeOf(first);
  const lengths = [];
  while (lengths.length < literals + distances) {
    const symbol = bits.symbol(code);
    if (symbol < 16) lengths.push(symbol);
    else {
      const [value, bitsOfCount, least] = symbol === 16 ? [lengths[lengths.length - 1], 2, 3] : symbol === 17 ? [0, 3, 3] : [0, 7, 11];
      for (let i = bits.take(bitsOfCount) + least; i > 0; --i) lengths.push(value);
    }
  }
  return [codeOf(lengths.slice(0, literals)), codeOf(lengths.slice(literals))];
}

/** What was deflated. */
function inflated(bytes) {
  const bits = new Bits(bytes);
  let made = new Uint8Array(8 * bytes.length + 64);
  let size = 0;
  const grow = (more) => {
    if (size + more <= made.length) return;
    const larger = new Uint8Array(2 * (size + more));
    larger.set(made);
    made = larger;
  };
  for (let isLast = 0; !isLast;) {
    isLast = bits.take(1);
    const kind = bits.take(2);
    if (kind === 0) {
      bits.at -= bits.count >> 3; // whole bytes that were read too early
      const start = bits.at + 4;
      const count = bytes[bits.at] | (bytes[bits.at + 1] << 8);
      grow(count);
      made.set(bytes.subarray(start, start + count), size);
      size += count;
      Object.assign(bits, { at: start + count, held: 0, count: 0 });
      continue;
    }
    const [literals, distances] = kind === 1 ? FIXED : codesOf(bits);
    for (let symbol = bits.symbol(literals); symbol !== 256; symbol = bits.symbol(literals)) {
      grow(258);
      if (symbol < 256) {
        made[size++] = symbol;
        continue;
      }
      const end = size + bits.sized(BASES.length, symbol - 257);
      const distance = bits.sized(BASES.distance, bits.symbol(distances));
      if (distance === 1) {
        made.fill(made[size - 1], size, end);
        size = end;
      } else for (; size < end; ++size) made[size] = made[size - distance];
    }
  }
  return made.subarray(0, size);
}

/** The bytes of an element that the writer of the page filled; null where there is none of that name. */
function bytesOf(name) {
  const element = document.getElementById(name);
  return element && inflated(Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0)));
}

/** Numbers of the page as whole multiples of a unit for each column, one column after the other. */
class Packed {
  /** `later`: up to two of the same quantity, from which this one was extrapolated. */
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
        this.whole[k] = ((rest + expected) << 8) >> 8; // of 24 bits
      }
    });
  }

  /** Column after column. */
  columns() {
    const { units, rows, whole } = this;
    return Float32Array.from(whole, (number, k) => (number === MISSING ? 1e30 : number * units[Math.floor(k / rows)]));
  }

  /** Row after row. */
  floats() {
    const values = new Float32Array(this.whole.length);
    const [columns, count] = [this.columns(), this.units.length];
    for (let c = 0, k = 0; c < count; ++c) for (let i = 0; i < this.rows; ++i, ++k) values[count * i + c] = columns[k];
    return values;
  }
}
