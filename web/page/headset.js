// A headset as the glove: WebXR follows both hands, the stages of the page read them, and the boards are in the room.

import { stagesTime } from "./clock.js";
import { connectComputer } from "./computer.js";
import { Boards } from "./headset-boards.js";
import { CHAINS, compose, handsOf, TIPS } from "./headset-joints.js";
import { product, Scene } from "./headset-scene.js";
import { click, prepareSound, pulse, stopSound } from "./headset-sound.js";
import { colorsOfTheme } from "./painting.js";
import { session } from "./session.js";
import { middle, move, scale, subtract } from "./vectors.js";
import { redraw, view } from "./view.js";

const MODES = { "immersive-vr": "enter-vr", "immersive-ar": "enter-ar" };
const FADE_MS = 220;
const PANEL_M = [0.16, 0.05];

/** The phases of a touch at which a key goes down and comes up. */
const PRESS = "pressed";
const ENDS = ["released", "cancelled"];

const element = (id) => document.getElementById(id);

/** The headset of the page: what `main.js` tells it, and what runs. */
const page = { stages: null, advance() {}, notify() {} };
let running = null;
/** The browser asks the person, or prepares the session: it gives no second one until then. */
let isEntering = false;
const computer = connectComputer((text) => page.notify(text), (layout) => page.openLayout(layout));

/** Hears what the stages say: a touch sounds, and the panel shows the text. */
export function hear(message) {
  if (!running) return;
  if (message.kind === "touches") sound(message);
  if (message.kind === "session" && message.text !== running.text) {
    running.text = message.text;
    running.scene.setPanel(paintPanel);
  }
  if (message.kind === "candidates") {
    running.candidates = message.words ?? [];
    running.scene.setPanel(paintPanel);
  }
}

/** Clicks when a fingertip presses a key, and when that key comes up. */
function sound({ phase, side, finger }) {
  const tip = `${side} ${finger}`;
  if (phase === PRESS) {
    running.pressing.add(tip);
    click(true);
    pulse(running.hands[side]?.source);
  } else if (ENDS.includes(phase) && running.pressing.delete(tip)) {
    click(false);
  }
}

/** Shows the buttons for the modes that the browser supports. `of` has the stages, and functions of the page. */
export function offer(modes, of) {
  Object.assign(page, of);
  for (const mode of modes) {
    const button = element(MODES[mode]);
    button.hidden = false;
    button.addEventListener("click", () => (running ? running.session.end() : isEntering || enter(mode)));
    element("headset").hidden = false;
  }
  computer.start();
}

