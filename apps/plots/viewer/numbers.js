// Vectors, texts of numbers, ticks of axes.

const NO_VALUE = 1e29; // larger values stand for unknown ones

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const sum = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const row = (array, i, columns = 3) => [array[columns * i], array[columns * i + 1], array[columns * i + 2]];
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** Rotates a vector by the unit quaternion w, x, y, z. */
function turned(quaternion, vector) {
  const [w, x, y, z] = quaternion;
  const axis = [x, y, z];
  const twice = cross(axis, vector).map((component) => 2 * component);
  return sum(sum(vector, twice, w), cross(axis, twice));
}

const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** Formats a number with `digits` significant digits: 0.01234, 12340, 1.234·10⁻⁷. */
function numberText(value, digits = 5) {
  if (!(Math.abs(value) < NO_VALUE)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const minus = (text) => text.replace("-", "−");
  if (size >= 1e-3 && size < 1e6) return minus(String(Number(value.toPrecision(digits))));
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const power = String(Number(exponent)).replace(/./g, (sign) => SUPERSCRIPTS[sign]);
  return `${minus(String(Number(mantissa)))}·10${power}`;
}

/** Returns about `count` round numbers between two. */
function ticksBetween(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough * 0.999) || 10 * power;
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(i === 0 ? 0 : i * step);
  return ticks;
}
