// Camera with parallel projection; z points up unless the view is along z.

class Camera {
  constructor(elevation, azimuth) {
    this.target = [0, 0, 0];
    this.height = 1; // of the visible region [length]
    this.width = 1; // of the picture [css pixels]
    this.rows = 1;
    this.look(elevation, azimuth);
  }

  /** Sets the direction; angles in degrees. */
  look(elevation, azimuth) {
    this.elevation = clamp(elevation, -90, 90);
    this.azimuth = azimuth;
    const [e, a] = [this.elevation, azimuth].map((angle) => (angle * Math.PI) / 180);
    this.right = [-Math.sin(a), Math.cos(a), 0];
    this.toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    this.up = cross(this.toward, this.right);
  }

  resize(width, rows) {
    this.width = width;
    this.rows = rows;
  }

  /** Length that corresponds to a pixel. */
  get pixel() {
    return this.height / this.rows;
  }

  /** Fits all points into the picture inside the margins [left, right, top, bottom, pixels]. */
  fit(points, margins) {
    const spans = [this.right, this.up].map((direction) => {
      const along = points.map((point) => dot(point, direction));
      return [along.reduce((a, b) => Math.min(a, b)), along.reduce((a, b) => Math.max(a, b))];
    });
    const [left, right, top, bottom] = margins;
    const room = [Math.max(this.width - left - right, 50), Math.max(this.rows - top - bottom, 50)];
    const pixel = Math.max((spans[0][1] - spans[0][0]) / room[0], (spans[1][1] - spans[1][0]) / room[1], 1e-30);
    this.height = pixel * this.rows;
    const middle = spans.map(([low, high]) => (low + high) / 2);
    const depth = points.map((point) => dot(point, this.toward)).reduce((a, b) => a + b, 0) / points.length;
    this.target = sum(sum(sum([0, 0, 0], this.right, middle[0] - ((left - right) / 2) * pixel), this.up,
      middle[1] + ((top - bottom) / 2) * pixel), this.toward, depth);
  }

  /** Projects a point to pixels from the upper left corner, and its nearness [length]. */
  project(point) {
    const from = sum(point, this.target, -1);
    return [this.width / 2 + dot(from, this.right) / this.pixel, this.rows / 2 - dot(from, this.up) / this.pixel,
      dot(from, this.toward)];
  }

  /** Projects a unit direction to shares to the right and downwards in the picture. */
  flat(direction) {
    return [dot(direction, this.right), -dot(direction, this.up)];
  }

  orbit(dx, dy) {
    this.look(this.elevation + 0.4 * dy, this.azimuth - 0.4 * dx);
  }

  pan(dx, dy) {
    this.target = sum(sum(this.target, this.right, -dx * this.pixel), this.up, dy * this.pixel);
  }

  /** Zooms such that the point at pixel (x, y) stays there. */
  zoom(factor, x, y) {
    const before = this.pixel;
    this.height = this.height / factor;
    const moved = before - this.pixel;
    this.target = sum(sum(this.target, this.right, (x - this.width / 2) * moved), this.up, (this.rows / 2 - y) * moved);
  }

  /** Matrix to clip coordinates, column by column; points within `reach` of the target are not clipped in depth. */
  matrix(reach) {
    const lines = [[this.right, 2 / (this.pixel * this.width)], [this.up, 2 / this.height], [this.toward, -1 / reach]];
    const columns = [0, 1, 2].map((i) => lines.map(([direction, factor]) => factor * direction[i]).concat(0));
    const shift = lines.map(([direction, factor]) => -factor * dot(direction, this.target)).concat(1);
    return new Float32Array([...columns.flat(), ...shift]);
  }

  /** Rotation into the frame of the camera. */
  eye() {
    return new Float32Array([0, 1, 2].flatMap((i) => [this.right[i], this.up[i], this.toward[i]]));
  }
}
