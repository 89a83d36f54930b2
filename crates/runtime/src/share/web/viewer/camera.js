// The camera, which turns around a point.

import { canvas } from "./painting.js";
import { session } from "./session.js";
import { add, cross, dot, move, rotate, scale, subtract } from "./vectors.js";

export const camera = {
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
