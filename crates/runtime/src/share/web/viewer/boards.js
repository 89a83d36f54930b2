// Boards and their keys.

import { camera } from "./camera.js";
import { drawShadows } from "./hands.js";
import { context, fill, FONT_PX, hull, mix, textWidth } from "./painting.js";
import { session } from "./session.js";
import { add, move, scale } from "./vectors.js";

const MIN_KEY_HEIGHT_M = 0.004;
const BOARD_MARGIN_M = 0.006;

/** Computes the outlines that do not change while a layout is active. */
export function prepareBoards(boards) {
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

export function drawBoard(board, pose, colors, now) {
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

/** Time in which the light of a released key fades, in milliseconds. */
const FADE_MS = 220;

/** Returns how brightly a target is lit, from 0 to 1. */
function lightOf(id, now) {
  const light = session.pressed.get(id);
  if (!light) return 0;
  if (light.releasedAt === null) return 1;
  const left = 1 - (now - light.releasedAt) / FADE_MS;
  if (left <= 0) session.pressed.delete(id);
  return Math.max(left, 0) * 0.9;
}

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
