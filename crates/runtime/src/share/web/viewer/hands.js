// Hands, forearms, and the shadows that they cast.

import { camera } from "./camera.js";
import { context, fill, hull, mix, stroke, trace } from "./painting.js";
import { session } from "./session.js";
import { add, dot, middle, rotate, scale, subtract } from "./vectors.js";

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

export function drawHand(joints, colors) {
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

/** Returns the colors across a round bone, which is lit from the upper left. */
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

/** Returns a color that vanishes along a bone. */
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
export function drawShadows(pose, outline, colors) {
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
