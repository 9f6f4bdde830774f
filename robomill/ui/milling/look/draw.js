// What is put into the scene for a look: the part, what stands about it, and the curve under the picture.
function drawn(scene, { cut, state, place, turn, moving, colours: hex, size }) {
  const colours = Object.fromEntries(Object.entries(hex).map(([name, value]) => [name, Array.isArray(value) ? value.map(rgb) : rgb(value)]));
  const material = cut.material(state.times), level = cut.about.times.indexOf(state.times);
  const tool = cut.tool(place, state.times), parts = cut.about.tools[cut.arrays.tool[place.frame]];
  const show = new Set(state.show), pair = state.view === "pair", arm = state.view === "arm" && cut.about.arm;
  const plane = sectionPlane(cut, place, tool);
  scene.begin(...size, colours.background);
  const camera = posed(cut, state, turn, { parts: show.has("tool") ? parts : null, arm });
  // What lies before the section is taken away.
  const open = show.has("away") && !arm ? [...plane.way.map((v) => -v), -dot(plane.way, plane.at)] : null;
  if (pair) {
    scene.look(camera, 0, 0.5);
    scene.load(`ideal`, cut.ideal, null);
    scene.drawField({ colours, moving, plain: true });
    scene.draw(scene.outline, colours.line, { lines: true });
    scene.look(camera, 0.5, 0.5);
  } else {
    scene.look(camera, 0, 1);
  }
  const upto = show.has("so_far") ? place.frame : cut.about.frames - 1;
  material.seek(upto);
  scene.load(`${level} ${upto}`, material.z, material);
  scene.drawField({ colours, moving, open });
  if (open) scene.draw(cap(cut, plane, material), colours.cut, { flat: true });
  if (!open) scene.draw(scene.outline, colours.line, { lines: true });
  waysNotCut(scene, cut, colours, show.has("path"));
  if (arm) {
    drawArm(scene, cut, place, colours);
    return;
  }
  if (show.has("tool") && cut.arrays.state[place.frame] & REACHED) {
    const shape = frameOf(tool.axis);
    parts.forEach((part, n) => scene.draw(`${cut.arrays.tool[place.frame]}.${n}`, colours[part.role], { at: tool.tip, shape }));
  }
  if (show.has("ghost") && !pair) {
    scene.load("ideal", cut.ideal, null);
    scene.drawField({ colours, moving, alpha: 0.34, plain: true });
  }
  if (show.has("plane") && !open) {
    scene.draw(plane.faces, colours.plane, { alpha: 0.22, flat: true });
    scene.draw(plane.rim, colours.plane, { lines: true });
  }
}

// From where, and what must be seen: a preset, turned by hand.
function posed(cut, state, turn, { parts, arm }) {
  const [preset, up] = cut.about.cameras[state.camera];
  const [low, high] = [[...cut.low], [...cut.high]], points = [];
  let eye = preset;
  if (arm) {
    const o = cut.arrays["arm.o"];
    for (let c = 0; c < 3 * (arm.joints + 1); c += 3) points.push([o[c], o[c + 1], o[c + 2]]);
  } else if (parts) {
    high[2] += Math.min(0.6 * Math.max(...parts[1].height), 0.16 * Math.hypot(high[0] - low[0], high[1] - low[1]));
  }
  for (const x of [low[0], high[0]]) for (const y of [low[1], high[1]]) for (const z of [low[2], high[2]]) points.push([x, y, z]);
  let around = Math.atan2(eye[1], eye[0]), over = Math.asin(Math.min(Math.max(eye[2], -1), 1));
  let top = up;
  if (turn.around || turn.over) {
    if (Math.abs(eye[2]) > 0.999) around = Math.atan2(-up[1], -up[0]);
    around += turn.around;
    over = Math.min(Math.max(over + turn.over, -1.2), 1.56);
    eye = [Math.cos(over) * Math.cos(around), Math.cos(over) * Math.sin(around), Math.sin(over)];
    top = [0, 0, 1];
  }
  return { eye, up: top, points, more: arm ? 0.06 * arm.size : 0, zoom: turn.zoom, shift: turn.shift };
}

