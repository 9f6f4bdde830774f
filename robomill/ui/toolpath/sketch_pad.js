// The sketch pad. Shapes live here while they are drawn and in Python once they are; Python overwrites them only when
// `rev` changes (undo, presets, the table). Lengths are in the unit of the screen.

const TOOLS = [
  ["select", "Select", "V", "M5 3l12 9-6 1 3 6-2 1-3-6-4 4z"],
  ["line", "Line", "L", "M4 19L20 5"],
  ["polyline", "Polyline", "P", "M3 18l6-9 5 6 7-10"],
  ["arc", "Arc", "A", "M4 18A14 14 0 0 1 20 6"],
  ["rectangle", "Rectangle", "R", "M4 6h16v12H4z"],
  ["circle", "Circle", "C", "M12 4a8 8 0 1 0 0 16a8 8 0 1 0 0-16"],
];
const ACTS = [
  ["undo", "Undo (Ctrl+Z)", "M9 7L4 12l5 5M4 12h10a5 5 0 0 1 0 10h-2"],
  ["redo", "Redo (Ctrl+Y)", "M15 7l5 5-5 5M20 12H10a5 5 0 0 0 0 10h2"],
  ["remove", "Delete the selected shape (Del)", "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13"],
];
const VIEWS = [
  ["closer", "Zoom in (+)", "M12 6v12M6 12h12"],
  ["farther", "Zoom out (−)", "M6 12h12"],
  ["fit", "Show everything (F)", "M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5"],
];
const NEEDS = { line: 2, rectangle: 2, circle: 2, arc: 3, polyline: 2 };
const HINTS = {
  select: ["Drag a point or a shape. Right click deletes. Drag the board to move it."],
  line: ["Click where the line begins, or drag it.", "Click where it ends."],
  polyline: ["Click the first point.", "Click the next points; the first point closes the shape, Enter or a double click ends it."],
  arc: ["Click where the arc begins.", "Click where it ends.", "Click a point on the way."],
  rectangle: ["Click a corner, or drag the rectangle.", "Click the opposite corner."],
  circle: ["Click the centre, or drag the circle.", "Click a point on the circle: the cut begins there."],
};
const NAMES = { select: "Select", line: "line", polyline: "polyline", polygon: "closed polyline", arc: "arc", rectangle: "rectangle", circle: "circle" };
const NEAR = 10, MOVED = 6, MAX_KNOBS = 320;
const svgns = "http://www.w3.org/2000/svg";

const dist = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const same = (a, b) => dist(a, b) < 1e-9;
const clone = (x) => JSON.parse(JSON.stringify(x));

function node(tag, attributes, parent, text) {
  const made = document.createElementNS(svgns, tag);
  for (const [k, v] of Object.entries(attributes)) made.setAttribute(k, v);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.appendChild(made);
  return made;
}

// Centre of the circle through three points, or null where they are on a line.
function centre([a, b, c]) {
  const [ux, uy, vx, vy] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]];
  const twice = 2 * (ux * vy - uy * vx);
  if (Math.abs(twice) < 1e-9 * Math.hypot(ux, uy) * Math.hypot(vx, vy)) return null;
  const u = ux * ux + uy * uy, v = vx * vx + vy * vy;
  return [a[0] + (vy * u - uy * v) / twice, a[1] + (ux * v - vx * u) / twice];
}

// The places where a shape can be taken hold of; `k` says which.
function knobs(e) {
  const p = e.points;
  if (e.shape !== "rectangle") return p.map((q, k) => ({ at: q, k }));
  return [p[0], [p[1][0], p[0][1]], p[1], [p[0][0], p[1][1]]].map((q, k) => ({ at: q, k }));
}

function moveKnob(e, k, to) {
  const p = e.points;
  if (e.shape === "rectangle") {
    if (k === 0) p[0] = to; else if (k === 2) p[1] = to;
    else if (k === 1) { p[1][0] = to[0]; p[0][1] = to[1]; } else { p[0][0] = to[0]; p[1][1] = to[1]; }
  } else if (e.shape === "circle" && k === 0) {
    p[1] = [p[1][0] + to[0] - p[0][0], p[1][1] + to[1] - p[0][1]];
    p[0] = to;
  } else p[k] = to;
}

