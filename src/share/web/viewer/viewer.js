"use strict";
// Draws the hands of a session over its boards: positions in metres, X to the right, Y up, -Z forward.

// ---- Vectors and poses. A pose is [x, y, z, i, j, k, w].

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, t) => [a[0] * t, a[1] * t, a[2] * t];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const middle = (points) => scale(points.reduce(add, [0, 0, 0]), 1 / points.length);

function rotate(pose, v) {
  const axis = [pose[3], pose[4], pose[5]];
  const t = scale(cross(axis, v), 2);
  return add(add(v, scale(t, pose[6])), cross(axis, t));
}

const move = (pose, v) => add(pose, rotate(pose, v));

// ---- The state of the session, from its messages.

const session = { layout: null, boards: [], state: "connecting", hands: {}, pressed: new Map(), keys: [], text: "" };

/** Time in which the light of a released key fades, in milliseconds. */
const FADE_MS = 220;

const receive = {
  layout(message) {
    session.layout = message;
    session.boards = message.boards.map((board) => board.pose);
    session.pressed.clear();
    prepareBoards(message.boards);
    camera.isPlaced = camera.isMoved;
  },
  scene(message) {
    session.state = message.state;
    message.boards.forEach((pose, index) => {
      if (pose) session.boards[index] = pose;
    });
    const now = performance.now();
    const pressed = new Set(message.pressed);
    for (const [id, light] of session.pressed) {
      if (!pressed.has(id) && light.releasedAt === null) light.releasedAt = now;
    }
    for (const id of pressed) session.pressed.set(id, { releasedAt: null });
    session.keys = message.keys;
    if (!camera.isPlaced) camera.reset();
    if (message.state !== "running" && message.state !== "paused") session.hands = {};
  },
  pose(message) {
    session.hands[message.side] = message.positions;
  },
  events(message) {
    if (message.event === "character") session.text += message.character;
    if (message.event === "key-down") session.text += typed(message.key);
    session.text = [...session.text].slice(-48).join("");
  },
};

const SIGNS = { Space: " ", Enter: "⏎", Backspace: "⌫", Tab: "⇥", Escape: "⎋", Delete: "⌦" };
const SIGNS_OF_PUNCTUATION = {
  Comma: ",", Period: ".", Minus: "-", Equal: "=", Slash: "/", Semicolon: ";", Quote: "'", Backslash: "\\", Backquote: "`",
};

/** Returns what a key adds to the line of text. */
function typed(key) {
  if (key.length === 1) {
    return session.keys.some((it) => it.startsWith("Shift")) ? key : key.toLowerCase();
  }
  return SIGNS[key] ?? SIGNS_OF_PUNCTUATION[key] ?? "";
}

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
    receive[message.kind]?.(message);
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

// ---- The camera, which turns around a point.

const canvas = document.getElementById("view");
const context = canvas.getContext("2d");

const camera = {
  target: [0, 0, -0.5], azimuth: 0, elevation: 1, distance: 0.6,
  isMoved: false, isPlaced: false,

  /** Shows all boards as the wearer sees them, or the hand if there are none. */
  reset() {
    const points = shownPoints();
    this.isMoved = false;
    if (points.length === 0) return;
    this.isPlaced = true;
    // Away from the wearer along a board that lies, and through one that stands.
    const away = session.boards.map((board) => rotate(board, [0, 0.8, -0.6])).reduce(add, [0, 0, -1e-3]);
    this.azimuth = Math.atan2(-away[0], -away[2]);
    this.elevation = 1;
    const low = [0, 1, 2].map((axis) => Math.min(...points.map((p) => p[axis])));
    const high = [0, 1, 2].map((axis) => Math.max(...points.map((p) => p[axis])));
    this.target = scale(add(low, high), 0.5);
    const radius = Math.max(0.08, Math.hypot(...subtract(high, low)) / 2);
    const aspect = canvas.clientWidth / canvas.clientHeight || 1;
    this.distance = (radius * 2.8) / Math.min(1, aspect * 0.95);
    this.distance = Math.min(Math.max(this.distance, 0.2), 4);
  },
  /** Computes the axes and the scale for this picture. */
  prepare() {
    const [a, e] = [this.azimuth, this.elevation];
    const back = [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
    this.eye = add(this.target, scale(back, this.distance));
    this.forward = scale(back, -1);
    this.right = [Math.cos(a), 0, -Math.sin(a)];
    this.up = cross(back, this.right);
    this.center = [canvas.clientWidth / 2, canvas.clientHeight * 0.47];
    this.focal = canvas.clientHeight * 1.25;
  },
  /** Returns the position on the screen, and the distance along the view. */
  project(point) {
    const offset = subtract(point, this.eye);
    const depth = Math.max(dot(offset, this.forward), 0.02);
    const factor = this.focal / depth;
    const [x, y] = this.center;
    return [x + dot(offset, this.right) * factor, y - dot(offset, this.up) * factor, depth];
  },
  turn(dx, dy) {
    this.azimuth -= dx * 0.008;
    this.elevation = Math.min(Math.max(this.elevation + dy * 0.008, -0.2), 1.55);
    this.isMoved = true;
  },
  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.08), 6);
    this.isMoved = true;
  },
};

