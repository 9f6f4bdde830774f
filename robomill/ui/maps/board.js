// Maps over the planes of a region. All planes are here: the slider draws another one without asking the server, which
// gets the plane that was settled on, and the cell that was clicked. Every number was computed there.
const LEFT = 52, RIGHT = 74, FOOT = 40, CAPTION = 22, GAP = 10, SETTLED_MS = 400, SHADES = 1024;
const NARROW = 480, FLAT = 46, LEAST_HIGH = 60;  // px: where colour bars lie beneath the maps, how high one is then
const TITLED = 136;  // px that a title takes with its range: a map that is less wide stands apart from the next one

const make = (name, className = "", text = "") => {
  const made = document.createElement(name);
  if (className) made.className = className;
  if (text) made.textContent = text;
  return made;
};
const titled = (parent, text, sub) => {
  parent.replaceChildren();
  text.split(sub ? /_(\w+)/ : /(?!)/).forEach((part, k) => {
    if (part) parent.appendChild(k % 2 ? make("sub", "", part) : document.createTextNode(part));
  });
};
const decoded = (text) => {
  const bytes = atob(text), codes = new Uint16Array(bytes.length / 2);
  for (let k = 0; k < codes.length; k++) codes[k] = bytes.charCodeAt(2 * k) | (bytes.charCodeAt(2 * k + 1) << 8);
  return codes;
};
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
const shades = (scale) => {
  const stops = scale.stops.map(([share, hex]) => [share, rgb(hex)]), found = new Uint32Array(SHADES);
  for (let k = 0, s = 0; k < SHADES; k++) {
    const share = (k + 0.5) / SHADES;
    while (s < stops.length - 2 && share > stops[s + 1][0]) s++;
    const [a, low] = stops[s], [b, high] = stops[s + 1], t = b > a ? Math.min(Math.max((share - a) / (b - a), 0), 1) : 1;
    const [r, g, bl] = low.map((c, i) => Math.round(c + t * (high[i] - c)));
    found[k] = (255 << 24) | (bl << 16) | (g << 8) | r;
  }
  return found;
};
const bright = (shade) => 0.30 * (shade & 255) + 0.59 * ((shade >> 8) & 255) + 0.11 * ((shade >> 16) & 255) > 140;
const fixed = (value, digits) => {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
};

// The value of a panel at cell (i, j) of plane k; null where it is not reached.
const valueAt = (data, panel, codes, i, j, k) => {
  const code = codes[(k * data.v.at.length + j) * data.u.at.length + i];
  return code ? panel.low + (code - 1) / 65534 * (panel.high - panel.low) : null;
};
const worded = (data, panel, value) => {
  const scale = data.scales[panel.scale];
  if (value === null) return "not reached";
  if (scale.words.length) return scale.words[Math.round(value)];
  return `${fixed(value, scale.digits)} ${panel.unit}`.trim();
};
const placed = (data, i, j, k) => `${data.u.letter} ${data.u.said[i]}, ${data.v.letter} ${data.v.said[j]}, ` +
  `${data.w.letter} ${data.w.said[k]} ${data.unit}`;

// Marching squares: the line on which a plane has the value `level`, as pieces [u0, v0, u1, v1] in cells.
const contour = (values, nu, nv, level) => {
  const pieces = [];
  for (let j = 0; j + 1 < nv; j++) for (let i = 0; i + 1 < nu; i++) {
    const k = j * nu + i, a = values[k], b = values[k + 1], c = values[k + nu + 1], d = values[k + nu];
    if (!(a === a && b === b && c === c && d === d)) continue;
    const cut = [];
    if ((a < level) !== (b < level)) cut.push(i + (level - a) / (b - a), j);
    if ((b < level) !== (c < level)) cut.push(i + 1, j + (level - b) / (c - b));
    if ((d < level) !== (c < level)) cut.push(i + (level - d) / (c - d), j + 1);
    if ((a < level) !== (d < level)) cut.push(i, j + (level - a) / (d - a));
    for (let n = 0; n + 3 < cut.length; n += 4) pieces.push(cut.slice(n, n + 4));
  }
  return pieces;
};