// The plane across the way of the cut at the station, as wide as the part there.
function sectionPlane(cut, place, tool) {
  const way = cut.way(place), across = [-way[1], way[0], 0], at = [tool.tip[0], tool.tip[1], 0];
  let from = -Infinity, to = Infinity;
  for (const i of [0, 1]) if (Math.abs(across[i]) > 1e-9) {
    const ends = [(cut.low[i] - at[i]) / across[i], (cut.high[i] - at[i]) / across[i]].sort((a, b) => a - b);
    from = Math.max(from, ends[0]);
    to = Math.min(to, ends[1]);
  }
  if (from > to) [from, to] = [-1, 1];
  const more = 0.06 * (to - from), tall = 0.35 * (cut.high[2] - cut.low[2]);
  const [bottom, top] = [cut.low[2] - tall, cut.high[2] + tall];
  const corner = (t, z) => [at[0] + t * across[0], at[1] + t * across[1], z];
  const [a, b, c, d] = [corner(from - more, bottom), corner(to + more, bottom), corner(to + more, top), corner(from - more, top)];
  return { way, across, at, from, to, faces: [a, b, c, a, c, d].flat(), rim: [a, b, b, c, c, d, d, a].flat() };
}

// What the section plane lays open: from the bottom up to the height at every place across.
function cap(cut, { at, across, from, to }, { z }) {
  const points = [], steps = 240, { bottom } = cut.about;
  const height = (t) => {
    const i = Math.round((at[0] + t * across[0] - cut.x0) / cut.dx), j = Math.round((at[1] + t * across[1] - cut.y0) / cut.dy);
    return z[Math.min(Math.max(i, 0), cut.nx - 1) * cut.ny + Math.min(Math.max(j, 0), cut.ny - 1)];
  };
  for (let n = 0; n < steps; n++) {
    const t = from + ((to - from) * n) / steps, u = from + ((to - from) * (n + 1)) / steps;
    const [p, q] = [t, u].map((v) => [at[0] + v * across[0], at[1] + v * across[1]]), [h, g] = [height(t), height(u)];
    points.push(...p, bottom, ...q, bottom, ...p, h, ...q, bottom, ...q, g, ...p, h);
  }
  return points;
}

// Moves that are told but not cut: out of reach, without a number, or beside the stock; with `all` the whole path.
function waysNotCut(scene, cut, colours, all) {
  const { p, state, size } = cut.arrays;
  if (!cut.ways) {
    cut.ways = { lost: [], air: [], told: [] };
    for (let f = 1; f < state.length; f++) {
      if (!(state[f] & JOINED)) continue;
      const ends = [...p.slice(3 * f - 3, 3 * f + 3)];
      const lost = !(state[f] & REACHED) || !Number.isFinite(size[f]);
      cut.ways.told.push(...ends);
      if (lost) cut.ways.lost.push(...ends);
      else if (state[f] & OVER) cut.ways.air.push(...ends);
    }
    for (const name of Object.keys(cut.ways)) cut.ways[name] = new Float32Array(cut.ways[name]);
  }
  const { gl } = scene;
  gl.disable(gl.DEPTH_TEST);
  if (all) scene.draw(cut.ways.told, colours.path, { lines: true });
  else if (cut.ways.air.length) scene.draw(cut.ways.air, colours.path, { lines: true });
  for (const shift of cut.ways.lost.length ? [0, 1 / scene.scale] : []) scene.draw(cut.ways.lost, colours.lost, { at: [0, 0, shift], lines: true });
  gl.enable(gl.DEPTH_TEST);
}