async function enter(mode) {
  let started = null;
  isEntering = true;
  try {
    // Not awaited: a browser may never permit it.
    prepareSound().catch(() => {});
    started = await navigator.xr.requestSession(mode, { requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking"] });
    started.addEventListener("end", leave);
    started.addEventListener("visibilitychange", rest);
    await run(started);
  } catch (error) {
    // Otherwise a person who has entered sees nothing, and no further session begins.
    started?.end().catch(() => {});
    leave();
    page.notify(`the headset cannot be used: ${error.message}; allow this page to use virtual reality and hand tracking`);
  } finally {
    isEntering = false;
  }
}

async function run(started) {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2", { xrCompatible: true, antialias: true, alpha: true });
  if (!gl) throw new Error("it has no WebGL 2");
  await gl.makeXRCompatible?.();
  started.updateRenderState({ baseLayer: new XRWebGLLayer(started, gl), depthNear: 0.05, depthFar: 20 });
  const space = await started.requestReferenceSpace("local-floor");
  page.stages.release();
  running = {
    session: started, gl, space, canvas, hands: {}, boards: new Boards(), scene: new Scene(gl), colors: theme(),
    layout: null, text: null, candidates: [], lastPush: -1, pressing: new Set(),
  };
  // For a look from outside of a headset, as in the tests.
  element("headset").dataset.session = started.environmentBlendMode ?? "opaque";
  running.scene.setPanel(paintPanel);
  view.isHidden = true;
  started.requestAnimationFrame(onFrame);
}

/** Ends the session: everything is released. */
function leave() {
  running?.session.end().catch(() => {});
  if (!running) return;
  running.gl.getExtension("WEBGL_lose_context")?.loseContext();
  running.canvas.remove();
  running = null;
  computer.send([]);
  page.stages.release();
  stopSound();
  view.isHidden = false;
  redraw();
  delete element("headset").dataset.session;
}

/** Releases everything while the browser shows something else, and gives no frames. */
function rest() {
  if (running?.session.visibilityState !== "hidden") return;
  computer.send([]);
  page.stages.release();
}

function onFrame(_, frame) {
  if (!running) return;
  const { session: own, space, boards } = running;
  own.requestAnimationFrame(onFrame);
  const viewer = frame.getViewerPose(space);
  running.hands = handsOf(frame, space);
  if (viewer) {
    const { position: p, orientation: o } = viewer.transform;
    const isSteady = boards.follow(running.hands, [p.x, p.y, p.z, o.x, o.y, o.z, o.w], performance.now());
    push(isSteady ? Object.values(running.hands) : []);
  } else {
    push([]);
  }
  page.advance(performance.now());
  if (viewer && running) draw(viewer);
}

/** Passes the hands to the stages, and to the computer if there is one. Hands that are missing release their keys. */
function push(hands) {
  const seen = hands.map(({ side, joints }) => ({
    label: side,
    joints: joints.map((joint) => joint && running.boards.toWorld(joint).map((axis) => Math.round(axis * 1e5) / 1e5)),
  }));
  const time = Math.round(stagesTime() * 1000);
  // Two lines of one time are one too many.
  if (time > running.lastPush) page.stages.push("webxr", `${JSON.stringify({ time_us: time, hands: seen })}\n`);
  running.lastPush = time;
  computer.send(seen);
}

// ---- The picture.

const channels = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);

function theme() {
  return Object.fromEntries(Object.entries(colorsOfTheme()).map(([name, color]) => [name, channels(color)]));
}

function draw(viewer) {
  const { session: own, gl, scene, boards, colors } = running;
  if (running.layout !== session.layout) {
    running.layout = session.layout;
    scene.setLabels(session.layout?.boards ?? []);
  }
  const layer = own.renderState.baseLayer;
  gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
  const isRoomHidden = (own.environmentBlendMode ?? "opaque") === "opaque";
  gl.clearColor(...(isRoomHidden ? [0.045, 0.055, 0.08, 1] : [0, 0, 0, 0]));
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const now = performance.now();
  const prisms = (session.layout?.boards ?? []).flatMap((board, index) => (session.boards[index] ? prismsOf(board, index, now) : []));
  if (isRoomHidden) prisms.push(FLOOR);
  const hands = Object.values(running.hands);
  const views = viewer.views.map((view) => ({
    viewport: layer.getViewport(view),
    clip: product(view.projectionMatrix, view.transform.inverse.matrix),
    eye: [view.transform.position.x, view.transform.position.y, view.transform.position.z],
  }));
  scene.draw(views, {
    prisms,
    panel: panelOf(viewer, boards),
    bones: hands.flatMap((hand) => bonesOf(hand, colors.skin)),
    tips: hands.flatMap(({ joints }) => TIPS.map((tip) => joints[tip]).filter(Boolean)),
    glow: colors.lit,
    ink: colors.label,
  });
}

/** The floor of a room that is hidden, so that a person knows where down is. */
const FLOOR = { pose: [0, 0, 0, -Math.SQRT1_2, 0, 0, Math.SQRT1_2], half: [2.5, 2.5], radius: 2.5, height: 0.01, color: [0.1, 0.12, 0.17] };

/** Returns the plate and the keys of a board in the room. */
function prismsOf(board, index, now) {
  const { boards, colors, scene } = running;
  const pose = boards.pose(index);
  const prisms = board.targets.map((target) => {
    const light = lightOf(target.id, now);
    const sunk = light === 1 ? -0.7 * target.travel_m : 0;
    const front = compose(pose, target.pose);
    return {
      pose: [...move(front, [0, 0, sunk]), ...front.slice(3)], half: target.half_m, height: target.height + sunk, color: colors.key, light, isLit: true,
      radius: target.is_round ? target.half_m[0] : 0.24 * Math.min(...target.half_m), part: scene.parts.get(target.id),
    };
  });
  if (board.base) {
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((axis) => pick(...board.base.map((point) => point[axis]))));
    const center = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, board.base[0][2]];
    prisms.push({
      pose: [...move(pose, center), ...pose.slice(3)], half: scale(subtract([...high, 0], [...low, 0]), 0.5).slice(0, 2), radius: 0.009, height: 0.008,
      color: boards.touched.has(index) ? colors["lit-side"] : colors.board, isLit: true,
    });
  }
  return prisms;
}