class Board {
  constructor(root) {
    this.root = root;
    this.part = (name) => root.querySelector(`.${name}`);
    this.seq = 0;
    this.timer = 0;
    this.sent = [];
    this.told = "";
    this.wait = () => {};
    this.part("png").onclick = () => this.save();
    this.watch = new ResizeObserver(() => { if (this.data) { this.layOut(); this.draw(); } });
    this.watch.observe(root);
  }

  // What Python says now; drawn once the codes of its maps are on the page, too.
  show(data, send) {
    this.send = send;
    removeEventListener("robomill-codes", this.wait);
    const codes = this.data?.rev === data.rev ? [] : window.robomillCodes?.get(data.rev);
    if (codes) this.take(data, codes);
    else addEventListener("robomill-codes", this.wait = () => this.show(data, send));
  }

  take(data, codes) {
    const fresh = this.data?.rev !== data.rev;
    const moved = fresh ? this.data?.w.at : null;
    this.data = data;
    if (fresh) {
      this.codes = codes.map(decoded);
      this.shades = data.scales.map(shades);
    }
    this.adopt(fresh, moved);
    if (fresh) { this.build(); this.layOut(); }
    this.draw();
  }

  // The plane that Python holds, unless the slider is ahead of it.
  adopt(fresh, before) {
    const told = JSON.stringify(this.data.at);
    const ahead = this.timer || (this.told !== told && JSON.stringify(this.sent) === told);
    const same = before && JSON.stringify(before) === JSON.stringify(this.data.w.at) && this.at?.length === this.data.at.length;
    if (!this.at || (fresh && !same) || (told !== this.told && !ahead)) {
      this.at = [...this.data.at];
      this.forget();
    }
    this.told = told;
    this.inputs?.forEach((input, n) => this.set(input, n));
  }

  forget() { clearTimeout(this.timer); this.timer = 0; }

  set(input, n) {
    const { w, unit } = this.data, k = this.at[n];
    if (!input.isConnected || w.at[k] === undefined) return;
    if (Number(input.value) !== w.at[k]) input.value = w.at[k];
    input.setAttribute("aria-valuetext", `${w.said[k]} ${unit}`);
    input.parentElement.querySelector("output").textContent = `${w.said[k]} ${unit}`;
  }

  build() {
    const { data } = this, { w } = data, sliders = this.part("sliders"), board = this.part("board");
    const count = w.at.length, names = data.at.length > 1 ? [" left", " right"] : [""];
    const keep = this.inputs?.length === names.length && count > 1 && sliders.childElementCount === names.length;
    if (!keep) {
      sliders.replaceChildren();
      this.inputs = count > 1 ? names.map(() => {
        const label = make("label"), input = make("input");
        input.type = "range";
        label.append(make("span"), input, make("output"));
        sliders.appendChild(label);
        return input;
      }) : [];
    }
    this.inputs.forEach((input, n) => {
      const name = `${w.letter}${names[n]}, ${data.unit}`;
      input.parentElement.querySelector("span").textContent = name;
      Object.assign(input, { min: w.at[0], max: w.at[count - 1], step: String((w.at[count - 1] - w.at[0]) / (count - 1)) });
      input.setAttribute("aria-label", name);
      input.oninput = () => this.move(n, Number(input.value));
      input.onblur = () => this.settle();
      this.set(input, n);
    });
    board.replaceChildren();
    this.panels = data.panels.map((panel) => {
      const figure = make("figure", "map"), caption = make("figcaption"), title = make("b"), note = make("i");
      titled(title, panel.title, panel.sub);
      caption.append(title, note);
      const canvas = make("canvas");
      figure.append(caption, canvas);
      figure.tabIndex = 0;
      figure.setAttribute("role", "img");
      board.appendChild(figure);
      const off = make("canvas");
      Object.assign(off, { width: data.u.at.length, height: data.v.at.length });
      const made = { panel, figure, canvas, note, off, image: off.getContext("2d").createImageData(off.width, off.height) };
      canvas.onpointermove = (event) => this.point(made, this.cellUnder(made, event));
      canvas.onpointerleave = () => this.point(made, null);
      canvas.onclick = (event) => this.pick(made, this.cellUnder(made, event));
      figure.onkeydown = (event) => this.steer(made, event);
      figure.onblur = () => this.point(made, null);
      return made;
    });
    this.bars = data.scales.flatMap((scale, k) => scale.kind === "reach" || !data.panels.some((p) => p.scale === k) ? [] : [{ scale, k }]);
    for (const bar of this.bars) board.appendChild(bar.canvas = make("canvas", "bar"));
    this.legend();
  }

