// One look at the cut: what is chosen here is drawn here, 20 pictures a second while it plays; only what has settled is
// told to the server. The element says what is drawn, after it is drawn: data-drawn="station=0.500 x10 iso part",
// with "so-far" while material stands that is not cut yet.
const EACH_MS = 50, SETTLED_MS = 250, AGAIN_MS = 1500, WHOLE_CUT_MS = 9000, KEYS_STEP = 5;
const parcels = (globalThis.robomillParcels ??= new Map());
const html = (root, name) => root.querySelector(`.${name}`);

class Look {
  constructor(root) {
    this.root = root;
    this.turn = { around: 0, over: 0, zoom: 1, shift: [0, 0] };
    for (const name of ["stage", "picture", "curve", "station", "where", "code", "said", "play", "back", "next", "worst"]) {
      this[name] = html(root, name);
    }
    try {
      this.scene = new Scene(this.picture);
    } catch (error) {
      this.without = error.message;
    }
    this.listen();
  }

  // What the page says: words, colours, which cut, and what is looked at where somebody else has chosen it.
  take(data, tell) {
    Object.assign(this, { data, tell });
    const said = JSON.stringify(data.state);
    if (this.seq === undefined) this.seq = data.seq;
    if (data.seq >= this.seq && said !== this.told) {
      this.state = { ...data.state };
      this.told = said;
      this.playing = 0;
    }
    this.root.classList.toggle("old", data.old);
    this.write();
    if (this.without) return this.instead();
    this.ask(data.digest);
  }

  ask(digest) {
    if (this.digest === digest) return this.soon();
    const sent = parcels.get(digest);
    if (!sent) return;
    this.digest = digest;
    sent.then((cut) => {
      if (this.digest !== digest) return;
      this.cut = cut;
      this.scene.show(cut);
      this.soon();
    });
  }

  instead() {
    const told = html(this.root, "instead");
    told.hidden = false;
    told.textContent = this.data.words.without;
    this.root.dataset.drawn = "none";
    if (this.said_without) return;
    this.said_without = true;
    this.say({ webgl: false });
  }

  // Tell the server what is looked at, and again until it has it: what comes while a page is being made is lost.
  say(more = {}) {
    clearTimeout(this.again);
    const said = { ...this.state, ...more, seq: (this.seq += 1) };
    const tell = (wait) => {
      this.tell("look", said);
      this.again = setTimeout(() => this.root.isConnected && this.data.seq < said.seq && tell(2 * wait), wait);
    };
    tell(AGAIN_MS);
  }

  write() {
    const { words, views, cameras, exaggerations, shows, key } = this.data, { root, state } = this;
    const made = JSON.stringify([words, views, cameras, exaggerations, shows, key]);
    if (made !== this.written) {
      this.written = made;
      html(root, "views").replaceChildren(...views.map(([code, label]) => {
        const button = Object.assign(document.createElement("button"), { type: "button", textContent: label });
        button.setAttribute("role", "radio");
        button.dataset.code = code;
        button.onclick = () => this.change({ view: code });
        return button;
      }));
      const fill = (name, options) => html(root, name).replaceChildren(...options.map(([value, label]) => new Option(label, value)));
      fill("camera", cameras);
      fill("times", exaggerations);
      html(root, "menu").replaceChildren(...shows.map(([code, label]) => {
        const box = Object.assign(document.createElement("input"), { type: "checkbox", value: code });
        box.onchange = () => this.change({ show: shows.map(([c]) => c).filter((c) => (c === code ? box.checked : this.state.show.includes(c))) });
        const line = document.createElement("label");
        line.append(box, label);
        return line;
      }));
      for (const name of ["back", "next", "worst"]) this[name].textContent = words[name];
      html(root, "name").textContent = words.name;
      this.back.title = words.back_help;
      this.next.title = words.next_help;
      this.station.setAttribute("aria-label", words.station);
      const [first, last] = root.querySelectorAll(".key b");
      [first.textContent, last.textContent] = [words.left, words.deep];
      html(root, "most").textContent = key.most;
      html(root, "least").textContent = key.least;
      html(root, "key").querySelector("i").style.background = `linear-gradient(to top, ${this.data.colours.stops.join(", ")})`;
    }
    for (const button of html(root, "views").children) button.setAttribute("aria-checked", String(button.dataset.code === state.view));
    for (const box of html(root, "menu").querySelectorAll("input")) box.checked = state.show.includes(box.value);
    html(root, "camera").value = state.camera;
    html(root, "times").value = String(state.times);
    this.play.textContent = this.playing ? words.pause : words.play;
  }