// Whether a shape can be cut: Python says the same in words.
function sound(e) {
  const p = e.points;
  for (let i = 1; i < p.length; i++) if (same(p[i], p[i - 1])) return false;
  if (e.shape === "rectangle") return Math.abs(p[0][0] - p[1][0]) > 1e-9 && Math.abs(p[0][1] - p[1][1]) > 1e-9;
  if (e.shape === "polygon" || e.shape === "arc") return p.length > 2 && !same(p[0], p[p.length - 1]);
  return p.length > 1;
}

class Pad {
  constructor(root) {
    this.root = root;
    this.board = root.querySelector(".board");
    this.svg = root.querySelector(".board > svg");
    this.at = root.querySelector(".at");
    this.hint = root.querySelector(".hint");
    this.select = root.querySelector("select");
    this.elements = [];
    this.tool = "line";
    this.draft = [];
    this.open = -1;
    this.sel = -1;
    this.cursor = [0, 0];
    this.hover = false;
    this.keys = false;
    this.grab = null;
    this.view = null;
    this.seq = 0;
    this.buttons();
    this.listen();
  }

  // ---- what Python says -------------------------------------------------------------------------------------------
  receive({ data, setStateValue, setTriggerValue }) {
    this.state = setStateValue;
    this.trigger = setTriggerValue;
    const fresh = this.data === undefined, pushed = fresh || data.rev !== this.data.rev;
    const unit = !fresh && data.unit !== this.data.unit;
    this.data = data;
    if (pushed) {
      this.elements = clone(data.elements);
      this.draft = [];
      if (!(this.elements[this.open] && this.elements[this.open].shape === "polyline")) this.open = -1;
      if (this.sel >= this.elements.length) this.sel = -1;
      this.grab = null;
      this.drag = null;
    }
    this.board.style.setProperty("--pad-height", `${data.height}px`);
    this.snaps();
    if (fresh && this.elements.length) this.tool = "select";
    if (fresh || unit || (pushed && !this.visible())) this.fit(); else this.draw();
  }

  send() {
    this.seq += 1;
    this.state("sketch", { rev: this.data.rev, seq: this.seq, grid: this.data.grid, elements: this.elements });
    this.draw();
  }

  history(way) {
    if (way === "undo" && this.draft.length) { this.draft.pop(); this.draw(); return; }
    if (way === "undo" ? !this.data.undo : !this.data.redo) return;
    this.seq += 1;
    this.trigger("history", { way, seq: this.seq });
  }

  // ---- tool bar ---------------------------------------------------------------------------------------------------
  buttons() {
    const add = (where, name, title, path, text) => {
      const b = document.createElement("button");
      b.type = "button"; b.dataset.name = name; b.title = title; b.setAttribute("aria-label", text || title.split(" (")[0]);
      b.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${path}"/></svg>${text ? `<span>${text}</span>` : ""}`;
      this.root.querySelector(where).appendChild(b);
      return b;
    };
    for (const [name, text, key, path] of TOOLS) add(".tools", name, `${text} (${key})`, path, text).onclick = () => this.choose(name);
    for (const [where, some] of [[".acts", ACTS], [".views", VIEWS]]) for (const [name, title, path] of some) add(where, name, title, path).onclick = () => this.act(name);
    this.select.onchange = () => { this.data.grid = Number(this.select.value); this.send(); };
  }

  snaps() {
    const steps = this.data.unit === "in" ? [0, 0.05, 0.1, 0.25, 0.5, 1, 2] : [0, 0.5, 1, 2, 5, 10, 25, 50];
    if (!steps.includes(this.data.grid)) steps.push(this.data.grid);
    steps.sort((a, b) => a - b);
    this.select.innerHTML = steps.map((s) => `<option value="${s}">${s ? `${s} ${this.data.unit}` : "off"}</option>`).join("");
    this.select.value = String(this.data.grid);
  }