  legend() {
    const key = this.part("key"), kinds = new Set(this.data.outlines.map((each) => each.kind));
    key.replaceChildren();
    const entry = (words, draw) => {
      const canvas = make("canvas"), span = make("span");
      const context = this.sized(canvas, 18, 12);
      draw(context);
      span.append(canvas, words);
      key.appendChild(span);
    };
    entry("not reached", (c) => { c.fillStyle = this.hatch(c); c.fillRect(0, 0, 18, 12); });
    for (const kind of kinds) entry(kind === "part" ? "part" : "path of the cut", (c) => this.stroke(c, kind, () => {
      if (kind === "part") c.rect(2, 2, 14, 8); else { c.moveTo(1, 6); c.lineTo(17, 6); }
    }));
    if (this.data.point) entry("selected point", (c) => this.dot(c, 9, 6, true));
  }

  // Sizes in CSS pixels; the canvas has as many as the screen.
  sized(canvas, width, height) {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    return context;
  }

  // Where each panel stands: as Python says; in a narrow window each map once, two beside each other at most.
  arrange() {
    const { data } = this, columns = data.columns > 2 ? 2 : 1, seen = new Set();
    this.narrow = this.part("board").clientWidth < NARROW;
    this.root.classList.toggle("narrow", this.narrow);
    const alike = ({ panel }) => `${panel.codes} ${panel.slider} ${panel.scale}`;
    this.shown = this.panels.filter((made) => !this.narrow || (!seen.has(alike(made)) && seen.add(alike(made))));
    const by = data.scales.map((_, k) => this.shown.filter(({ panel }) => panel.scale === k));
    const paired = columns === 2 && by.length === 2 && by[0].length === by[1].length;
    this.shown.forEach((made, n) => {
      const { panel } = made;
      [made.row, made.column] = !this.narrow ? [panel.row, panel.column]
        : paired ? [by[panel.scale].indexOf(made), panel.scale] : [Math.floor(n / columns), n % columns];
    });
    for (const made of this.panels) made.figure.style.display = this.shown.includes(made) ? "" : "none";
    this.rows = 1 + Math.max(...this.shown.map((made) => made.row));
    this.columns = 1 + Math.max(...this.shown.map((made) => made.column));
  }

  // X and Y have the same scale, the largest at which all panels fit; the board is as high as they are.
  layOut() {
    this.arrange();
    const { data, rows, columns } = this, board = this.part("board"), [u0, u1] = data.u.span, [v0, v1] = data.v.span;
    const over = rows > 1 && this.bars.length > 1;  // bars over each other leave the maps more room
    const beside = this.narrow ? 0 : over ? 1 : this.bars.length;
    const wide = board.clientWidth - LEFT - RIGHT * beside - GAP * (columns - 1) - 2;
    const most = Math.min(Math.max(wide / columns * (v1 - v0) / (u1 - u0), LEAST_HIGH), data.most);
    const scale = Math.max(Math.min(wide / columns / (u1 - u0), most / (v1 - v0)), 1e-9);
    this.w = Math.max((u1 - u0) * scale, 24);
    this.pitch = Math.max(this.w, Math.min(wide / columns, TITLED));
    this.h = Math.max((v1 - v0) * scale, 16);
    const whole = rows * (this.h + CAPTION + GAP) - GAP - CAPTION, foot = CAPTION + whole + FOOT + 2;
    board.style.height = `${foot + (this.narrow ? FLAT * this.bars.length : 0)}px`;
    const lowest = (one) => !this.shown.some((p) => p.column === one.column && p.row > one.row);
    const first = (one) => !this.shown.some((p) => p.row === one.row && p.column < one.column);
    const room = this.room = Math.floor(Math.min((this.pitch - this.w) / 2, 24));  // for a number under either end
    for (const made of this.shown) {
      const { figure } = made;
      made.first = first(made);
      made.left = made.first ? LEFT : room;
      made.foot = lowest(made) ? FOOT : 0;
      const x = LEFT + made.column * (this.pitch + GAP) - made.left, y = made.row * (this.h + CAPTION + GAP);
      Object.assign(figure.style, { left: `${x}px`, top: `${y}px`, width: `${this.pitch + made.left + 2}px` });
      figure.querySelector("figcaption").style.paddingLeft = `${made.left}px`;
      made.context = this.sized(made.canvas, this.w + made.left + room + 2, this.h + made.foot + 2);
    }
    if (this.narrow) {
      this.bars.forEach((bar, n) => {
        Object.assign(bar.canvas.style, { left: `${LEFT}px`, top: `${foot + n * FLAT}px` });
        this.drawFlatBar(bar, this.sized(bar.canvas, wide, FLAT), wide);
      });
      return;
    }
    const right = LEFT + columns * this.pitch + (columns - 1) * GAP + 10;
    const long = over ? (whole - 24 * (this.bars.length - 1)) / this.bars.length : whole;
    this.bars.forEach((bar, n) => {
      const top = CAPTION - 6 + (over ? n * (long + 24) : 0);
      Object.assign(bar.canvas.style, { left: `${right + (over ? 0 : n * RIGHT)}px`, top: `${top}px` });
      this.drawBar(bar, this.sized(bar.canvas, RIGHT, long + 12), long);
    });
  }

