// What the server sends of a cut, unpacked; and the material as far as it is cut at a station.
const TYPES = { u1: Uint8Array, i1: Int8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array };
const REACHED = 1, JUDGED = 2, JOINED = 4, OVER = 8, NO_ERROR = -128;

async function unpacked({ about, blob }) {
  const packed = Uint8Array.from(atob(blob), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = await new Response(stream).arrayBuffer(), arrays = {};
  for (const [name, [kind, at, length]] of Object.entries(about.arrays)) {
    const Type = TYPES[kind];
    arrays[name] = new Type(bytes, at, length / Type.BYTES_PER_ELEMENT);
  }
  return new Cut(about, arrays);
}

class Cut {
  constructor(about, arrays) {
    Object.assign(this, { about, arrays });
    [this.nx, this.ny, this.x0, this.y0, this.dx, this.dy] = about.grid;
    this.count = this.nx * this.ny;
    this.low = [this.x0 - this.dx / 2, this.y0 - this.dy / 2, about.bottom];
    this.high = [this.x0 + (this.nx - 0.5) * this.dx, this.y0 + (this.ny - 0.5) * this.dy, about.top];
    this.materials = new Map();
    this.ideal = this.heights(arrays.ideal);
    this.stock = arrays.stock ? this.heights(arrays.stock) : new Float32Array(this.count).fill(about.top);
  }

  heights(steps) {
    const z = new Float32Array(steps.length), { low, quantum } = this.about;
    for (let c = 0; c < steps.length; c++) z[c] = low + steps[c] * quantum;
    return z;
  }

  material(times) {
    const level = Math.max(0, this.about.times.indexOf(times));
    if (!this.materials.has(level)) this.materials.set(level, new Material(this, level));
    return this.materials.get(level);
  }

  // Where the cut stands after a share of its length: the last frame passed, and how far it is to the next one.
  at(station) {
    const { s, state } = this.arrays, goal = station * this.about.total;
    let a = 0, b = s.length - 1;
    while (a < b) {
      const m = (a + b + 1) >> 1;
      if (s[m] <= goal + 1e-6) a = m; else b = m - 1;
    }
    const on = a + 1 < s.length && state[a + 1] & JOINED && s[a + 1] > s[a];
    return { frame: a, part: on ? Math.min(Math.max((goal - s[a]) / (s[a + 1] - s[a]), 0), 1) : 0 };
  }

  // The frame nearest to a station among those that count for the verdict; -1 where none does.
  nearest(station) {
    const { s, state } = this.arrays, goal = station * this.about.total, { frame } = this.at(station);
    let best = -1;
    const look = (from, step) => {
      for (let f = from; f >= 0 && f < s.length; f += step) {
        if (!(state[f] & JUDGED)) continue;
        if (best < 0 || Math.abs(s[f] - goal) < Math.abs(s[best] - goal)) best = f;
        if (Math.abs(s[f] - goal) > Math.abs(s[best] - goal)) return;
        if (Math.abs(s[f] - goal) > 1e-9 && f !== frame && f !== frame + 1) return;
      }
    };
    look(frame, -1);
    look(frame + 1, 1);
    return best;
  }

  // The tip with its displacement `times` times enlarged, and the tool's axis.
  tool(place, times) {
    const { p, delta, k } = this.arrays, tip = [0, 0, 0], axis = [0, 0, 0], f = 3 * place.frame, t = place.part;
    for (let i = 0; i < 3; i++) {
      const now = p[f + i] + times * delta[f + i];
      const next = t > 0 ? p[f + 3 + i] + times * delta[f + 3 + i] : now;
      tip[i] = now + t * (next - now);
      axis[i] = k[f + i] + (t > 0 ? t * (k[f + 3 + i] - k[f + i]) : 0);
    }
    return { tip, axis: unit(axis) };
  }

  // The way of the cut in plan at a station.
  way(place) {
    const { p } = this.arrays, from = Math.min(place.part > 0 ? place.frame : place.frame - 1, p.length / 3 - 2);
    for (let f = Math.max(from, 0); f >= 0; f--) {
      const d = [p[3 * f + 3] - p[3 * f], p[3 * f + 4] - p[3 * f + 1], 0];
      if (Math.hypot(d[0], d[1]) > 1e-6) return unit(d);
    }
    return [1, 0, 0];
  }
}

// Heights and colours as far as the cut has come; going back begins with the stock again.
class Material {
  constructor(cut, level) {
    const of = (name) => cut.arrays[`${name}.${level}`];
    Object.assign(this, { cut, final: cut.heights(of("z")), told: of("error"), walls: of("wall"), ready: of("ready") });
    Object.assign(this, { cell: of("cell"), height: cut.heights(of("height")), frame: of("frame") });
    this.z = new Float32Array(cut.stock);
    this.error = new Int8Array(cut.count).fill(NO_ERROR);
    this.wall = new Int8Array(cut.count).fill(NO_ERROR);
    this.now = -1;
    this.next = 0;
  }

  seek(frame) {
    if (frame === this.now) return false;
    if (frame < this.now) {
      this.z.set(this.cut.stock);
      this.next = 0;
    }
    const { z, cell, height, final, ready, error, told, wall, walls } = this;
    while (this.next < cell.length && this.frame[this.next] <= frame) {
      z[cell[this.next]] = height[this.next];
      this.next += 1;
    }
    for (let c = 0; c < z.length; c++) {
      const done = ready[c] <= frame;
      error[c] = done ? told[c] : NO_ERROR;
      wall[c] = done ? walls[c] : NO_ERROR;
      if (done) z[c] = final[c];
    }
    this.now = frame;
    return true;
  }
}

const unit = (v) => { const n = Math.hypot(...v) || 1; return v.map((x) => x / n); };
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
