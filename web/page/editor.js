// The editor of the layout: a text with colors behind it, and faults at their lines.

const editor = document.getElementById("editor");
const highlight = document.getElementById("highlight");
const gutter = document.getElementById("gutter");
const list = document.getElementById("faults");

const TOKEN = /(\/\/[^\n]*|\/\*[^]*?\*\/)|("(?:\\.|[^"\\])*"?)|(-?\b\d[\d_.]*(?:e-?\d+)?\b)|([A-Za-z_]\w*(?=\s*[:(]))/g;
const CLASSES = ["comment", "string", "number", "word"];

let faults = [];
let undone = [];
/** The text that was set last: what differs from it was written by hand. */
let last = "";

/** Returns the text. */
export const text = () => editor.value;

/** Replaces the text, keeps what can be kept of the cursor and the view, and remembers the text before for Undo. */
export function setText(value) {
  last = value;
  if (value === editor.value) return;
  // The page begins without a text.
  if (editor.value) undone.push(editor.value);
  undone = undone.slice(-100);
  const { selectionStart, scrollTop, scrollLeft } = editor;
  editor.value = value;
  // It has the line ends of the field, not of a file.
  last = editor.value;
  editor.selectionStart = editor.selectionEnd = Math.min(selectionStart, value.length);
  [editor.scrollTop, editor.scrollLeft] = [scrollTop, scrollLeft];
  draw();
}

/** Calls a function with the text after each change by hand. */
export function onEdit(changed) {
  editor.addEventListener("input", () => {
    draw();
    changed(editor.value);
  });
  document.getElementById("undo").addEventListener("click", () => {
    const before = editor.value === last ? undone.pop() : last;
    if (before === undefined) return;
    editor.value = last = before;
    draw();
    changed(editor.value);
  });
}

/** Shows faults: `line` and `column` from 1 or null, `width` in characters. */
export function setFaults(newFaults) {
  const isSame = JSON.stringify(newFaults) === JSON.stringify(faults);
  faults = newFaults;
  // A screen reader would read the same faults again after each letter.
  if (!isSame) list.replaceChildren(...faults.map(itemOf));
  editor.setAttribute("aria-invalid", String(faults.length > 0));
  draw();
}

function itemOf(fault) {
  const item = document.createElement("li");
  if (fault.line) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = `line ${fault.line}, column ${fault.column}`;
    button.addEventListener("click", () => select(fault));
    item.append(button);
  }
  item.append(fault.message);
  return item;
}

/** Returns the index in the text of a line and a column in characters, not in UTF-16 units. */
function offsetOf(line, column) {
  const lines = editor.value.split("\n");
  const before = lines.slice(0, line - 1).reduce((sum, it) => sum + it.length + 1, 0);
  return before + [...(lines[line - 1] ?? "")].slice(0, column - 1).join("").length;
}

function select(fault) {
  const start = offsetOf(fault.line, fault.column);
  editor.focus();
  editor.setSelectionRange(start, offsetOf(fault.line, fault.column + fault.width));
  editor.scrollTop = Math.max(0, (fault.line - 4) * lineHeight());
}

const lineHeight = () => parseFloat(getComputedStyle(editor).lineHeight);

function draw() {
  const value = editor.value;
  const marks = faults.filter((it) => it.line).map((it) => [offsetOf(it.line, it.column), offsetOf(it.line, it.column + it.width)]);
  const parts = document.createDocumentFragment();
  let at = 0;
  const add = (end, name) => {
    // A fault may begin or end inside a word.
    while (at < end) {
      const inside = marks.find(([from, to]) => from <= at && at < to);
      const next = inside ? inside[1] : Math.min(...marks.map(([from]) => from).filter((from) => from > at), end);
      const stop = Math.min(next, end);
      const piece = value.slice(at, stop);
      const classes = [name, inside && "fault"].filter(Boolean).join(" ");
      if (classes) {
        const span = document.createElement("span");
        span.className = classes;
        span.textContent = piece;
        parts.append(span);
      } else {
        parts.append(piece);
      }
      at = stop;
    }
  };
  for (const match of value.matchAll(TOKEN)) {
    add(match.index, "");
    add(match.index + match[0].length, CLASSES[match.slice(1).findIndex((it) => it !== undefined)]);
  }
  add(value.length, "");
  parts.append("\n");
  highlight.replaceChildren(parts);
  drawGutter(value.split("\n").length);
  scroll();
}

function drawGutter(count) {
  const wrong = new Set(faults.map((it) => it.line));
  const parts = [];
  let plain = "";
  for (let line = 1; line <= count; line += 1) {
    if (wrong.has(line)) {
      const mark = document.createElement("span");
      mark.className = "is-wrong";
      mark.textContent = line;
      parts.push(plain, mark);
      plain = "\n";
    } else {
      plain += `${line}\n`;
    }
  }
  gutter.replaceChildren(...parts, plain, "\n\n\n");
}

function scroll() {
  highlight.scrollTop = gutter.scrollTop = editor.scrollTop;
  highlight.scrollLeft = editor.scrollLeft;
}

editor.addEventListener("scroll", scroll);