  listen() {
    const { root, station, picture } = this;
    const pick = (name, change) => html(root, name).addEventListener("change", (event) => change(event.target.value));
    pick("camera", (camera) => {
      this.turn = { around: 0, over: 0, zoom: 1, shift: [0, 0] };
      this.change({ camera });
    });
    pick("times", (times) => this.change({ times: Number(times) }));
    station.addEventListener("input", () => this.change({ station: station.value / 1000 }));
    station.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      const at = Math.round(this.state.station * 1000) + step * (event.shiftKey ? 1 : KEYS_STEP);
      this.change({ station: Math.min(Math.max(at, 0), 1000) / 1000 });
    });
    this.play.addEventListener("click", () => (this.playing ? this.stop() : this.start()));
    this.back.addEventListener("click", () => this.toLine(-1));
    this.next.addEventListener("click", () => this.toLine(1));
    this.worst.addEventListener("click", () => this.cut && this.goTo(this.cut.about.worst));
    this.curve.addEventListener("click", (event) => {
      const box = this.curve.getBoundingClientRect();
      this.change({ station: Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1) });
    });
    root.addEventListener("focusout", (event) => {
      const menu = html(root, "show");
      if (menu.open && !menu.contains(event.relatedTarget)) menu.open = false;
    });
    picture.addEventListener("pointerdown", (event) => {
      if (this.cut) picture.setPointerCapture(event.pointerId);
      this.held = this.cut ? [event.clientX, event.clientY, event.button === 2 || event.shiftKey] : null;
    });
    picture.addEventListener("pointermove", (event) => {
      if (!this.held || !this.cut) return;
      const [x, y, aside] = this.held, dx = event.clientX - x, dy = event.clientY - y, { turn } = this;
      if (aside) turn.shift = [turn.shift[0] + (2 * dx) / picture.clientWidth, turn.shift[1] - (2 * dy) / picture.clientHeight];
      else Object.assign(turn, { around: turn.around - dx * 0.008, over: turn.over + dy * 0.008 });
      this.held = [event.clientX, event.clientY, aside];
      this.soon(true);
    });
    for (const name of ["pointerup", "pointercancel"]) picture.addEventListener(name, () => { this.held = null; });
    picture.addEventListener("contextmenu", (event) => event.preventDefault());
    picture.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !this.root.matches(":focus-within")) return; // the page scrolls
      event.preventDefault();
      this.turn.zoom = Math.min(Math.max(this.turn.zoom * Math.exp(-event.deltaY * 0.0015), 0.4), 30);
      this.soon(true);
    }, { passive: false });
    picture.addEventListener("dblclick", () => {
      this.turn = { around: 0, over: 0, zoom: 1, shift: [0, 0] };
      this.soon(true);
    });
    this.watch = new ResizeObserver(() => this.soon());
    this.watch.observe(this.stage);
  }

  change(what) {
    if (!("station" in what && what.by === "play")) this.playing = "station" in what ? 0 : this.playing;
    delete what.by;
    Object.assign(this.state, what);
    this.write();
    this.soon(true);
    this.settle();
  }

  settle() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (this.playing) return;
      this.soon();
      const said = JSON.stringify(this.state);
      if (said === this.told) return;
      this.told = said;
      this.say();
    }, SETTLED_MS);
  }

  start() {
    if (!this.cut) return;
    if (this.state.station >= 0.9995) this.state.station = 0;
    if (!this.state.show.includes("so_far")) this.state.show = this.data.shows.map(([code]) => code).filter((code) => code === "so_far" || this.state.show.includes(code));
    this.playing = 1;
    this.from = [performance.now(), this.state.station];
    this.last = 0;
    this.write();
    requestAnimationFrame(() => this.step());
  }

  step() {
    if (!this.playing || !this.root.isConnected) return;
    const now = performance.now(), [then, from] = this.from;
    if (now - this.last >= EACH_MS - 4) {
      this.last = now;
      this.state.station = Math.min(from + (now - then) / WHOLE_CUT_MS, 1);
      this.draw(true);
      if (this.state.station >= 1) return this.stop();
    }
    requestAnimationFrame(() => this.step());
  }

  stop() {
    this.playing = 0;
    this.write();
    this.settle();
  }

  goTo(frame) {
    if (frame >= 0) this.change({ station: Math.min(this.cut.arrays.s[frame] / (this.cut.about.total || 1), 1) });
  }

  // To the middle of the line that cuts before, or after, the one at the station.
  toLine(step) {
    if (!this.cut) return;
    const { line, s } = this.cut.arrays, now = this.frame(), goal = line[now] + step;
    const found = [];
    for (let f = 1; f < line.length; f++) if (line[f] === goal && s[f] > s[f - 1]) found.push(f);
    if (found.length) this.goTo(found[found.length >> 1]);
  }

  // The frame that the words are about: of the move that is being made.
  frame() {
    const near = this.cut.nearest(this.state.station), place = this.cut.at(this.state.station);
    const here = place.part > 0 ? place.frame + 1 : place.frame;
    return near >= 0 && this.cut.arrays.state[here] & JUDGED ? near : here;
  }

  soon(moving = false) {
    this.moving = moving;
    if (this.waits || !this.cut) return;
    this.waits = true;
    requestAnimationFrame(() => {
      this.waits = false;
      this.draw(this.moving);
    });
  }

  draw(moving) {
    const { cut, scene, state, stage, data } = this;
    if (!cut || !stage.clientWidth || !state) return;
    const sharp = Math.min(globalThis.devicePixelRatio || 1, 2);
    const place = cut.at(state.station);
    drawn(scene, { cut, state, place, turn: this.turn, moving, colours: data.colours,
      size: [Math.round(stage.clientWidth * sharp), Math.round(stage.clientHeight * sharp)] });
    this.words(place);
    curve(this.curve, cut, state.station, data, sharp);
    scene.done();
    this.root.dataset.drawn = `station=${state.station.toFixed(3)} x${+state.times} ${this.turned() ? "turned" : state.camera} ${state.view}${state.show.includes("so_far") ? " so-far" : ""}`;
  }

  turned() {
    const { around, over, zoom, shift } = this.turn;
    return around !== 0 || over !== 0 || zoom !== 1 || shift[0] !== 0 || shift[1] !== 0;
  }

  words(place) {
    const { cut, data, state, station } = this, { words, factor, digits } = data, f = this.frame(), { arrays, about } = cut;
    const lines = about.lines, n = arrays.line[f], length = (v, d) => (v * factor).toFixed(d).replace(/^\d{5,}/, (whole) => whole.replace(/\B(?=(\d{3})+$)/g, "\u202f"));
    const reached = arrays.state[f] & REACHED, known = Number.isFinite(arrays.size[f]);
    const at = `${length(state.station * about.total, digits[0])} ${words.of} ${length(about.total, digits[0])} ${data.unit}`;
    const off = !reached ? words.unreached : !known ? words.unjudged : `${words.tip} ${length(arrays.size[f], digits[1])} ${data.unit}`;
    const force = reached && Number.isFinite(arrays.force[f]) ? ` · ${arrays.force[f].toFixed(0)} N` : "";
    const told = `${at} · ${words.line} ${lines.number[n]} · ${off}${force}`;
    this.where.textContent = told;
    this.code.textContent = lines.text[n];
    station.value = Math.round(state.station * 1000);
    station.setAttribute("aria-valuetext", told);
    this.picture.setAttribute("aria-label", `${words.alt} ${told}`);
    const shown = (times) => (times === 1 ? words.true : `${words.shown} × ${+times}`);
    const arm = state.view === "arm" && about.arm;
    this.said.textContent = arm ? `${words.arm} × ${about.arm.times}; ${words.part}: × ${+state.times}. ${words.unloaded}` : `${shown(state.times)}. ${words.thin}`;
    this.back.disabled = n <= 0;
    this.next.disabled = n >= lines.number.length - 1;
    this.worst.disabled = about.worst < 0;
  }

  end() {
    clearTimeout(this.timer);
    clearTimeout(this.again);
    this.playing = 0;
    this.watch.disconnect();
    this.scene?.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

export default function ({ data, parentElement, setStateValue }) {
  const root = parentElement.querySelector(".live");
  if (data.parcel && !parcels.has(data.digest)) {
    for (const old of [...parcels.keys()].slice(0, -3)) parcels.delete(old);
    parcels.set(data.digest, unpacked(data.parcel));
    globalThis.dispatchEvent(new Event("robomill-parcel"));
  }
  if (!root) return;
  root.look ??= new Look(root);
  const { look } = root;
  const again = () => look.data && !look.without && look.ask(look.data.digest);
  globalThis.addEventListener("robomill-parcel", again);
  look.take(data, setStateValue);
  return () => {
    globalThis.removeEventListener("robomill-parcel", again);
    if (!root.isConnected) look.end();
  };
}