  drawBar({ scale, k }, c, whole) {
    const { colours } = this.data, top = 6, count = this.shades[k].length;
    for (let y = 0; y < whole; y++) {
      const shade = this.shades[k][Math.min(count - 1, Math.floor((1 - (y + 0.5) / whole) * count))];
      c.fillStyle = `rgb(${shade & 255},${(shade >> 8) & 255},${(shade >> 16) & 255})`;
      c.fillRect(0, top + y, 10, 1.2);
    }
    this.font(c, 11, colours.muted);
    c.textBaseline = "middle";
    let widest = 0;
    const every = Math.max(1, Math.ceil(15 * scale.ticks.length / whole));
    for (const [value, words] of scale.ticks.filter((_, n) => n % every === 0)) {
      c.fillText(words, 14, top + (1 - (value - scale.low) / (scale.high - scale.low)) * whole);
      widest = Math.max(widest, c.measureText(words).width);
    }
    c.save();
    c.translate(Math.min(20 + widest, RIGHT - 14), top + whole / 2);
    c.rotate(Math.PI / 2);
    this.font(c, 12, colours.muted);
    c.textAlign = "center";
    c.textBaseline = "bottom";
    if (scale.kind !== "joints") c.fillText(scale.title.replace(/_(\w+)/g, "$1"), 0, 0, whole);
    c.restore();
  }

  drawFlatBar({ scale, k }, c, whole) {
    const { colours } = this.data, count = this.shades[k].length, inner = whole - 24;
    for (let x = 0; x < inner; x++) {
      const shade = this.shades[k][Math.min(count - 1, Math.floor((x + 0.5) / inner * count))];
      c.fillStyle = `rgb(${shade & 255},${(shade >> 8) & 255},${(shade >> 16) & 255})`;
      c.fillRect(12 + x, 14, 1.2, 9);
    }
    this.font(c, 11, colours.muted);
    c.textBaseline = "top";
    if (scale.kind !== "joints") c.fillText(scale.title.replace(/_(\w+)/g, "$1"), 12, 0, inner);
    c.textAlign = "center";
    const every = Math.max(1, Math.ceil(44 * scale.ticks.length / inner));
    for (const [value, words] of scale.ticks.filter((_, n) => n % every === 0)) {
      c.fillText(words, 12 + (value - scale.low) / (scale.high - scale.low) * inner, 27);
    }
    c.textAlign = "start";
  }

  font(c, size, colour) {
    c.font = `${size}px ${getComputedStyle(this.root).fontFamily}`;
    c.fillStyle = colour;
  }

  hatch(c) {
    if (!this.tile || this.tile.rev !== this.data.rev) {
      const tile = make("canvas");
      tile.width = tile.height = 8;
      const t = tile.getContext("2d");
      t.strokeStyle = this.data.colours.line;
      t.lineWidth = 1;
      t.globalAlpha = 0.7;
      for (const x of [-8, 0, 8]) { t.beginPath(); t.moveTo(x, 8); t.lineTo(x + 8, 0); t.stroke(); }
      this.tile = { rev: this.data.rev, tile };
    }
    return c.createPattern(this.tile.tile, "repeat");
  }

