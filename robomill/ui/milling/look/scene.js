// The picture: the part as a height field, tool, arm, planes and lines, in parallel projection. Lengths in mm, in {W}.
const VIEW = `uniform mat3 u_turn; uniform vec3 u_centre; uniform vec4 u_fit; uniform float u_deep;
vec4 seen(vec3 P) { vec3 q = u_turn * (P - u_centre); return vec4(q.xy * u_fit.xy + u_fit.zw, -q.z * u_deep, 1.0); }`;
const LIT = `precision highp float; uniform vec3 u_light; uniform vec3 u_eye;
float lit(vec3 P) { vec3 n = normalize(cross(dFdx(P), dFdy(P))); if (dot(n, u_eye) < 0.0) n = -n;
  return 0.60 + 0.46 * max(dot(n, u_light), 0.0); }`;
const FIELD = [`#version 300 es
${VIEW}
uniform vec4 u_grid; uniform float u_bottom; uniform bool u_voids; uniform bool u_plain;
in vec3 a_cell; in float a_z; in float a_error; in float a_wall;
out vec3 v_P; out float v_error; out float v_cut; out float v_wall; out float v_beside; out float v_side; out float v_void;
void main() {
  bool low = a_cell.z > 0.5;
  vec3 P = vec3(u_grid.xy + a_cell.xy * u_grid.zw, low ? u_bottom : a_z);
  v_P = P; v_error = a_error / 127.0; v_cut = u_plain || a_error < -127.5 ? 0.0 : 1.0; v_side = low ? 1.0 : 0.0;
  if (v_cut == 0.0) v_error = 0.0;
  v_beside = u_plain || low || a_wall < -127.5 ? 0.0 : 1.0; v_wall = v_beside * a_wall / 127.0;
  v_void = u_voids && !low && a_z <= u_bottom + 1e-4 ? 1.0 : 0.0;
  gl_Position = seen(P);
}`, `#version 300 es
${LIT}
uniform vec3 u_metal; uniform vec3 u_stop[5]; uniform vec4 u_open; uniform float u_alpha; uniform vec3 u_tint;
in vec3 v_P; in float v_error; in float v_cut; in float v_wall; in float v_beside; in float v_side; in float v_void;
out vec4 colour;
void main() {
  if (v_void > 0.5 || dot(u_open.xyz, v_P) > u_open.w) discard;
  // A wall has one colour from its foot to its top, its own: not what lies between those of the floor and the rim.
  bool wall = v_beside > 0.99 && abs(normalize(cross(dFdx(v_P), dFdy(v_P))).z) < 0.5;
  float error = wall ? v_wall : v_error / max(v_cut, 1e-3), cut = wall ? 1.0 : v_cut;
  float at = clamp(error, -1.0, 1.0) * 2.0 + 2.0;
  int k = int(min(floor(at), 3.0));
  vec3 told = mix(u_stop[k], u_stop[k + 1], at - float(k));
  vec3 base = mix(u_metal, told, v_side > 0.001 ? 0.0 : smoothstep(0.0, 0.6, cut));
  if (u_alpha < 1.0) base = u_tint;
  colour = vec4(base * lit(v_P), 1.0) * u_alpha;
}`];
const SOLID = [`#version 300 es
${VIEW}
uniform mat3 u_shape; uniform vec3 u_at; uniform vec2 u_radius;
in vec3 a_point; out vec3 v_P;
void main() {
  v_P = u_at + u_shape * vec3(a_point.xy * mix(u_radius.x, u_radius.y, a_point.z), a_point.z);
  gl_Position = seen(v_P);
}`, `#version 300 es
${LIT}
uniform vec4 u_colour; uniform bool u_flat; in vec3 v_P; out vec4 colour;
void main() { colour = vec4(u_colour.rgb * (u_flat ? 1.0 : lit(v_P)), 1.0) * u_colour.a; }`];
const SIDES = 28, FEW = 18_000, COLOUR = /^#(..)(..)(..)$/;
const rgb = (hex) => COLOUR.exec(hex).slice(1).map((x) => parseInt(x, 16) / 255);
const LEVEL = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

