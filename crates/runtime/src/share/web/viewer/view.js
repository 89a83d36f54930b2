// Draws the hands of a session over its boards, and turns the camera. `viewer.js` and the page of `web/` show it.

import { drawBoard, prepareBoards } from "./boards.js";
import { camera } from "./camera.js";
import { drawHand } from "./hands.js";
import { canvas, colorsOfTheme, context, FONT_PX } from "./painting.js";
import { receive, session } from "./session.js";
import { dot, rotate, subtract } from "./vectors.js";

/** What the page around the view adds. */
export const view = {
  /** Called after each picture. */
  onDraw() {},
  /** Nobody sees the picture: it is not drawn. */
  isHidden: false,
  /** Called when a pointer goes down; returns true to keep the camera where it is. */
  onPointerDown(_event) {
    return false;
  },
};

let colors = colorsOfTheme();
let isScheduled = false;

/** Takes a message of the session. */
export function show(message) {
  receive(message);
  if (message.kind === "layout") {
    prepareBoards(message.boards);
    camera.isPlaced = camera.isMoved;
  }
  if (message.kind === "scene" && !camera.isPlaced) camera.reset();
  redraw();
}

/** Draws soon. */
export function redraw() {
  if (!isScheduled && !view.isHidden) {
    isScheduled = true;
    requestAnimationFrame(draw);
  }
}

function draw(now) {
  isScheduled = false;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [pixelWidth, pixelHeight] = [width, height].map((size) => Math.round(size * devicePixelRatio));
  if (canvas.width !== pixelWidth || canvas.height !== pixelHeight) {
    [canvas.width, canvas.height] = [pixelWidth, pixelHeight];
  }
  context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = `600 ${FONT_PX}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  camera.prepare();
  const boards = (session.layout?.boards ?? []).map((board, index) => ({ board, pose: session.boards[index] }));
  const isInFront = ({ pose }) => dot(subtract(camera.eye, pose), rotate(pose, [0, 0, 1])) > 0;
  const hands = Object.values(session.hands);
  for (const { board, pose } of boards.filter(isInFront)) drawBoard(board, pose, colors, now);
  for (const joints of hands) drawHand(joints, colors);
  for (const { board, pose } of boards.filter((it) => !isInFront(it))) drawBoard(board, pose, colors, now);
  view.onDraw();
  if ([...session.pressed.values()].some((light) => light.releasedAt !== null)) redraw();
}

// ---- Mouse, touch and keys.

const pointers = new Map();

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  if (view.onPointerDown(event)) return;
  pointers.set(event.pointerId, event);
});
canvas.addEventListener("pointermove", (event) => {
  // A button that comes up over another tab is not reported.
  if (event.pointerType === "mouse" && event.buttons === 0) pointers.delete(event.pointerId);
  const last = pointers.get(event.pointerId);
  if (!last) return;
  if (pointers.size === 1) {
    camera.turn(event.clientX - last.clientX, event.clientY - last.clientY);
  } else {
    const other = [...pointers.values()].find((it) => it.pointerId !== event.pointerId);
    const distance = (it) => Math.hypot(it.clientX - other.clientX, it.clientY - other.clientY);
    camera.zoom(distance(last) / Math.max(distance(event), 1));
  }
  pointers.set(event.pointerId, event);
  redraw();
});
for (const name of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
}
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.zoom(Math.exp(event.deltaY * 0.001));
  redraw();
}, { passive: false });
canvas.addEventListener("dblclick", () => {
  camera.reset();
  redraw();
});
canvas.addEventListener("keydown", (event) => {
  // Those are for the browser, which makes everything larger, or goes back.
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const turns = { ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12] };
  if (turns[event.key]) camera.turn(...turns[event.key]);
  else if (event.key === "+") camera.zoom(0.9);
  else if (event.key === "-") camera.zoom(1.1);
  else if (event.key === "0") camera.reset();
  else return;
  event.preventDefault();
  redraw();
});

addEventListener("resize", () => {
  if (!camera.isMoved) camera.reset();
  redraw();
});
matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => {
  colors = colorsOfTheme();
  redraw();
});