  stroke(c, kind, path) {
    for (const [colour, width] of [[this.data.colours.background, 3.4], [this.data.colours.text, kind === "part" ? 1.2 : 1.8]]) {
      c.beginPath();
      path();
      c.strokeStyle = colour;
      c.lineWidth = width;
      c.setLineDash(kind === "part" && width < 3 ? [4, 3] : []);
      c.stroke();
    }
    c.setLineDash([]);
  }

  dot(c, x, y, full, size = 4.2) {
    c.beginPath();
    c.arc(x, y, size, 0, 2 * Math.PI);
    c.lineWidth = 4;
    c.strokeStyle = this.data.colours.background;
    c.stroke();
    c.lineWidth = 1.8;
    c.strokeStyle = c.fillStyle = this.data.colours.text;
    c.stroke();
    if (full) c.fill();
  }

  draw() {
    for (const made of this.shown) this.drawPanel(made);
    const { data } = this;
    for (const { panel, figure, note } of this.shown) {
      const k = this.at[panel.slider], words = panel.notes[k] ?? "";
      if (note.textContent !== words) note.textContent = words;
      figure.setAttribute("aria-label", `${panel.title} over the plane ${data.w.letter} = ${data.w.said[k]} ${data.unit}: ${words}`);
      figure.dataset.drawn = data.w.drawn[k];
    }
  }

  drawPanel(made) {
    const { data, w, h } = this, { panel, context: c, off, image, left } = made;
    const nu = data.u.at.length, nv = data.v.at.length, k = this.at[panel.slider], codes = this.codes[panel.codes];
    const scale = data.scales[panel.scale], found = this.shades[panel.scale], pixels = new Uint32Array(image.data.buffer);
    const a = (panel.high - panel.low) / 65534 / (scale.high - scale.low) * SHADES;
    const b = (panel.low - scale.low) / (scale.high - scale.low) * SHADES - a;
    const values = made.values = new Float32Array(nu * nv);
    const step = (panel.high - panel.low) / 65534;
    for (let j = 0; j < nv; j++) for (let i = 0; i < nu; i++) {
      const code = codes[(k * nv + j) * nu + i];
      values[j * nu + i] = code ? panel.low + (code - 1) * step : NaN;
      pixels[(nv - 1 - j) * nu + i] = code ? found[Math.min(Math.max(Math.floor(code * a + b), 0), SHADES - 1)] : 0;
    }
    off.getContext("2d").putImageData(image, 0, 0);
    c.clearRect(0, 0, w + left + this.room + 4, h + made.foot + 4);
    c.save();
    c.translate(left, 0);
    c.fillStyle = this.hatch(c);
    c.fillRect(0, 0, w, h);
    c.imageSmoothingEnabled = false;
    c.drawImage(off, 0, 0, w, h);
    c.save();
    c.beginPath();
    c.rect(0, 0, w, h);
    c.clip();
    const [u0, u1] = data.u.span, [v0, v1] = data.v.span;
    made.x = (u) => (u - u0) / (u1 - u0) * w;
    made.y = (v) => h - (v - v0) / (v1 - v0) * h;
    this.contours(made, c, values);
    for (const { kind, points } of data.outlines) this.stroke(c, kind, () => {
      points.forEach(([u, v], n) => (n ? c.lineTo(made.x(u), made.y(v)) : c.moveTo(made.x(u), made.y(v))));
    });
    if (data.point) {
      const apart = data.w.at.length > 1 ? Math.abs(data.w.at[1] - data.w.at[0]) : 1;
      this.dot(c, made.x(data.point[0]), made.y(data.point[1]), Math.abs(data.point[2] - data.w.at[k]) < 0.51 * apart, w < 200 ? 2.8 : 4.2);
    }
    if (made.over) {
      const [i, j] = made.over;
      c.strokeStyle = data.colours.text;
      c.lineWidth = 1.5;
      c.strokeRect(i * w / nu, h - (j + 1) * h / nv, w / nu, h / nv);
    }
    c.restore();
    this.axes(made, c);
    c.restore();
  }