class Scene {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: true });
    if (!gl) throw new Error("no WebGL");
    Object.assign(this, { gl, canvas, shapes: new Map() });
    this.field = program(gl, FIELD, ["a_cell", "a_z", "a_error", "a_wall"]);
    this.solid = program(gl, SOLID, ["a_point"]);
    this.loose = gl.createBuffer();
    const tube = [];
    for (let k = 0; k < SIDES; k++) {
      const a = circle(k), b = circle(k + 1);
      tube.push(...a, 0, ...b, 0, ...a, 1, ...b, 0, ...b, 1, ...a, 1);
      tube.push(...a, 0, ...b, 0, 0, 0, 0, ...a, 1, ...b, 1, 0, 0, 1);
    }
    this.shapes.set("tube", this.mesh(tube));
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  mesh(points) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(points), this.gl.STATIC_DRAW);
    return { buffer, count: points.length / 3 };
  }

  // A new cut: cells, their sides, two nets (fine, and coarse while something moves), outlines of the tools.
  show(cut) {
    if (this.cut === cut) return;
    const { gl } = this, { nx, ny } = cut, rim = [];
    for (const buffer of this.made ?? []) gl.deleteBuffer(buffer);
    this.cut = cut;
    for (let i = 0; i < nx - 1; i++) rim.push(i * ny);
    for (let j = 0; j < ny - 1; j++) rim.push((nx - 1) * ny + j);
    for (let i = nx - 1; i > 0; i--) rim.push(i * ny + ny - 1);
    for (let j = ny - 1; j > 0; j--) rim.push(j);
    const cells = new Uint16Array(4 * (cut.count + rim.length));
    const place = (n, c, low) => cells.set([Math.floor(c / ny), c % ny, low, 0], 4 * n);
    for (let c = 0; c < cut.count; c++) place(c, c, 0);
    rim.forEach((c, n) => place(cut.count + n, c, 1));
    this.rim = rim;
    const coarse = Math.ceil(Math.sqrt(cut.count / FEW));
    this.nets = [1, coarse].map((step) => this.net(step, rim));
    this.cells = this.filled(cells);
    this.z = gl.createBuffer();
    this.error = gl.createBuffer();
    this.wall = gl.createBuffer();
    this.made = [this.cells, this.z, this.error, this.wall, ...this.nets.map((net) => net.buffer)];
    this.heights = new Float32Array(cut.count + rim.length);
    this.colours = new Int8Array(cut.count + rim.length).fill(NO_ERROR);
    this.walls = new Int8Array(cut.count + rim.length).fill(NO_ERROR);
    this.loaded = "";
    this.outline = outline(cut);
    cut.about.tools.forEach((parts, t) => parts.forEach((part, n) => this.shapes.set(`${t}.${n}`, this.mesh(turned(part)))));
  }

  filled(data, target = this.gl.ARRAY_BUFFER) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
    return buffer;
  }

  net(step, rim) {
    const { nx, ny, count } = this.cut, index = [], rows = [], columns = [];
    for (let i = 0; i < nx - 1; i += step) rows.push(i);
    for (let j = 0; j < ny - 1; j += step) columns.push(j);
    rows.push(nx - 1);
    columns.push(ny - 1);
    for (let r = 0; r + 1 < rows.length; r++) for (let q = 0; q + 1 < columns.length; q++) {
      const a = rows[r] * ny + columns[q], b = rows[r + 1] * ny + columns[q];
      const c = rows[r] * ny + columns[q + 1], d = rows[r + 1] * ny + columns[q + 1];
      index.push(a, b, c, b, d, c);
    }
    rim.forEach((a, n) => {
      const m = (n + 1) % rim.length, b = rim[m];
      index.push(a, b, count + n, b, count + m, count + n);
    });
    return { buffer: this.filled(new Uint32Array(index), this.gl.ELEMENT_ARRAY_BUFFER), count: index.length };
  }

  // Heights (and colours) of the field to the card, where they are not there already.
  load(name, z, told) {
    if (this.loaded === name) return;
    const { gl, cut } = this;
    this.heights.set(z);
    if (told) {
      this.colours.set(told.error);
      this.walls.set(told.wall);
    }
    for (const [buffer, data] of [[this.z, this.heights], [this.error, this.colours], [this.wall, this.walls]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    }
    this.loaded = name;
  }

  begin(width, height, background) {
    const { gl, canvas } = this;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  // The camera: `eye` towards it, `up`, and points that must be seen (with `more` about them) within the part
  // [left, wide] of the canvas, beside the key and above the words.
  look({ eye, up, points, more, zoom, shift }, left, wide) {
    const { gl, canvas } = this, right = unit(cross(up, eye)), upward = cross(eye, right), axes = [right, upward, eye];
    const sharp = canvas.width / (canvas.clientWidth || canvas.width), words = 26 * sharp;
    const ends = axes.map((v) => points.map((p) => dot(p, v))).map((d) => [Math.min(...d) - more, Math.max(...d) + more]);
    const half = ends.map(([a, b]) => Math.max(0.5 * (b - a), 1e-6));
    const centre = ends.reduce((sum, [a, b], i) => add(sum, axes[i], 0.5 * (a + b)), [0, 0, 0]);
    const w = canvas.width * wide, h = canvas.height, key = left + wide > 0.99 && wide > 0.9 ? 84 * sharp : 0;
    const scale = zoom * 0.95 * Math.min((w - key) / (2 * half[0]), (h - words) / (2 * half[1]));
    gl.viewport(canvas.width * left, 0, w, h);
    this.eye = eye;
    this.view = { turn: [right, upward, eye].flatMap((_, i) => [right[i], upward[i], eye[i]]), centre,
      fit: [(2 * scale) / w, (2 * scale) / h, shift[0] - key / w, shift[1] + words / h], deep: 0.3 / Math.max(...half) };
    this.scale = scale;
    this.light = unit(add(add(eye, right, -0.55), upward, 0.85));
  }

  use(made) {
    const { gl } = this;
    gl.useProgram(made.made);
    gl.uniformMatrix3fv(made.u("u_turn"), false, this.view.turn);
    gl.uniform3fv(made.u("u_centre"), this.view.centre);
    gl.uniform4fv(made.u("u_fit"), this.view.fit);
    gl.uniform1f(made.u("u_deep"), this.view.deep);
    gl.uniform3fv(made.u("u_light"), this.light);
    gl.uniform3fv(made.u("u_eye"), this.eye);
  }

  drawField({ colours, open, alpha = 1, moving, plain = false }) {
    const { gl, cut } = this, made = this.field, net = this.nets[moving ? 1 : 0];
    this.use(made);
    gl.uniform4f(made.u("u_grid"), cut.x0, cut.y0, cut.dx, cut.dy);
    gl.uniform1f(made.u("u_bottom"), cut.about.bottom);
    gl.uniform1i(made.u("u_voids"), cut.about.voids ? 1 : 0);
    gl.uniform1i(made.u("u_plain"), plain ? 1 : 0);
    gl.uniform3fv(made.u("u_metal"), colours.metal);
    gl.uniform3fv(made.u("u_tint"), colours.ghost);
    gl.uniform3fv(made.u("u_stop"), colours.stops.flat());
    gl.uniform4fv(made.u("u_open"), open ?? [0, 0, 0, 1]);
    gl.uniform1f(made.u("u_alpha"), alpha);
    const bind = (name, buffer, size, type) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(made.at[name]);
      gl.vertexAttribPointer(made.at[name], size, type, false, name === "a_cell" ? 8 : 0, 0);
    };
    bind("a_cell", this.cells, 3, gl.UNSIGNED_SHORT);
    bind("a_z", this.z, 1, gl.FLOAT);
    bind("a_error", this.error, 1, gl.BYTE);
    bind("a_wall", this.wall, 1, gl.BYTE);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, net.buffer);
    this.blended(alpha < 1, () => gl.drawElements(gl.TRIANGLES, net.count, gl.UNSIGNED_INT, 0));
    for (const name of ["a_z", "a_error", "a_wall"]) gl.disableVertexAttribArray(made.at[name]);
  }

  blended(on, draw) {
    const { gl } = this;
    if (!on) return draw();
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    draw();
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // A shape by its name, or loose points (triangles or lines), in one colour.
  draw(what, colour, { at = [0, 0, 0], shape = LEVEL, radius = [1, 1], alpha = 1, lines = false, flat = false } = {}) {
    const { gl } = this, made = this.solid, known = typeof what === "string" ? this.shapes.get(what) : null;
    this.use(made);
    gl.bindBuffer(gl.ARRAY_BUFFER, known ? known.buffer : this.loose);
    if (!known) gl.bufferData(gl.ARRAY_BUFFER, what instanceof Float32Array ? what : new Float32Array(what), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(made.at.a_point);
    gl.vertexAttribPointer(made.at.a_point, 3, gl.FLOAT, false, 0, 0);
    gl.uniformMatrix3fv(made.u("u_shape"), false, shape.flat());
    gl.uniform3fv(made.u("u_at"), at);
    gl.uniform2fv(made.u("u_radius"), radius);
    gl.uniform4f(made.u("u_colour"), ...colour, alpha);
    gl.uniform1i(made.u("u_flat"), lines || flat ? 1 : 0);
    const count = known ? known.count : what.length / 3;
    this.blended(alpha < 1, () => gl.drawArrays(lines ? gl.LINES : gl.TRIANGLES, 0, count));
  }

  tube(from, to, r0, r1, colour, alpha = 1) {
    const along = add(to, from, -1), length = Math.hypot(...along);
    if (length < 1e-9) return;
    this.draw("tube", colour, { at: from, shape: frameOf(along.map((v) => v / length), length), radius: [r0, r1], alpha });
  }

  // Waits until the picture is drawn.
  done() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}

function program(gl, [vertex, fragment], names) {
  const made = gl.createProgram(), known = new Map();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? "shader");
    gl.attachShader(made, shader);
  }
  gl.bindAttribLocation(made, 0, names[0]);
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "program");
  const u = (name) => {
    if (!known.has(name)) known.set(name, gl.getUniformLocation(made, name));
    return known.get(name);
  };
  return { made, u, at: Object.fromEntries(names.map((name) => [name, gl.getAttribLocation(made, name)])) };
}