// The arm as the load bends it, much enlarged, and where it stands without load.
function drawArm(scene, cut, place, colours) {
  const { joints, size, times } = cut.about.arm, chosen = cut.arrays["arm.at"], rows = 3 * (joints + 1);
  let b = chosen.findIndex((f) => f >= place.frame + place.part);
  if (b < 0) b = chosen.length - 1;
  const a = Math.max(b - 1, 0), t = b > a ? Math.min(Math.max((place.frame + place.part - chosen[a]) / (chosen[b] - chosen[a]), 0), 1) : 0;
  const of = (name, bend) => Array.from({ length: joints + 1 }, (_, n) => [0, 1, 2].map((i) => {
    const at = (row) => cut.arrays[`arm.${name}`][row * rows + 3 * n + i] + bend * cut.arrays[`arm.d${name}`][row * rows + 3 * n + i];
    return at(a) + t * (at(b) - at(a));
  }));
  const limbs = (bend, link, joint, alpha) => {
    const o = of("o", bend), k = of("a", bend).map(unit);
    for (let i = 0; i < joints; i++) {
      const radius = 0.034 * size * (1 - (0.45 * i) / Math.max(joints - 1, 1)), start = o[i];
      const end = i === joints - 1 ? add(o[i + 1], k[joints], 0.09 * size) : o[i + 1];
      const corner = add(start, k[i], dot(add(end, start, -1), k[i]));
      for (const [from, to] of [[start, corner], [corner, end]]) {
        if (Math.hypot(...add(to, from, -1)) > 0.2 * radius) scene.tube(from, to, 0.92 * radius, 0.78 * radius, link, alpha);
      }
      scene.tube(add(start, k[i], -1.5 * radius), add(start, k[i], 1.5 * radius), 1.32 * radius, 1.32 * radius, joint, alpha);
    }
    scene.tube(o[joints], add(o[joints], k[joints], 0.1 * size), 0.006 * size, 0.016 * size, joint, alpha);
  };
  limbs(times, colours.link, colours.joint, 1);
  limbs(0, colours.straight, colours.straight, 0.28);
}

// The tip's deviation along the cut: all of it faint, strong as far as it is cut, against the tolerance.
function curve(canvas, cut, station, { colours, words }, sharp) {
  const width = canvas.clientWidth, height = canvas.clientHeight, { s, size, state } = cut.arrays, { total, tolerance } = cut.about;
  if (!width) return;
  canvas.setAttribute("aria-label", words.curve);
  if (canvas.width !== Math.round(width * sharp)) Object.assign(canvas, { width: Math.round(width * sharp), height: Math.round(height * sharp) });
  const ink = canvas.getContext("2d");
  ink.setTransform(sharp, 0, 0, sharp, 0, 0);
  ink.clearRect(0, 0, width, height);
  cut.most ??= size.reduce((most, v) => (v > most ? v : most), 0);
  const top = Math.max(1.15 * tolerance, Math.min(1.1 * cut.most, 3 * tolerance));
  const x = (f) => (s[f] / (total || 1)) * (width - 2) + 1, y = (v) => height - 3 - (height - 8) * Math.min(v / top, 1);
  const every = Math.max(1, Math.floor(s.length / (2 * width)));
  const area = (upto) => {
    ink.beginPath();
    ink.moveTo(1, y(0));
    let last = 1;
    for (let f = 0; f < s.length && s[f] <= upto * total + 1e-6; f += every) {
      const known = Number.isFinite(size[f]) && state[f] & JUDGED;
      last = x(f);
      ink.lineTo(last, known ? y(size[f]) : y(0));
    }
    ink.lineTo(last, y(0));
    ink.closePath();
    ink.fill();
  };
  ink.fillStyle = colours.accent;
  ink.globalAlpha = 0.2;
  area(1);
  ink.globalAlpha = 0.75;
  area(station);
  ink.globalAlpha = 1;
  ink.fillStyle = colours.lost;
  for (let f = 1; f < s.length; f++) {
    if (state[f] & JOINED && (!(state[f] & REACHED) || !Number.isFinite(size[f]))) ink.fillRect(x(f - 1), y(0) - 3, Math.max(x(f) - x(f - 1), 1), 4);
  }
  ink.strokeStyle = colours.lost;
  ink.setLineDash([5, 4]);
  ink.beginPath();
  ink.moveTo(0, y(tolerance));
  ink.lineTo(width, y(tolerance));
  ink.stroke();
  ink.setLineDash([]);
  ink.strokeStyle = colours.line;
  ink.beginPath();
  ink.moveTo(station * (width - 2) + 1, 0);
  ink.lineTo(station * (width - 2) + 1, height);
  ink.stroke();
}