/** Returns the positions of all targets, or else of the joints beyond the elbow. */
function shownPoints() {
  const targets = (session.layout?.boards ?? []).flatMap((board, index) =>
    board.targets.map((target) => move(session.boards[index], target.pose)));
  if (targets.length > 0) return targets;
  return Object.values(session.hands).flatMap((joints) =>
    Object.entries(joints).filter(([name]) => name !== "shoulder").map(([, position]) => position));
}

// ---- Boards.

const MIN_KEY_HEIGHT_M = 0.004;
const BOARD_MARGIN_M = 0.006;

/** Computes the outlines that do not change while a layout is active. */
function prepareBoards(boards) {
  for (const board of boards) {
    for (const target of board.targets) {
      target.height = Math.max(target.travel_m, MIN_KEY_HEIGHT_M);
      target.outline = target.is_round ? circle(target.half_m[0]) : roundedBox(target.half_m);
    }
    board.base = baseOf(board.targets);
  }
}

function circle(radius) {
  return Array.from({ length: 40 }, (_, index) => {
    const angle = (index / 40) * 2 * Math.PI;
    return [Math.cos(angle) * radius, Math.sin(angle) * radius, 0];
  });
}

/** Returns a box whose corners are arcs of `steps` lines. */
function roundedBox([x, y], radius = 0.24 * Math.min(x, y), steps = 3) {
  const corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
  return corners.flatMap(([sx, sy], corner) =>
    Array.from({ length: steps + 1 }, (_, index) => {
      const angle = (corner + index / steps) * (Math.PI / 2);
      return [sx * (x - radius) + Math.cos(angle) * radius, sy * (y - radius) + Math.sin(angle) * radius, 0];
    }));
}

/** Returns the outline of the plate below the keys of a flat board; null for another board. */
function baseOf(targets) {
  if (targets.length === 0) return null;
  const heights = targets.map((target) => target.pose[2]);
  if (Math.max(...heights) - Math.min(...heights) > 0.002) return null;
  const points = targets.flatMap((target) => target.outline.map((point) => move(target.pose, point)));
  const [xs, ys] = [points.map((p) => p[0]), points.map((p) => p[1])];
  const [left, right] = [Math.min(...xs) - BOARD_MARGIN_M, Math.max(...xs) + BOARD_MARGIN_M];
  const [near, far] = [Math.min(...ys) - BOARD_MARGIN_M, Math.max(...ys) + BOARD_MARGIN_M];
  const z = Math.min(...heights) - Math.max(...targets.map((target) => target.height)) - 0.001;
  const center = [(left + right) / 2, (near + far) / 2, z];
  const half = [(right - left) / 2, (far - near) / 2];
  return roundedBox(half, 0.009, 8).map((point) => add(point, center));
}

function drawBoard(board, pose, colors, now) {
  if (board.base) {
    const top = board.base.map((point) => camera.project(move(pose, point)));
    const bottom = board.base.map((point) => camera.project(move(pose, add(point, [0, 0, -0.008]))));
    fill(hull([...top, ...bottom]), colors["board-edge"]);
    fill(top, colors.board);
  }
  const keys = board.targets.map((target) => ({ target, depth: camera.project(move(pose, target.pose))[2] }));
  keys.sort((one, other) => other.depth - one.depth);
  for (const { target } of keys) drawKey(target, pose, colors, now);
  if (board.base) drawShadows(pose, board.base.map((point) => camera.project(move(pose, [point[0], point[1], 0]))), colors);
}

function drawKey(target, boardPose, colors, now) {
  const light = lightOf(target.id, now);
  const sunk = light === 1 ? -0.7 * target.travel_m : 0;
  const at = (point, z) => camera.project(move(boardPose, move(target.pose, [point[0], point[1], z])));
  const top = target.outline.map((point) => at(point, sunk));
  const bottom = target.outline.map((point) => at(scale(point, 1.04), -target.height));
  fill(hull([...top, ...bottom]), mix(colors["key-side"], colors["lit-side"], light));
  if (light > 0) {
    context.shadowColor = colors.lit;
    context.shadowBlur = 28 * light;
  }
  fill(top, mix(colors.key, colors.lit, light));
  context.shadowBlur = 0;
  drawLabel(target, at, sunk, mix(colors.label, colors["lit-label"], light));
}

