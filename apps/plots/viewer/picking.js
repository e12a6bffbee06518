// Picks the piece of a member under the pointer: the one nearest to the viewer that is hit, else the nearest within reach.

const REACH = 9; // pixels

class Picker {
  constructor(result) {
    this.result = result;
    this.screen = new Float32Array(3 * result.samples);
    this.stale = true;
  }

  /** Discards projected samples, after any change of camera or shape. */
  forget() {
    this.stale = true;
  }

  /** Projects all samples, without an object for each: there may be a hundred thousand. */
  project({ displacement, mode, scale, amplitude }, { right, up, toward, target, pixel, width, rows }) {
    const { reference, samples } = this.result;
    const axes = [[right, 1 / pixel, width / 2], [up, -1 / pixel, rows / 2], [toward, 1, 0]];
    axes.forEach(([[x, y, z], factor, shift], axis) => {
      const start = shift - factor * dot([x, y, z], target);
      for (let i = 0, j = 0, k = 0; i < samples; ++i, j += 3, k += 4) {
        let along = x * (reference[k] + scale * displacement[j]) + y * (reference[k + 1] + scale * displacement[j + 1]) +
          z * (reference[k + 2] + scale * displacement[j + 2]);
        if (mode) along += amplitude * (x * mode[j] + y * mode[j + 1] + z * mode[j + 2]);
        this.screen[j + axis] = start + factor * along;
      }
    });
    this.stale = false;
  }

  /** Returns { member, sample, share } of a point on the piece that begins at the sample; null if there is none. */
  at(x, y, shape, camera, thickness) {
    if (this.stale) this.project(shape, camera);
    const { result, screen } = this;
    const s = screen;
    let best = null;
    for (let i = 0; i + 1 < result.samples; ++i) {
      if (result.reference[4 * i + 3] === 2) continue; // the last sample of a member
      const [a, b] = [3 * i, 3 * i + 3];
      const radius = Math.max(0.5 * Math.max(result.dimensions[4 * i], result.dimensions[4 * i + 1]) * thickness / camera.pixel, 1.5);
      const reach = Math.max(radius, REACH);
      if (Math.max(s[a], s[b]) < x - reach || Math.min(s[a], s[b]) > x + reach) continue;
      if (Math.max(s[a + 1], s[b + 1]) < y - reach || Math.min(s[a + 1], s[b + 1]) > y + reach) continue;
      const [dx, dy] = [s[b] - s[a], s[b + 1] - s[a + 1]];
      const share = clamp(((x - s[a]) * dx + (y - s[a + 1]) * dy) / (dx * dx + dy * dy || 1), 0, 1);
      const distance = Math.hypot(s[a] + share * dx - x, s[a + 1] + share * dy - y);
      if (distance > reach) continue;
      const found = { sample: i, share, hit: distance <= radius, distance, near: s[a + 2] + share * (s[b + 2] - s[a + 2]) };
      if (!best || better(found, best)) best = found;
    }
    return best && { ...best, member: result.memberOf(best.sample) };
  }
}

function better(a, b) {
  if (a.hit !== b.hit) return a.hit;
  return a.hit ? a.near > b.near : a.distance < b.distance;
}