  choose(tool) { this.tool = tool; this.draft = []; this.open = -1; this.grab = null; if (tool !== "select") this.sel = -1; this.draw(); }

  act(name) {
    if (name === "undo" || name === "redo") this.history(name);
    else if (name === "remove") this.remove(this.sel);
    else if (name === "fit") this.fit();
    else this.zoom(name === "closer" ? 1.35 : 1 / 1.35);
  }

  remove(i) {
    if (!this.elements[i]) return;
    this.elements.splice(i, 1);
    this.sel = -1; this.open = -1; this.grab = null;
    this.send();
  }

  // ---- view -------------------------------------------------------------------------------------------------------
  size() { return [this.svg.clientWidth || 600, this.svg.clientHeight || 400]; }
  toScreen([x, y]) { const [w, h] = this.size(), v = this.view; return [(x - v.x) * v.s + w / 2, h / 2 - (y - v.y) * v.s]; }
  toWorld([u, v]) { const [w, h] = this.size(); return [(u - w / 2) / this.view.s + this.view.x, (h / 2 - v) / this.view.s + this.view.y]; }

  bounds() {
    const p = [];
    for (const e of this.elements) {
      if (e.shape === "circle" || e.shape === "arc") {
        const c = e.shape === "circle" ? e.points[0] : centre(e.points);
        if (c && e.shape === "circle") { const r = dist(c, e.points[1]); p.push([c[0] - r, c[1] - r], [c[0] + r, c[1] + r]); continue; }
      }
      p.push(...e.points);
    }
    if (!p.length) return null;
    let [x0, y0] = p[0], [x1, y1] = p[0];
    for (const q of p) { x0 = Math.min(x0, q[0]); x1 = Math.max(x1, q[0]); y0 = Math.min(y0, q[1]); y1 = Math.max(y1, q[1]); }
    return [x0, y0, x1, y1];
  }

  fit() {
    const [w, h] = this.size(), unit = this.data.unit === "in" ? 1 / 25.4 : 1;
    const b = this.bounds() || [-70 * unit, -40 * unit, 70 * unit, 40 * unit];
    const margin = this.data.cutter, dx = Math.max(b[2] - b[0] + 2 * margin, 30 * unit), dy = Math.max(b[3] - b[1] + 2 * margin, 30 * unit);
    this.view = { x: (b[0] + b[2]) / 2, y: (b[1] + b[3]) / 2, s: Math.min((w - 110) / dx, (h - 90) / dy) };
    this.draw();
  }

  visible() {
    const b = this.bounds();
    if (!b || !this.view) return !!this.view;
    const [w, h] = this.size(), [u0, v1] = this.toScreen([b[0], b[1]]), [u1, v0] = this.toScreen([b[2], b[3]]);
    return u0 > 0 && v0 > 0 && u1 < w && v1 < h && Math.max((u1 - u0) / w, (v1 - v0) / h) > 0.42;
  }

  zoom(times, at) {
    const [w, h] = this.size(), about = at || [w / 2, h / 2], before = this.toWorld(about);
    this.view.s = Math.min(Math.max(this.view.s * times, 1e-3), 1e5);
    const after = this.toWorld(about);
    this.view.x += before[0] - after[0]; this.view.y += before[1] - after[1];
    this.draw();
  }

  // ---- pointing ---------------------------------------------------------------------------------------------------
  place(event) { const box = this.svg.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; }

  knobAt(screen) {
    let best = null, nearest = NEAR;
    this.elements.forEach((e, i) => {
      if (e.points.length > MAX_KNOBS && i !== this.sel) return;
      for (const { at, k } of knobs(e)) { const d = dist(this.toScreen(at), screen); if (d < nearest) { nearest = d; best = { i, k, at }; } }
    });
    return best;
  }