  contours(made, c, values) {
    const { data, w, h } = this, { panel } = made, nu = data.u.at.length, nv = data.v.at.length, scale = data.scales[panel.scale];
    const taken = [], levels = panel.contours;
    const at = data.point && [made.x(data.point[0]), made.y(data.point[1])];
    made.words = [];
    levels.forEach(([level, words], n) => {
      const pieces = contour(values, nu, nv, level);
      if (!pieces.length) return;
      const shade = this.shades[panel.scale][Math.min(Math.max(Math.floor((level - scale.low) / (scale.high - scale.low) * SHADES), 0), SHADES - 1)];
      const [ink, paper] = bright(shade) ? ["#17222B", "#FFFFFF"] : ["#FFFFFF", "#17222B"];
      const x = (i) => (i + 0.5) * w / nu, y = (j) => h - (j + 0.5) * h / nv;
      c.beginPath();
      for (const [i0, j0, i1, j1] of pieces) { c.moveTo(x(i0), y(j0)); c.lineTo(x(i1), y(j1)); }
      c.strokeStyle = ink;
      c.globalAlpha = 0.55;
      c.lineWidth = 1;
      c.stroke();
      c.globalAlpha = 1;
      // The value stands where its line is far from the rim and from other values.
      let best = null, room = 9;
      for (const [i0, j0] of pieces) {
        const px = x(i0), py = y(j0);
        let free = Math.min(px - 8, w - px - 8, (py) * 1.6, (h - py) * 1.6, 60);
        for (const [tx, ty] of taken) free = Math.min(free, Math.hypot((px - tx) * 0.6, (py - ty) * 1.4));
        if (at) free = Math.min(free, Math.hypot((px - at[0]) * 0.36, (py - at[1]) * 0.75));  // nor under the point
        if (free > room) { room = free; best = [px, py]; }
      }
      if (!best) return;
      taken.push(best);
      made.words.push({ words, at: best });
      this.font(c, w < 260 ? 10 : 11.5, ink);
      c.textAlign = "center";
      c.textBaseline = "middle";
      c.strokeStyle = paper;
      c.lineWidth = 2.5;
      c.globalAlpha = 0.45;
      c.strokeText(words, ...best);
      c.globalAlpha = 1;
      c.fillText(words, ...best);
    });
    c.textAlign = "start";
  }

  axes(made, c) {
    const { data, w, h } = this, { colours } = data;
    c.strokeStyle = colours.line;
    c.lineWidth = 1;
    c.strokeRect(0, 0, w, h);
    this.font(c, 11.5, colours.muted);
    if (made.foot) {
      c.textBaseline = "top";
      const fits = data.u.ticks.filter((_, n) => w >= 46 * data.u.ticks.length || n % Math.ceil(46 * data.u.ticks.length / w) === 0);
      for (const [value, words] of fits) {
        c.textAlign = "center";
        c.beginPath();
        c.moveTo(made.x(value), h);
        c.lineTo(made.x(value), h + 4);
        c.stroke();
        c.fillText(words, made.x(value), h + 6);
      }
      c.textAlign = "center";
      c.fillText(`${data.u.letter}, ${data.unit}`, w / 2, h + 22);
    }
    if (made.first) {
      c.textBaseline = "middle";
      c.textAlign = "right";
      const fits = data.v.ticks.filter((_, n) => h >= 18 * data.v.ticks.length || n % Math.ceil(18 * data.v.ticks.length / h) === 0);
      for (const [value, words] of fits) {
        c.beginPath();
        c.moveTo(-4, made.y(value));
        c.lineTo(0, made.y(value));
        c.stroke();
        c.fillText(words, -6, Math.max(made.y(value), 6));
      }
      c.save();
      c.translate(-LEFT + 2, h / 2);
      c.rotate(-Math.PI / 2);
      c.textAlign = "center";
      c.textBaseline = "top";
      c.fillText(`${data.v.letter}, ${data.unit}`, 0, 0);
      c.restore();
    }
    c.textAlign = "start";
  }