/** Returns how brightly a target is lit, from 0 to 1. */
function lightOf(id, now) {
  const light = session.pressed.get(id);
  if (!light) return 0;
  if (light.releasedAt === null) return 1;
  const left = 1 - (now - light.releasedAt) / FADE_MS;
  if (left <= 0) session.pressed.delete(id);
  return Math.max(left, 0) * 0.9;
}

const FONT_PX = 100;
const MAX_LABEL_M = 0.012;

/** Writes the label flat on the key. */
function drawLabel(target, at, z, color) {
  const [halfX, halfY] = target.half_m;
  const width = textWidth(target.label) / FONT_PX;
  const size = Math.min(halfY * 0.95, (1.7 * halfX) / Math.max(width, 0.4), MAX_LABEL_M);
  const [origin, right, down] = [at([0, 0], z), at([size, 0], z), at([0, -size], z)];
  const ratio = devicePixelRatio / FONT_PX;
  const along = (end) => [(end[0] - origin[0]) * ratio, (end[1] - origin[1]) * ratio];
  context.save();
  context.setTransform(...along(right), ...along(down), origin[0] * devicePixelRatio, origin[1] * devicePixelRatio);
  context.fillStyle = color;
  context.fillText(target.label, 0, FONT_PX * 0.04);
  context.restore();
}

const widths = new Map();

function textWidth(text) {
  if (!widths.has(text)) widths.set(text, context.measureText(text).width);
  return widths.get(text);
}

// ---- Hands.

const FINGERS = [
  { name: "thumb", radius: 0.0098, joints: ["metacarpal", "phalanx-proximal", "phalanx-distal", "tip"] },
  ...["index", "middle", "ring", "pinky"].map((name, index) => ({
    name: `${name}-finger`,
    radius: [0.0083, 0.0086, 0.0081, 0.0071][index],
    joints: ["phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"],
  })),
];

/** Returns the bones of a hand: chains of points with radii, and the palm. */
function partsOf(joints) {
  const parts = [];
  const { elbow, wrist } = joints;
  const knuckles = [];
  for (const finger of FINGERS) {
    const points = finger.joints.map((joint) => joints[`${finger.name}-${joint}`]).filter(Boolean);
    if (points.length < 2) continue;
    knuckles.push(points[0]);
    const radii = points.map((_, index) => finger.radius * (1.12 - (0.24 * index) / (points.length - 1)));
    parts.push({ points, radii, style: "skin" });
  }
  if (wrist && knuckles.length > 2) {
    parts.push({ points: [wrist, ...knuckles], radii: [0.019, ...knuckles.map(() => 0.011)], style: "skin", isPalm: true });
  }
  if (wrist && elbow) {
    const along = (t) => add(wrist, scale(subtract(elbow, wrist), t));
    parts.push({ points: [wrist, along(0.2)], radii: [0.019, 0.021], style: "skin", isBelow: true });
    parts.push({ points: [along(0.2), along(0.62)], radii: [0.025, 0.031], style: "sleeve", isBelow: true, fades: true });
  }
  return parts;
}

function drawHand(joints, colors) {
  const parts = partsOf(joints).map((part) => {
    const depth = camera.project(middle(part.points))[2];
    // The forearm ends below the palm, however near it comes, and so do fingers that are not bent over it.
    return { ...part, depth: depth + (part.isBelow ? 1 : 0) - (part.isPalm ? 0.015 : 0) };
  });
  parts.sort((one, other) => other.depth - one.depth);
  for (const part of parts) {
    part.isPalm ? drawPalm(part, colors) : drawChain(part, colors);
  }
}

function drawPalm({ points, radii }, colors) {
  const discs = points.map((point, index) => disc(point, radii[index]));
  const around = (extra) => hull(discs.flatMap((it) => capsule(it, it, extra)));
  const [wrist, ...knuckles] = discs;
  const [x, y] = middle(knuckles);
  const sheen = context.createLinearGradient(wrist[0], wrist[1], x, y);
  sheen.addColorStop(0, mix(colors.skin, colors["skin-edge"], 0.2));
  sheen.addColorStop(0.6, colors.skin);
  sheen.addColorStop(1, mix(colors.skin, colors["skin-light"], 0.35));
  fill(around(1.5), colors["skin-edge"]);
  fill(around(0), sheen);
}

/** Returns the position and the radius of a ball on the screen. */
function disc(point, radius) {
  const [x, y, depth] = camera.project(point);
  return [x, y, (radius * camera.focal) / depth];
}