  snapped(screen, skip) {
    const found = this.knobAt(screen);
    if (found && !(skip && skip.i === found.i && skip.k === found.k)) return [...found.at];
    for (const q of this.draft) if (dist(this.toScreen(q), screen) < NEAR) return [...q];
    return this.toGrid(this.toWorld(screen));
  }

  toGrid([x, y]) {
    const g = this.data.grid || (this.data.unit === "in" ? 0.001 : 0.01);
    return [Number((Math.round(x / g) * g).toFixed(6)), Number((Math.round(y / g) * g).toFixed(6))];
  }

  add(q) {
    if (this.tool === "select") return;
    const { depth, feed } = this.data, shape = this.tool, grown = this.elements[this.open];
    if (shape === "polyline" && grown) {
      const p = grown.points;
      if (same(p[p.length - 1], q)) { this.open = -1; this.draw(); return; }
      if (same(p[0], q)) { if (p.length > 2) { grown.shape = "polygon"; this.open = -1; this.send(); } return; }
      p.push(q);
      this.send();
      return;
    }
    if (this.draft.some((d) => same(d, q))) return;
    this.draft.push(q);
    if (this.draft.length < NEEDS[shape]) { this.draw(); return; }
    const points = shape === "arc" ? [this.draft[0], this.draft[2], this.draft[1]] : this.draft;
    const made = { shape, points: clone(points), depth, feed };
    if (!sound(made)) { this.draft.pop(); this.draw(); return; }
    this.draft = [];
    this.elements.push(made);
    if (shape === "polyline") this.open = this.elements.length - 1;
    this.send();
  }

  deleteAt(screen, index) {
    const knob = this.knobAt(screen), i = knob ? knob.i : index, e = this.elements[i];
    if (!e) { this.draft = []; this.open = -1; this.draw(); return; }
    if (knob && (e.shape === "polyline" || e.shape === "polygon")) {
      const kept = { ...e, points: e.points.filter((_, k) => k !== knob.k) };
      if (kept.points.length === 2 && e.shape === "polygon") kept.shape = "polyline";
      if (sound(kept)) { this.elements[i] = kept; this.send(); return; }
    }
    this.remove(i);
  }

  down(event) {
    this.svg.focus({ preventScroll: true });
    const screen = this.place(event), target = event.target.dataset ? event.target.dataset.i : undefined;
    this.keys = false;
    if (event.button === 2) return;
    event.preventDefault();
    this.svg.setPointerCapture(event.pointerId);
    if (event.button === 1 || event.shiftKey) { this.drag = { kind: "pan", from: screen, view: { ...this.view } }; this.board.classList.add("pan"); return; }
    const knob = this.draft.length ? null : this.knobAt(screen);
    if (knob) { this.sel = this.tool === "select" ? knob.i : this.sel; this.drag = { kind: "knob", ...knob, from: screen, old: clone(this.elements[knob.i]) }; this.draw(); return; }
    if (this.tool === "select") {
      if (target !== undefined) {
        this.sel = Number(target);
        this.drag = { kind: "shape", i: this.sel, from: screen, old: clone(this.elements[this.sel]) };
      } else { this.sel = -1; this.drag = { kind: "pan", from: screen, view: { ...this.view } }; this.board.classList.add("pan"); }
      this.draw();
      return;
    }
    this.drag = { kind: "draw", from: screen };
    this.add(this.snapped(screen));
  }

  move(event) {
    const screen = this.place(event), d = this.drag;
    this.hover = true; this.keys = false;
    if (d && dist(screen, d.from) > MOVED) d.moved = true;
    if (d && d.kind === "pan") {
      this.view.x = d.view.x - (screen[0] - d.from[0]) / d.view.s;
      this.view.y = d.view.y + (screen[1] - d.from[1]) / d.view.s;
    } else if (d && d.kind === "knob" && d.moved) {
      const e = clone(d.old);
      moveKnob(e, d.k, this.snapped(screen, d));
      this.elements[d.i] = e;
    } else if (d && d.kind === "shape" && d.moved) {
      const first = d.old.points[0], to = this.toGrid([first[0] + (screen[0] - d.from[0]) / this.view.s, first[1] - (screen[1] - d.from[1]) / this.view.s]);
      this.elements[d.i] = { ...d.old, points: d.old.points.map((q) => [q[0] + to[0] - first[0], q[1] + to[1] - first[1]]) };
    }
    this.cursor = d && d.kind === "knob" ? this.snapped(screen, d) : this.snapped(screen);
    this.draw();
  }

