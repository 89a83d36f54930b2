// Draws the hands of a session over its boards.

import { drawBoard, prepareBoards } from "./boards.js";
import { camera } from "./camera.js";
import { drawHand } from "./hands.js";
import { canvas, colorsOfTheme, context, FONT_PX } from "./painting.js";
import { receive, session } from "./session.js";
import { dot, rotate, subtract } from "./vectors.js";

// ---- The connection, which is opened again whenever it is lost.

const KINDS = ["layout", "scene", "pose", "events"];
let retryMs = 500;

function connect() {
  const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
  socket.onopen = () => {
    retryMs = 500;
    socket.send(JSON.stringify({ kinds: KINDS, rate_hz: 60 }));
    session.state = "connected";
    redraw();
  };
  socket.onmessage = (event) => {
    const message = JSON.parse(event.data);
    receive(message);
    if (message.kind === "layout") {
      prepareBoards(message.boards);
      camera.isPlaced = camera.isMoved;
    }
    if (message.kind === "scene" && !camera.isPlaced) camera.reset();
    redraw();
  };
  socket.onclose = () => {
    session.state = "lost";
    session.hands = {};
    session.keys = [];
    session.pressed.clear();
    redraw();
    setTimeout(connect, retryMs);
    retryMs = Math.min(retryMs * 2, 5000);
  };
}

// ---- Drawing.

let colors = colorsOfTheme();
let isScheduled = false;

function redraw() {
  if (!isScheduled) {
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
  showWords();
  if ([...session.pressed.values()].some((light) => light.releasedAt !== null)) redraw();
}

const element = (id) => document.getElementById(id);
let shownKeys = "";

function showWords() {
  const words = { lost: "not connected", connected: "waiting for the hand" };
  setText("state", words[session.state] ?? session.state);
  element("state").className = session.state;
  setText("layout", session.layout?.name ?? "");
  setText("text", session.text);
  const keys = session.keys.join(" ");
  if (keys !== shownKeys) {
    shownKeys = keys;
    element("keys").replaceChildren(...session.keys.map((key) => {
      const chip = document.createElement("kbd");
      chip.textContent = key;
      return chip;
    }));
  }
}

function setText(id, text) {
  if (element(id).textContent !== text) element(id).textContent = text;
}

// ---- Mouse, touch and keys.

const pointers = new Map();

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
});
canvas.addEventListener("pointermove", (event) => {
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
connect();
redraw();
