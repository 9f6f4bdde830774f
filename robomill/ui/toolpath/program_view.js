// A program with line numbers and what was found on each line. A click (or the arrow keys) points at a line.
const SIGNS = { error: "✕", warning: "▲", suspicious: "?", ignored: "–", info: "i" };
const COMMENT = /(\([^)]*\)|;.*$)/;
const grouped = (n) => (n < 10000 ? `${n}` : `${n}`.replace(/\B(?=(\d{3})+$)/g, "\u202f"));

function build(root, data, choose) {
  const { lines, first, total, marks, selected } = data;
  const rows = document.createElement("div");
  rows.className = "rows";
  const width = `${String(first + lines.length).length + 0.5}ch`;
  const cutoff = (text) => { const d = document.createElement("div"); d.className = "cutoff"; d.textContent = text; rows.appendChild(d); };
  if (first > 1) cutoff(`Lines 1 to ${grouped(first - 1)} are not shown here.`);
  lines.forEach((text, i) => {
    const number = first + i, row = document.createElement("div"), found = marks[number];
    row.className = number === selected ? "row on" : "row";
    row.id = `l${number}`;
    row.dataset.line = number;
    row.setAttribute("role", "option");
    row.setAttribute("aria-selected", String(number === selected));
    const cell = (name, content) => { const s = document.createElement("span"); s.className = name; s.textContent = content; row.appendChild(s); return s; };
    cell("no", String(number)).style.minWidth = width;
    const mark = cell("mark", found ? SIGNS[found.level] : "");
    const code = cell("text", "");
    text.split(COMMENT).forEach((part, k) => {
      if (!part) return;
      const s = document.createElement("span");
      s.textContent = part;
      if (k % 2) s.className = "c";
      code.appendChild(s);
    });
    if (found) {
      row.style.setProperty("--tone", data.tones[found.level]);
      row.title = found.words;
      cell("said", found.words);
    }
    rows.appendChild(row);
  });
  const last = first + lines.length - 1;
  if (last < total) cutoff(`${grouped(total - last)} more lines are not shown here.`);
  root.replaceChildren(rows);
}

export default function ({ data, parentElement, setStateValue }) {
  const root = parentElement.querySelector(".code");
  const kept = (root.kept ??= { seq: 0, rev: "", line: 0 });
  root.style.height = `${data.height}px`;
  const choose = (line) => {
    if (line < 1 || line > data.total) return;
    kept.line = line;
    for (const row of root.querySelectorAll(".row")) {
      const on = Number(row.dataset.line) === line;
      row.classList.toggle("on", on);
      row.setAttribute("aria-selected", String(on));
    }
    kept.seq += 1;
    setStateValue("line", { line, seq: kept.seq });
  };
  if (kept.rev !== data.rev) {
    const top = root.scrollTop;
    build(root, data, choose);
    kept.rev = data.rev;
    root.scrollTop = top;
  }
  if (kept.line !== data.selected || kept.fresh === undefined) {
    kept.line = data.selected;
    for (const row of root.querySelectorAll(".row")) row.classList.toggle("on", Number(row.dataset.line) === data.selected);
    const row = root.querySelector(`#l${data.selected}`);
    if (row) root.scrollTop = row.offsetTop - root.clientHeight / 2 + 12;
  }
  kept.fresh = false;
  root.onclick = (event) => {
    // Text that is being marked for copying is no click.
    const row = event.target.closest(".row"), marked = root.getRootNode().getSelection ? String(root.getRootNode().getSelection()) : "";
    if (row && !marked) choose(Number(row.dataset.line));
  };
  root.onkeydown = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 12, PageUp: -12 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    choose(Math.min(Math.max((kept.line || data.first) + step, 1), data.total));
    const row = root.querySelector(`#l${kept.line}`);
    if (row) row.scrollIntoView({ block: "nearest" });
  };
}