  move(n, value) {
    const { w } = this.data;
    let k = 0;
    w.at.forEach((at, m) => { if (Math.abs(at - value) < Math.abs(w.at[k] - value)) k = m; });
    this.at[n] = k;
    this.draw();
    this.set(this.inputs[n], n);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.settle(), SETTLED_MS);
  }

  settle() {
    if (!this.timer) return;
    this.forget();
    if (JSON.stringify(this.at) === this.told) return;
    this.sent = [...this.at];
    this.send("plane", { at: this.sent, rev: this.data.rev, seq: ++this.seq });
  }

  cellUnder(made, event) {
    const box = made.canvas.getBoundingClientRect(), { u, v } = this.data;
    const i = Math.floor((event.clientX - box.left - made.left) / this.w * u.at.length);
    const j = Math.floor((1 - (event.clientY - box.top) / this.h) * v.at.length);
    return i >= 0 && j >= 0 && i < u.at.length && j < v.at.length ? [i, j] : null;
  }

  point(made, cell) {
    if (String(made.over ?? "") === String(cell ?? "")) return;
    made.over = cell;
    this.drawPanel(made);
    const tip = this.part("tip");
    tip.style.visibility = cell ? "visible" : "hidden";
    if (!cell) return;
    const { data } = this, { panel, figure } = made, [i, j] = cell, k = this.at[panel.slider];
    const value = worded(data, panel, valueAt(data, panel, this.codes[panel.codes], i, j, k));
    tip.replaceChildren();
    const head = make("b");
    titled(head, panel.title, panel.sub);
    tip.append(head, ` ${value}\n${placed(data, i, j, k)}`);
    const x = figure.offsetLeft + made.left + (i + 1) * this.w / data.u.at.length + 10;
    const y = this.part("board").offsetTop + figure.offsetTop + CAPTION + this.h - (j + 1) * this.h / data.v.at.length;
    tip.style.left = `${Math.max(0, Math.min(x, this.root.clientWidth - tip.offsetWidth - 4))}px`;
    tip.style.top = `${Math.max(0, Math.min(y - tip.offsetHeight - 4, this.root.clientHeight - tip.offsetHeight))}px`;
  }

  pick(made, cell) {
    if (!cell) return;
    this.forget();  // the point brings its plane along
    this.sent = [...this.at];
    this.send("cell", { cell: [...cell, this.at[made.panel.slider]], at: this.sent, rev: this.data.rev, seq: ++this.seq });
  }

  steer(made, event) {
    const { u, v } = this.data, step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const [i, j] = made.over ?? [Math.floor(u.at.length / 2), Math.floor(v.at.length / 2)];
    if (step) {
      const to = made.over ? [i + step[0], j + step[1]] : [i, j];
      this.point(made, [Math.min(Math.max(to[0], 0), u.at.length - 1), Math.min(Math.max(to[1], 0), v.at.length - 1)]);
    } else if (event.key === "Enter" && made.over) this.pick(made, made.over);
    else return;
    event.preventDefault();
  }

  save() {
    const board = this.part("board"), whole = make("canvas"), c = this.sized(whole, board.clientWidth, board.clientHeight);
    c.fillStyle = this.data.colours.background;
    c.fillRect(0, 0, board.clientWidth, board.clientHeight);
    const put = (canvas, x, y) => c.drawImage(canvas, x, y, canvas.width / (window.devicePixelRatio || 1), canvas.height / (window.devicePixelRatio || 1));
    for (const { figure, canvas, panel, note, left } of this.shown) {
      this.font(c, 12.5, this.data.colours.text);
      c.fillText(`${panel.title}  ${note.textContent}`, figure.offsetLeft + left, figure.offsetTop + 14, this.pitch);
      put(canvas, figure.offsetLeft, figure.offsetTop + CAPTION);
    }
    for (const { canvas } of this.bars) put(canvas, canvas.offsetLeft, canvas.offsetTop);
    const { w, file } = this.data, link = make("a");
    link.download = `robomill-${file}-${w.letter}${this.at.map((k) => w.drawn[k]).join("-")}.png`;
    link.href = whole.toDataURL("image/png");
    link.click();
  }

  end() {
    this.settle();
    this.watch.disconnect();
    removeEventListener("robomill-codes", this.wait);
  }
}

export default function ({ data, parentElement, setStateValue }) {
  const root = parentElement.querySelector(".maps");
  root.board ??= new Board(root);
  root.board.show(data, setStateValue);
  // Called before the page shows it anew, too: what is drawn stays, and the board ends with its element.
  return () => setTimeout(() => { if (!root.isConnected) root.board.end(); });
}