  up(event) {
    const d = this.drag, screen = this.place(event);
    this.drag = null;
    this.board.classList.remove("pan");
    if (!d) return;
    if ((d.kind === "knob" || d.kind === "shape") && d.moved) {
      if (sound(this.elements[d.i])) this.send(); else { this.elements[d.i] = d.old; this.draw(); }
    } else if (d.kind === "knob" && this.tool !== "select") this.add([...d.at]);
    else if (d.kind === "draw" && d.moved && (this.draft.length || this.open >= 0)) this.add(this.snapped(screen));
  }

  cancel() { const d = this.drag; this.drag = null; this.board.classList.remove("pan"); if (d && d.old) { this.elements[d.i] = d.old; } this.draw(); }

  // ---- keyboard ---------------------------------------------------------------------------------------------------
  key(event) {
    const k = event.key, ctrl = event.ctrlKey || event.metaKey;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    let used = true;
    if (ctrl && (k === "z" || k === "Z")) this.history(event.shiftKey ? "redo" : "undo");
    else if (ctrl && k === "y") this.history("redo");
    else if (ctrl) used = false;
    else if (arrows[k]) this.step(arrows[k], event.shiftKey ? 5 : 1);
    else if (k === "Enter" || k === " ") this.enter();
    else if (k === "Escape") this.escape();
    else if (k === "Delete" || k === "Backspace") { if (this.draft.length) { this.draft.pop(); this.draw(); } else if (this.sel >= 0) this.remove(this.sel); else if (this.keys) this.deleteAt(this.toScreen(this.cursor)); }
    else if (k === "+" || k === "=") this.zoom(1.35);
    else if (k === "-") this.zoom(1 / 1.35);
    else if (k === "f") this.fit();
    else { const tool = TOOLS.find((t) => t[2].toLowerCase() === k.toLowerCase()); if (tool) this.choose(tool[0]); else used = false; }
    if (used) { event.preventDefault(); event.stopPropagation(); }
  }

  step([x, y], times) {
    const g = (this.data.grid || 10 / this.view.s) * times;
    this.keys = true;
    this.cursor = this.toGrid([this.cursor[0] + x * g, this.cursor[1] + y * g]);
    const screen = this.toScreen(this.cursor), [w, h] = this.size();
    if (screen[0] < 20 || screen[0] > w - 20) this.view.x += x * (w / 3) / this.view.s;
    if (screen[1] < 20 || screen[1] > h - 20) this.view.y += y * (h / 3) / this.view.s;
    if (this.grab) { const e = clone(this.grab.old); moveKnob(e, this.grab.k, [...this.cursor]); this.elements[this.grab.i] = e; }
    this.draw();
  }

  enter() {
    this.keys = true;
    if (this.tool !== "select") {
      if (this.open >= 0 && same(this.elements[this.open].points.at(-1), this.cursor)) { this.open = -1; this.draw(); } else this.add([...this.cursor]);
      return;
    }
    if (this.grab) { const g = this.grab; this.grab = null; if (!sound(this.elements[g.i])) this.elements[g.i] = g.old; this.send(); return; }
    let best = null;
    this.elements.forEach((e, i) => { for (const n of knobs(e)) { const d = dist(n.at, this.cursor); if (!best || d < best.d) best = { d, i, k: n.k, at: n.at }; } });
    if (best) { this.grab = { ...best, old: clone(this.elements[best.i]) }; this.sel = best.i; this.cursor = [...best.at]; this.draw(); }
  }

  escape() {
    if (this.grab) { this.elements[this.grab.i] = this.grab.old; this.grab = null; }
    else if (this.draft.length) this.draft = [];
    else if (this.open >= 0) this.open = -1;
    else { this.tool = "select"; this.sel = -1; }
    this.draw();
  }

