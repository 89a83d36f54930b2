// The boards of the layout in the plane, in which keys are moved.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN_MM = 6;
const GAP_MM = 14;

const plan = document.getElementById("plan");
let keys = new Map();
let change = () => {};

/** Calls a function with ids of targets and an edit, when a person has made one. */
export function onChange(changed) {
  change = changed;
}

/** Draws boards, and keeps the focus. */
export function showPlan(boards) {
  const focused = document.activeElement?.dataset?.name;
  const at = [...keys.values()].indexOf(document.activeElement);
  keys = new Map();
  const svg = planPicture(boards, (group, face) => {
    keys.set(face.id, group);
    prepare(group, face);
  });
  plan.replaceChildren(svg);
  if (at < 0) return;
  // An edit may give a key another id. A key that is deleted leaves the focus to the one after it.
  const groups = [...keys.values()];
  const again = groups.find((group) => group.dataset.name === focused) ?? groups[Math.min(at, groups.length - 1)];
  again?.focus({ preventScroll: true });
}

/** Shows which targets are pressed. */
export function showPressed(pressed) {
  const ids = new Set(pressed);
  for (const [id, group] of keys) group.classList.toggle("is-pressed", ids.has(id));
}

/** Returns a picture of boards, one above the other. `each` receives the group of each face. */
export function planPicture(boards, each = () => {}) {
  const svg = document.createElementNS(SVG, "svg");
  let [left, right, top] = [Infinity, -Infinity, 0];
  for (const { faces } of boards) {
    if (faces.length === 0) continue;
    const low = (axis) => Math.min(...faces.map((it) => it.at_mm[axis] - it.half_mm[axis])) - MARGIN_MM;
    const high = (axis) => Math.max(...faces.map((it) => it.at_mm[axis] + it.half_mm[axis])) + MARGIN_MM;
    const board = make("g", { transform: `translate(0 ${round(top + high(1))})` });
    board.append(make("rect", { class: "plan-board", x: low(0), y: -high(1), width: high(0) - low(0), height: high(1) - low(1), rx: 5 }));
    for (const face of faces) {
      const group = keyPicture(face);
      each(group, face);
      board.append(group);
    }
    svg.append(board);
    [left, right] = [Math.min(left, low(0)), Math.max(right, high(0))];
    top += high(1) - low(1) + GAP_MM;
  }
  if (!Number.isFinite(left)) [left, right, top] = [0, 100, 30];
  svg.setAttribute("viewBox", [left, 0, right - left, Math.max(top - GAP_MM, 10)].map(round).join(" "));
  return svg;
}

function keyPicture(face) {
  const [[x, y], [halfX, halfY]] = [face.at_mm, face.half_mm];
  const group = make("g", { class: "plan-key", transform: `translate(${round(x)} ${round(-y)})` });
  group.append(face.is_round
    ? make("ellipse", { rx: halfX, ry: halfY })
    : make("rect", { x: -halfX, y: -halfY, width: 2 * halfX, height: 2 * halfY, rx: Math.min(halfX, halfY) * 0.24 }));
  const label = make("text", { "font-size": round(Math.min(halfY * 0.9, (2.6 * halfX) / Math.max([...face.label].length, 1), 9)) });
  label.textContent = face.label;
  group.append(label);
  return group;
}

function make(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [attribute, value] of Object.entries(attributes)) {
    element.setAttribute(attribute, typeof value === "number" ? round(value) : value);
  }
  return element;
}

const round = (number) => Math.round(number * 100) / 100;

/** Makes a key movable by pointer and keys. */
function prepare(group, face) {
  group.dataset.name = face.name;
  group.setAttribute("tabindex", "0");
  group.setAttribute("role", "button");
  const [x, y] = face.at_mm;
  group.setAttribute("aria-label", `${face.label || face.name}, at ${round(x)}, ${round(y)} mm`);
  const title = make("title", {});
  title.textContent = face.name;
  group.append(title);
  let start = null;
  const offset = (event) => {
    const matrix = group.parentNode.getScreenCTM();
    const by = [(event.clientX - start.clientX) / matrix.a, -(event.clientY - start.clientY) / matrix.d];
    return by.map((it) => Math.round(it * 2) / 2);
  };
  const place = ([dx, dy]) => group.setAttribute("transform", `translate(${round(x + dx)} ${round(-y - dy)})`);
  group.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    start = event;
    group.setPointerCapture(event.pointerId);
    group.classList.add("is-moved");
  });
  const cancel = ({ pointerId }) => {
    start = null;
    if (group.hasPointerCapture(pointerId)) group.releasePointerCapture(pointerId);
    group.classList.remove("is-moved");
    place([0, 0]);
  };
  group.addEventListener("pointermove", (event) => {
    if (!start) return;
    // A button that comes up over another tab is not reported.
    if (event.pointerType === "mouse" && event.buttons === 0) cancel(event);
    else place(offset(event));
  });
  group.addEventListener("pointercancel", cancel);
  group.addEventListener("pointerup", (event) => {
    if (!start) return;
    const by = offset(event);
    start = null;
    group.classList.remove("is-moved");
    if (by[0] !== 0 || by[1] !== 0) change([face.id], { move: { by_mm: by } }) || place([0, 0]);
  });
  group.addEventListener("keydown", (event) => {
    // Those are for the browser: the page before this one, a bookmark.
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = event.shiftKey ? 5 : 1;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (moves[event.key]) change([face.id], { move: { by_mm: moves[event.key] } });
    // The key “delete” of a Mac is Backspace.
    else if (["Delete", "Backspace"].includes(event.key)) change([face.id], "delete");
    else if (event.key.toLowerCase() === "d") change([face.id], "duplicate");
    else return;
    event.preventDefault();
  });
}
