// A prediction that is drawn: where the tip goes, as an arrow from it. Dragged, or turned by the arrow keys; what it is
// in the end goes to Python, which hands back the arrow in force and, once it is revealed, the one of the model.

const svgns = "http://www.w3.org/2000/svg";
const WIDE = 360, HIGH = 300, X = WIDE / 2, Y = HIGH / 2, LONG = 110, NEAR = 14;
const TURN = 5, LEAP = 15; // degrees a key turns it by

function node(tag, attributes, parent, text) {
  const made = document.createElementNS(svgns, tag);
  for (const [k, v] of Object.entries(attributes)) made.setAttribute(k, v);
  if (text !== undefined) made.textContent = text;
  parent.appendChild(made);
  return made;
}

function arrow(parent, degrees, look, words) {
  const a = (degrees * Math.PI) / 180, c = Math.cos(a), s = Math.sin(a);
  const [x, y] = [X + LONG * c, Y - LONG * s];
  const g = node("g", { class: look }, parent);
  node("line", { x1: X, y1: Y, x2: x - 10 * c, y2: y + 10 * s }, g);
  const head = [[x, y], [x - 18 * c - 9 * s, y + 18 * s - 9 * c], [x - 18 * c + 9 * s, y + 18 * s + 9 * c]];
  node("polygon", { points: head.map((p) => p.join(",")).join(" ") }, g);
  // Beside an axis, not on it: its dashes would run through the words.
  const [aside, over] = [Math.abs(c) < 0.15 ? 12 : 0, Math.abs(s) < 0.15 ? 13 : 0];
  const at = { x: X + (LONG + 20) * c + aside, y: Y - (LONG + 20) * s + 5 - over };
  node("text", { ...at, "text-anchor": aside ? "start" : "middle" }, g, words);
}

export default function (component) {
  const { data, parentElement, setStateValue } = component;
  const board = parentElement.querySelector("svg");
  if (board.rev !== data.rev) [board.rev, board.at] = [data.rev, data.drawn];

  const say = () => {
    const at = board.at;
    return at === null || at === undefined ? "nothing is drawn yet" : `${Math.round(at)} degrees from ${data.right}, up is ${data.up}`;
  };
  const draw = () => {
    board.replaceChildren();
    board.setAttribute("aria-valuetext", say());
    board.setAttribute("aria-valuenow", String(Math.round(board.at ?? 0)));
    node("line", { class: "axis", x1: 24, y1: Y, x2: WIDE - 24, y2: Y }, board);
    node("line", { class: "axis", x1: X, y1: 20, x2: X, y2: HIGH - 20 }, board);
    node("text", { class: "axis", x: WIDE - 26, y: Y + 22, "text-anchor": "end" }, board, data.right);
    node("text", { class: "axis", x: X + 8, y: 26 }, board, data.up);
    arrow(board, data.push, "push", data.force);
    if (data.truth !== null) arrow(board, data.truth, "truth", "model");
    if (board.at !== null && board.at !== undefined) arrow(board, board.at, "drawn", "you");
    node("circle", { class: "tip", cx: X, cy: Y, r: 6 }, board);
  };
  const send = () => setStateValue("arrow", { degrees: board.at, rev: data.rev });
  const point = (event) => {
    const box = board.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * WIDE - X;
    const y = Y - ((event.clientY - box.top) / box.height) * HIGH;
    if (Math.hypot(x, y) > NEAR) board.at = Math.round((Math.atan2(y, x) * 180) / Math.PI);
    draw();
  };
  board.onpointerdown = (event) => { board.setPointerCapture(event.pointerId); board.held = true; point(event); };
  board.onpointermove = (event) => { if (board.held) point(event); };
  board.onpointerup = () => { if (board.held) { board.held = false; send(); } };
  board.onpointercancel = () => { board.held = false; };
  board.onkeydown = (event) => {
    const way = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1 }[event.key];
    if (!way) return;
    event.preventDefault();
    const step = way * (event.shiftKey ? LEAP : TURN);
    const next = board.at === null || board.at === undefined ? data.push : board.at + step;
    board.at = ((((next + 180) % 360) + 360) % 360) - 180;
    draw();
    clearTimeout(board.waits);
    board.waits = setTimeout(send, 400);
  };
  draw();
  return () => clearTimeout(board.waits);
}
