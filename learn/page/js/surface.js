// The drawn surface: the network's grid of points, interpolated to a finer one, with a number a point for its colour.
// Drawing alone: no number that the page states comes from here.

const FINER = 4; // parts of a cell of the grid

/** Catmull-Rom weights of a fine line of points over n cell centres, ends continued straight. */
function line(n) {
  const count = n * FINER + 1;
  const at = new Int32Array(count);
  const weights = new Float32Array(count * 4);
  for (let k = 0; k < count; k++) {
    const s = Math.min(Math.max(k / FINER - 0.5, 0), n - 1);
    const i = Math.min(Math.floor(s), n - 2);
    const t = s - i;
    const w = [
      -0.5 * t + t * t - 0.5 * t ** 3,
      1 - 2.5 * t * t + 1.5 * t ** 3,
      0.5 * t + 2 * t * t - 1.5 * t ** 3,
      -0.5 * t * t + 0.5 * t ** 3,
    ];
    // a point beyond the ends stands for the continuation 2 p0 - p1
    if (i === 0) { w[1] += 2 * w[0]; w[2] -= w[0]; w[0] = 0; }
    if (i === n - 2) { w[2] += 2 * w[3]; w[1] -= w[3]; w[3] = 0; }
    at[k] = i - 1;
    weights.set(w, 4 * k);
  }
  return { count, at, weights };
}

export class Surface {
  /** n: points along each side of the grid; size: [length, width] of the block, top: height [mm]; middle: [x, y]. */
  constructor(n, size, middle, top) {
    this.n = n;
    this.line = line(n);
    const { count } = this.line;
    this.count = count;
    this.rest = new Float32Array(count * count * 3);
    for (let r = 0, p = 0; r < count; r++) {
      for (let c = 0; c < count; c++, p += 3) {
        this.rest[p] = middle[0] + size[0] * (c / (count - 1) - 0.5);
        this.rest[p + 1] = middle[1] + size[1] * (r / (count - 1) - 0.5);
        this.rest[p + 2] = top;
      }
    }
    this.positions = new Float32Array(this.rest);
    this.normals = new Float32Array(this.rest.length);
    this.shade = new Float32Array(count * count);
    this.rows = new Float32Array(n * count * 3);
    this.still();
  }

  triangles() {
    const { count } = this;
    const index = new Uint32Array((count - 1) ** 2 * 6);
    for (let r = 0, p = 0; r < count - 1; r++) {
      for (let c = 0; c < count - 1; c++, p += 6) {
        const a = r * count + c;
        index.set([a, a + 1, a + count + 1, a, a + count + 1, a + count], p);
      }
    }
    return index;
  }

  still() {
    this.positions.set(this.rest);
    this.shade.fill(0);
    this._turn();
  }

  /** Move by a displacement (n * n, 3) times scale into mm; rod: {tip, push, radius, edge} in mm, at its depth. */
  move(displacement, scale, rod) {
    this._finer(displacement, 3, this.positions, scale);
    for (let p = 0; p < this.positions.length; p++) this.positions[p] += this.rest[p];
    if (rod) this._clear(rod);
    this._turn();
  }

  /** One number a point of the grid (n * n) as the fine points' shade. */
  colour(values) {
    this._finer(values, 1, this.shade, 1);
  }

  _finer(values, wide, out, scale) {
    const { n, rows } = this;
    const { count, at, weights } = this.line;
    for (let r = 0; r < n; r++) {
      for (let k = 0, p = r * count * wide; k < count; k++) {
        // beyond the ends weights are 0
        const first = (r * n + Math.max(at[k], 0)) * wide;
        const one = (r * n + at[k] + 1) * wide;
        const last = (r * n + Math.min(at[k] + 3, n - 1)) * wide;
        const [wa, wb, wc, we] = [weights[4 * k], weights[4 * k + 1], weights[4 * k + 2], weights[4 * k + 3]];
        for (let d = 0; d < wide; d++, p++) {
          rows[p] = scale * (wa * values[first + d] + wb * values[one + d] + wc * values[one + wide + d] + we * values[last + d]);
        }
      }
    }
    const wideRow = count * wide;
    for (let k = 0; k < count; k++) {
      const [a, b, c, e] = weights.subarray(4 * k, 4 * k + 4);
      const i = at[k];
      const first = Math.max(i, 0) * wideRow;
      const last = Math.min(i + 3, n - 1) * wideRow;
      const one = (i + 1) * wideRow;
      const two = (i + 2) * wideRow;
      const to = k * wideRow;
      for (let p = 0; p < wideRow; p++) {
        out[to + p] = a * rows[first + p] + b * rows[one + p] + c * rows[two + p] + e * rows[last + p];
      }
    }
  }

  /** Points that the interpolation leaves within the rod are drawn on its surface. */
  _clear({ tip, push, radius, edge }) {
    const { positions } = this;
    const reach = (radius + 1) ** 2;
    for (let p = 0; p < positions.length; p += 3) {
      const x = positions[p] - tip[0];
      const y = positions[p + 1] - tip[1];
      const z = positions[p + 2] - tip[2];
      const along = x * push[0] + y * push[1] + z * push[2]; // less than 0 behind the tip
      if (along >= 0) continue;
      const aside2 = x * x + y * y + z * z - along * along;
      if (aside2 > reach) continue;
      const aside = Math.sqrt(Math.max(aside2, 1e-12));
      const da = along + edge;
      const ds = aside - (radius - edge);
      const inner = Math.max(da, ds);
      const gap = inner <= 0 ? inner - edge : Math.hypot(Math.max(da, 0), Math.max(ds, 0)) - edge;
      if (gap >= 0) continue;
      // to the nearest of end and side, each along its own normal
      if (-along <= radius - aside) {
        const step = Math.min(-along, -gap + 1e-3);
        for (let k = 0; k < 3; k++) positions[p + k] += step * push[k];
      } else {
        const off = [x - along * push[0], y - along * push[1], z - along * push[2]];
        const step = (radius - aside) / aside;
        for (let k = 0; k < 3; k++) positions[p + k] += step * off[k];
      }
    }
  }

  _turn() {
    const { count, positions, normals } = this;
    const row = 3 * count;
    for (let r = 0, p = 0; r < count; r++) {
      const up = r < count - 1 ? row : 0;
      const down = r > 0 ? row : 0;
      for (let c = 0; c < count; c++, p += 3) {
        const right = p + (c < count - 1 ? 3 : 0);
        const left = p - (c > 0 ? 3 : 0);
        const ax = positions[right] - positions[left];
        const ay = positions[right + 1] - positions[left + 1];
        const az = positions[right + 2] - positions[left + 2];
        const bx = positions[p + up] - positions[p - down];
        const by = positions[p + up + 1] - positions[p - down + 1];
        const bz = positions[p + up + 2] - positions[p - down + 2];
        const nx = ay * bz - az * by;
        const ny = az * bx - ax * bz;
        const nz = ax * by - ay * bx;
        const size = 1 / Math.sqrt(nx * nx + ny * ny + nz * nz || 1);
        normals[p] = nx * size;
        normals[p + 1] = ny * size;
        normals[p + 2] = nz * size;
      }
    }
  }
}