/** Returns how brightly a target is lit, from 0 to 1. */
function lightOf(id, now) {
  const light = session.pressed.get(id);
  if (!light) return 0;
  return light.releasedAt === null ? 1 : Math.max(0.9 - (now - light.releasedAt) / FADE_MS, 0);
}

/** Returns capsules between the joints of a hand, and across the palm. */
function bonesOf({ joints, radii }, color) {
  const bones = [];
  const add = (one, other) => joints[one] && joints[other] && bones.push({
    from: joints[one], to: joints[other], radii: [radii[one], radii[other]], color,
  });
  for (const chain of CHAINS) chain.slice(1).forEach((joint, index) => add(chain[index], joint));
  for (const knuckle of [6, 11, 16]) add(knuckle, knuckle + 5);
  return bones;
}

/** Returns the panel with the text: beyond the boards, and facing the eyes. */
function panelOf(viewer, boards) {
  const fronts = (session.layout?.boards ?? []).flatMap(({ targets }, index) =>
    (session.boards[index] ? targets.map((target) => move(boards.pose(index), target.pose)) : []));
  const { position: p, orientation: o } = viewer.transform;
  const head = [p.x, p.y, p.z, o.x, o.y, o.z, o.w];
  const center = fronts.length > 0 ? middle(fronts) : move(head, [0, 0, -0.5]);
  const ahead = subtract(center, head);
  const angle = Math.atan2(-ahead[0], -ahead[2]);
  const reach = Math.max(0.06, ...fronts.map((front) => (front[0] - center[0]) * -Math.sin(angle) + (front[2] - center[2]) * -Math.cos(angle)));
  const level = [0, 0, 0, 0, Math.sin(angle / 2), 0, Math.cos(angle / 2)];
  const place = [...move([...center, ...level.slice(3)], [0, 0.09, -reach - 0.05]), ...level.slice(3)];
  const tilt = [0, 0, 0, Math.sin(-0.25), 0, 0, Math.cos(-0.25)];
  return { pose: compose(place, tilt), half: PANEL_M, radius: 0.008, height: 0.004, color: running.colors.board, part: [0, 0, 1, 1] };
}

function paintPanel(context, width, height) {
  context.fillStyle = "#10151f";
  context.fillRect(0, 0, width, height);
  Object.assign(context, { textBaseline: "middle", font: "600 72px system-ui, sans-serif", fillStyle: "#e9edf5", textAlign: "left" });
  const lines = (running?.text ?? "").split("\n").slice(-1)[0];
  // The end of the text is what was typed last.
  let shown = lines;
  while (shown && context.measureText(`${shown}|`).width > width - 80) shown = shown.slice(1);
  context.fillText(`${shown}|`, 40, height * 0.36);
  Object.assign(context, { font: "500 44px system-ui, sans-serif", fillStyle: "#ffb84d" });
  context.fillText((running?.candidates ?? []).join("    ") || computer.state() || session.layout?.name || "", 40, height * 0.76);
}

/** Returns the place of the boards in the room, from which a test knows where a hand has to be; null outside of a headset. */
export const placement = () => running?.boards ?? null;