const circle = (k) => [Math.cos((2 * Math.PI * k) / SIDES), Math.sin((2 * Math.PI * k) / SIDES)];

// Three columns: two across `axis` and the axis itself, `length` long.
function frameOf(axis, length = 1) {
  const u = unit(cross(axis, Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  return [u, cross(axis, u), axis.map((v) => v * length)];
}

// A solid of revolution about z from its outline.
function turned({ radius, height }) {
  const points = [], last = radius.length - 1;
  for (let k = 0; k < SIDES; k++) {
    const a = circle(k), b = circle(k + 1), at = (c, q) => [c[0] * radius[q], c[1] * radius[q], height[q]];
    for (let q = 0; q < last; q++) points.push(...at(a, q), ...at(b, q), ...at(a, q + 1), ...at(b, q), ...at(b, q + 1), ...at(a, q + 1));
    for (const q of [0, last]) points.push(...at(a, q), ...at(b, q), 0, 0, height[q]);
  }
  return points;
}

// Where the ideal cut ends, seen from above: segments between cells that it cuts and those it leaves.
function outline(cut) {
  const { nx, ny, x0, y0, dx, dy, ideal, stock } = cut, points = [];
  const is = (i, j) => ideal[i * ny + j] < stock[i * ny + j] - 1e-4;
  for (let i = 0; i + 1 < nx; i++) for (let j = 0; j + 1 < ny; j++) {
    const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]], cutAt = corners.map(([a, b]) => is(a, b)), ends = [];
    for (let e = 0; e < 4; e++) if (cutAt[e] !== cutAt[(e + 1) % 4]) {
      const [a, b] = corners[e], [c, d] = corners[(e + 1) % 4];
      ends.push([x0 + 0.5 * (a + c) * dx, y0 + 0.5 * (b + d) * dy, stock[i * ny + j] + 0.02 * Math.max(dx, dy)]);
    }
    for (let n = 0; n + 1 < ends.length; n += 2) points.push(...ends[n], ...ends[n + 1]);
  }
  return new Float32Array(points);
}