  listen() {
    const on = (name, action) => this.svg.addEventListener(name, action);
    on("pointerdown", (e) => this.down(e));
    on("pointermove", (e) => this.move(e));
    on("pointerup", (e) => this.up(e));
    on("pointercancel", () => this.cancel());
    on("pointerleave", () => { this.hover = false; if (!this.drag) this.draw(); });
    on("contextmenu", (e) => { e.preventDefault(); this.deleteAt(this.place(e), e.target.dataset && e.target.dataset.i !== undefined ? Number(e.target.dataset.i) : -1); });
    on("dblclick", () => { this.open = -1; this.draft = []; this.draw(); });
    on("keydown", (e) => this.key(e));
    on("focus", () => this.draw());
    on("blur", () => { this.keys = false; this.draw(); });
    this.svg.addEventListener("wheel", (e) => {
      // Only with the pad in focus or Ctrl held: a page that is being scrolled must not stop here.
      if (!e.ctrlKey && this.svg.getRootNode().activeElement !== this.svg) return;
      e.preventDefault();
      this.zoom(Math.exp(-e.deltaY * 0.0016), this.place(e));
    }, { passive: false });
    this.watch = new ResizeObserver(() => { if (this.view) this.draw(); });
    this.watch.observe(this.board);
  }

  // ---- drawing ----------------------------------------------------------------------------------------------------
  path(e) {
    const p = e.points.map((q) => this.toScreen(q)), at = ([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`;
    if (e.shape === "rectangle") return `M${at(p[0])}H${p[1][0]}V${p[1][1]}H${p[0][0]}Z`;
    if (e.shape === "circle") {
      const r = dist(p[0], p[1]), over = [2 * p[0][0] - p[1][0], 2 * p[0][1] - p[1][1]];
      return `M${at(p[1])}A${r} ${r} 0 1 0 ${at(over)}A${r} ${r} 0 1 0 ${at(p[1])}`;
    }
    if (e.shape === "arc") {
      const c = centre(p);
      if (c) {
        const side = (a, b, q) => (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
        const r = dist(c, p[0]), way = side(p[0], p[2], p[1]), mid = side(p[0], p[2], c);
        return `M${at(p[0])}A${r} ${r} 0 ${way * mid > 0 ? 1 : 0} ${way > 0 ? 0 : 1} ${at(p[2])}`;
      }
    }
    return `M${p.map(at).join("L")}${e.shape === "polygon" ? "Z" : ""}`;
  }

  nice(pixels) {
    const raw = pixels / this.view.s, ten = 10 ** Math.floor(Math.log10(raw));
    return [1, 2, 5, 10].map((m) => m * ten).find((s) => s >= raw * 0.999);
  }

  drawGrid(into) {
    const [w, h] = this.size(), [x0, y1] = this.toWorld([0, 0]), [x1, y0] = this.toWorld([w, h]);
    const major = this.nice(64), parts = Math.round(major / this.nice(11)) || 1, minor = major / (parts === 4 ? 2 : parts);
    const digits = Math.max(0, -Math.floor(Math.log10(major) + 1e-9));
    for (const [step, name] of [[minor, "minor"], [major, "major"]]) {
      let d = "";
      for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) d += `M${this.toScreen([x, 0])[0].toFixed(1)} 0V${h}`;
      for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) d += `M0 ${this.toScreen([0, y])[1].toFixed(1)}H${w}`;
      node("path", { d, class: name }, into);
    }
    const [ox, oy] = this.toScreen([0, 0]);
    node("path", { d: `M${ox} 0V${h}M0 ${oy}H${w}`, class: "axis" }, into);
    for (let x = Math.ceil(x0 / major) * major; x <= x1; x += major) {
      const u = this.toScreen([x, 0])[0];
      if (u > 34 && u < w - 24) node("text", { x: u, y: h - 7, class: "tick", "text-anchor": "middle" }, into, this.number(x, digits));
    }
    for (let y = Math.ceil(y0 / major) * major; y <= y1; y += major) {
      const v = this.toScreen([0, y])[1];
      if (v > 16 && v < h - 22) node("text", { x: 7, y: v + 4, class: "tick" }, into, this.number(y, digits));
    }
    node("text", { x: w - 8, y: h - 7, class: "tick", "text-anchor": "end" }, into, this.data.unit);
    if (ox > 10 && ox < w - 40 && oy > 20 && oy < h - 10) node("text", { x: ox + 7, y: oy + 16, class: "frame" }, into, "{W}");
  }

  number(value, digits) { return (Math.abs(value) < 1e-9 ? 0 : value).toFixed(digits).replace("-", "−"); }

  drawReach(into) {
    const reach = this.data.reach;
    if (!reach) return;
    const pattern = node("pattern", { id: "rm-hatch", width: 9, height: 9, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }, node("defs", {}, into));
    node("line", { x1: 0, y1: 0, x2: 0, y2: 9, class: "hatchline" }, pattern);
    let d = "";
    for (const [row, from, to] of reach.runs) {
      const [u0, v1] = this.toScreen([reach.x + from * reach.dx, reach.y + row * reach.dy]);
      const [u1, v0] = this.toScreen([reach.x + to * reach.dx, reach.y + (row + 1) * reach.dy]);
      d += `M${u0.toFixed(1)} ${v0.toFixed(1)}H${u1.toFixed(1)}V${v1.toFixed(1)}H${u0.toFixed(1)}Z`;
    }
    if (!d) return;
    node("path", { d, class: "far" }, into);
    node("text", { x: 42, y: this.size()[1] - 26, class: "tick" }, into, "hatched: out of the arm's reach");
  }

  drawShapes(into) {
    for (const e of this.elements) node("path", { d: this.path(e), class: "swath", "stroke-width": Math.max(this.data.cutter * this.view.s, 1) }, into);
    this.elements.forEach((e, i) => {
      const on = i === this.sel || i === this.open, d = this.path(e);
      node("path", { d, class: on ? "line on" : "line" }, into);
      const p = e.points.map((q) => this.toScreen(q));
      if (["line", "polyline", "polygon"].includes(e.shape) && dist(p[0], p[1]) > 44) {
        const a = Math.atan2(p[1][1] - p[0][1], p[1][0] - p[0][0]), m = [p[0][0] * 0.5 + p[1][0] * 0.5, p[0][1] * 0.5 + p[1][1] * 0.5];
        const wing = (t) => `${(m[0] - 8 * Math.cos(a + t)).toFixed(1)} ${(m[1] - 8 * Math.sin(a + t)).toFixed(1)}`;
        node("path", { d: `M${wing(0.5)}L${m[0]} ${m[1]}L${wing(-0.5)}`, class: "chevron" }, into);
      }
      node("path", { d, class: "hit", "data-i": i }, into);
    });
    const count = this.elements.reduce((n, e) => n + e.points.length, 0), many = count > MAX_KNOBS, crowd = count > 40;
    this.elements.forEach((e, i) => {
      if (!many || (i === this.sel && e.points.length <= MAX_KNOBS)) for (const { at, k } of knobs(e)) {
        const [u, v] = this.toScreen(at), held = this.drag && this.drag.kind === "knob" && this.drag.i === i && this.drag.k === k;
        const begins = k === (e.shape === "circle" ? 1 : 0);
        node("circle", { cx: u, cy: v, r: (begins ? 5 : 4.4) * (crowd ? 0.72 : 1), class: `knob${begins ? " start" : ""}${held ? " on" : ""}`, "data-i": i }, into);
      }
      if (this.elements.length <= 60) {
        const [u, v] = this.toScreen(e.shape === "circle" ? e.points[1] : e.points[0]);
        node("text", { x: u + 8, y: v - 8, class: "tag" }, into, String(i + 1));
      }
    });
  }

  drawDraft(into) {
    const live = this.hover || this.keys, grown = this.elements[this.open];
    const from = this.draft.length ? this.draft : this.tool === "polyline" && grown ? [grown.points.at(-1)] : [];
    if (live && this.tool !== "select" && !(this.drag && this.drag.kind !== "draw")) {
      const [u, v] = this.toScreen(this.cursor), [w, h] = this.size();
      node("path", { d: `M${u} 0V${h}M0 ${v}H${w}`, class: "cross" }, into);
      node("circle", { cx: u, cy: v, r: 6, class: "pin" }, into);
    }
    if (this.keys && this.tool === "select") { const [u, v] = this.toScreen(this.cursor); node("circle", { cx: u, cy: v, r: 9, class: "pin" }, into); }
    if (!from.length) return;
    for (const q of this.draft) { const [u, v] = this.toScreen(q); node("circle", { cx: u, cy: v, r: 5, class: "knob start" }, into); }
    if (!live || same(from.at(-1), this.cursor)) return;
    const shape = this.tool === "polyline" || (this.tool === "arc" && from.length === 1) ? "line" : this.tool;
    const points = this.tool === "arc" && from.length === 2 ? [from[0], this.cursor, from[1]] : [from[0], this.cursor];
    node("path", { d: this.path({ shape, points }), class: "draft" }, into);
    const [u, v] = this.toScreen(this.cursor), [dx, dy] = [this.cursor[0] - from[0][0], this.cursor[1] - from[0][1]], digits = this.data.unit === "in" ? 3 : 1;
    let text = `${Math.hypot(dx, dy).toFixed(digits)} ${this.data.unit}`;
    if (shape === "rectangle") text = `${Math.abs(dx).toFixed(digits)} × ${Math.abs(dy).toFixed(digits)} ${this.data.unit}`;
    if (shape === "circle") text = `R ${text}`;
    if (shape === "arc") { const c = centre(points); text = c ? `R ${dist(c, points[0]).toFixed(digits)} ${this.data.unit}` : ""; }
    node("text", { x: u + 12, y: v - 10, class: "dim" }, into, text);
  }

  draw() {
    if (!this.view || !this.data) return;
    const into = document.createDocumentFragment();
    this.drawGrid(into);
    this.drawReach(into);
    this.drawShapes(into);
    this.drawDraft(into);
    this.svg.replaceChildren(into);
    const digits = this.data.unit === "in" ? 3 : 2;
    this.at.textContent = this.hover || this.keys ? `x ${this.number(this.cursor[0], digits)}   y ${this.number(this.cursor[1], digits)} ${this.data.unit}` : "";
    this.board.classList.toggle("select", this.tool === "select");
    for (const b of this.root.querySelectorAll(".tools button")) b.setAttribute("aria-pressed", String(b.dataset.name === this.tool));
    const set = (name, off) => { this.root.querySelector(`[data-name="${name}"]`).disabled = off; };
    set("undo", !this.data.undo && !this.draft.length); set("redo", !this.data.redo); set("remove", this.sel < 0);
    const steps = HINTS[this.tool];
    let hint = steps[Math.min(this.open >= 0 ? 1 : this.draft.length, steps.length - 1)];
    if (this.grab) hint = "Move the point with the arrow keys; Enter puts it down, Escape puts it back.";
    else if (this.tool === "select" && this.sel >= 0 && this.elements[this.sel]) hint = `Shape ${this.sel + 1}, ${NAMES[this.elements[this.sel].shape]}: drag it, Del removes it.`;
    if (this.hint.textContent !== hint) this.hint.textContent = hint;
    this.svg.setAttribute("aria-label", `Sketch pad with ${this.elements.length} shape${this.elements.length === 1 ? "" : "s"}. Arrow keys move the cursor, Enter sets a point, Escape ends, letters choose tools.`);
  }
}

export default function (component) {
  const root = component.parentElement.querySelector(".pad");
  if (!root.pad) root.pad = new Pad(root);
  root.pad.receive(component);
  return () => { if (!root.isConnected && root.pad) root.pad.watch.disconnect(); };
}
