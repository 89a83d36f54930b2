// A mouse or a finger on the picture as a fingertip: a ray through the picture, and the front of the key that it meets.

import { camera } from "./camera.js";
import { canvas } from "./painting.js";
import { session } from "./session.js";
import { add, dot, move, rotate, scale, subtract } from "./vectors.js";
import { view } from "./view.js";

/** Distance from a front up to which a pointer still means it, in metres. */
const REACH_M = 0.006;

/** Returns the direction of the ray through a point of the picture. */
function rayThrough(event) {
  const box = canvas.getBoundingClientRect();
  const [x, y] = camera.center;
  const right = scale(camera.right, (event.clientX - box.left - x) / camera.focal);
  const up = scale(camera.up, -(event.clientY - box.top - y) / camera.focal);
  return add(camera.forward, add(right, up));
}

/** Returns the front at a point of the picture: the point on it, its normal, travel and board; null beside the boards. */
function frontAt(event) {
  const ray = rayThrough(event);
  let nearest = null;
  (session.layout?.boards ?? []).forEach((board, index) => {
    const boardPose = session.boards[index];
    for (const target of board.targets) {
      const center = move(boardPose, target.pose);
      const axis = (of) => rotate(boardPose, rotate(target.pose, of));
      const normal = axis([0, 0, 1]);
      const facing = dot(ray, normal);
      if (facing >= 0) continue;
      const distance = dot(subtract(center, camera.eye), normal) / facing;
      const point = add(camera.eye, scale(ray, distance));
      const from = subtract(point, center);
      const [across, along] = [dot(from, axis([1, 0, 0])), dot(from, axis([0, 1, 0]))];
      const [halfX, halfY] = target.half_m;
      const beside = target.is_round
        ? Math.hypot(across, along) - halfX
        : Math.max(Math.abs(across) - halfX, Math.abs(along) - halfY);
      const found = { point, normal, travel: target.travel_m, board: index, beside: Math.max(beside, 0), distance };
      const isNearer = !nearest || found.beside < nearest.beside || (found.beside === nearest.beside && distance < nearest.distance);
      if (distance > 0 && beside < REACH_M && isNearer) nearest = found;
    }
  });
  return nearest;
}

/** Points with the mouse or a finger. `point` receives a front and whether the button is down; `mayHover` tells whether the hand is free. */
export function followPointer(point, mayHover) {
  let pressed = null;
  let last = null;
  const lift = (event) => {
    if (pressed !== event.pointerId) return;
    pressed = null;
    point(last, false);
  };
  view.onPointerDown = (event) => {
    const front = event.button === 0 && pressed === null ? frontAt(event) : null;
    if (!front) return false;
    pressed = event.pointerId;
    last = front;
    point(front, true);
    return true;
  };
  canvas.addEventListener("pointermove", (event) => {
    const isFree = event.pointerType === "mouse" && event.buttons === 0;
    // A button that comes up over another tab is not reported.
    if (isFree) lift(event);
    if (pressed === event.pointerId) {
      // A finger may slide along its board.
      const front = frontAt(event);
      if (front) point((last = front), true);
    } else if (isFree && mayHover()) {
      const front = frontAt(event);
      canvas.style.cursor = front ? "pointer" : "";
      if (front) point((last = front), false);
    }
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, lift);
}