function drawChain({ points, radii, style, fades }, colors) {
  const discs = points.map((point, index) => disc(point, radii[index]));
  const bones = discs.slice(1).map((to, index) => [discs[index], to]);
  if (fades) {
    // The rest of the arm would hide the board.
    const [[from, to]] = bones;
    fill(capsule(from, to, 1.5), faded(from, to, colors[`${style}-edge`]));
    fill(capsule(from, to, 0), faded(from, to, colors[style]));
    return;
  }
  for (const [from, to] of bones) fill(capsule(from, to, 1.5), colors[`${style}-edge`]);
  for (const [from, to] of bones) fill(capsule(from, to, 0), rounded(from, to, colors[style], colors));
}

/** Returns the colours across a round bone, which is lit from the upper left. */
function rounded([x1, y1, r1], [x2, y2, r2], color, colors) {
  const length = Math.hypot(x2 - x1, y2 - y1) || 1;
  const radius = Math.max(r1, r2);
  let [nx, ny] = [(y2 - y1) / length, (x1 - x2) / length];
  if (nx * 0.5 + ny * 0.85 > 0) [nx, ny] = [-nx, -ny];
  const [x, y] = [(x1 + x2) / 2, (y1 + y2) / 2];
  const gradient = context.createLinearGradient(x + nx * radius, y + ny * radius, x - nx * radius, y - ny * radius);
  gradient.addColorStop(0, mix(color, colors["skin-light"], 0.15));
  gradient.addColorStop(0.28, mix(color, colors["skin-light"], 0.55));
  gradient.addColorStop(0.62, color);
  gradient.addColorStop(1, mix(color, colors["skin-edge"], 0.4));
  return gradient;
}

/** Returns a colour that vanishes along a bone. */
function faded([x1, y1], [x2, y2], color) {
  const gradient = context.createLinearGradient(x1, y1, x2, y2);
  gradient.addColorStop(0.25, color);
  gradient.addColorStop(1, `${color}00`);
  return gradient;
}

/** Lines of half a circle. */
const ARC_STEPS = 16;

/** Returns the outline of two discs and what is between them. */
function capsule([x1, y1, r1], [x2, y2, r2], extra) {
  const angle = Math.atan2(y2 - y1, x2 - x1);
  const points = [];
  const arc = (x, y, radius, start) => {
    for (let index = 0; index <= ARC_STEPS; index += 1) {
      const at = start + (index / ARC_STEPS) * Math.PI;
      points.push([x + Math.cos(at) * radius, y + Math.sin(at) * radius]);
    }
  };
  arc(x2, y2, r2 + extra, angle - Math.PI / 2);
  arc(x1, y1, r1 + extra, angle + Math.PI / 2);
  return points;
}

/** Draws the shadows of the hands on the keys of a flat board. */
function drawShadows(pose, outline, colors) {
  const normal = rotate(pose, [0, 0, 1]);
  context.save();
  trace(outline, true);
  context.clip();
  context.lineCap = context.lineJoin = "round";
  for (const joints of Object.values(session.hands)) {
    for (const { points, radii } of partsOf(joints)) {
      const heights = points.map((point) => dot(subtract(point, pose), normal));
      const height = heights.reduce((sum, it) => sum + it, 0) / heights.length;
      if (height < -0.01 || height > 0.15) continue;
      const shadow = points.map((point, index) => camera.project(subtract(point, scale(normal, heights[index]))));
      const width = (2 * radii[0] * camera.focal) / shadow[0][2];
      context.globalAlpha = 0.22 * (1 - Math.max(height, 0) / 0.15);
      stroke(shadow, false, width, colors.shadow);
    }
  }
  context.restore();
}

// ---- Painting.

function trace(points, isClosed) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  if (isClosed) context.closePath();
}

function fill(points, color) {
  trace(points, true);
  context.fillStyle = color;
  context.fill();
}

function stroke(points, isClosed, width, color) {
  trace(points, isClosed);
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}

/** Returns the convex hull of points on the screen (Andrew's monotone chain). */
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const chain = [];
    for (const point of list) {
      while (chain.length > 1 && area(chain[chain.length - 2], chain[chain.length - 1], point) <= 0) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

const area = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

/** Returns a colour between two, written as #rrggbb. */
function mix(from, to, t) {
  if (t <= 0) return from;
  const channel = (color, index) => parseInt(color.slice(1 + 2 * index, 3 + 2 * index), 16);
  const mixed = [0, 1, 2].map((index) => Math.round(channel(from, index) * (1 - t) + channel(to, index) * t));
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

const COLOR_NAMES = [
  "board", "board-edge", "key", "key-side", "label", "lit", "lit-side", "lit-label",
  "skin", "skin-edge", "skin-light", "sleeve", "sleeve-edge", "shadow",
];

function colorsOfTheme() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(COLOR_NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

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
