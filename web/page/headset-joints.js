// The hands that a headset follows: 25 joints of WebXR each, in the room (metres, X to the right, Y up, -Z forward).

import { add, cross, dot, middle, move, scale, subtract } from "./vectors.js";

const JOINTS = 25;
const WRIST = 0;
const THUMB_TIP = 4;
const INDEX_TIP = 9;
export const TIPS = [4, 9, 14, 19, 24];
const INDEX_KNUCKLE = 6;
const MIDDLE_KNUCKLE = 11;
const PINKY_KNUCKLE = 21;

/** The joints of each finger, from the wrist outwards. */
export const CHAINS = [0, 5, 10, 15, 20].map((first) =>
  [WRIST, ...Array.from({ length: first === 0 ? 4 : 5 }, (_, index) => (first || 1) + index)]);

/** The usual radius of a joint that a headset does not state, in metres. */
const RADIUS_M = 0.009;

const matrices = new Float32Array(16 * JOINTS);
const radii = new Float32Array(JOINTS);

/** Returns the hands of a frame, by side; a hand that is not followed is missing. A joint that is not followed is null. */
export function handsOf(frame, space) {
  const hands = {};
  for (const source of frame.session.inputSources) {
    if (!source.hand || !["left", "right"].includes(source.handedness)) continue;
    const spaces = [...source.hand.values()];
    if (spaces.length !== JOINTS) continue;
    // One call for all joints; it fails if one of them is not followed.
    const joints = frame.fillPoses?.(spaces, space, matrices)
      ? spaces.map((_, index) => [...matrices.subarray(16 * index + 12, 16 * index + 15)])
      : spaces.map((joint) => {
        const position = frame.getJointPose(joint, space)?.transform.position;
        return position ? [position.x, position.y, position.z] : null;
      });
    if (!joints.some(Boolean)) continue;
    const isFilled = frame.fillJointRadii?.(spaces, radii);
    const own = Array.from(radii, (radius) => (isFilled && radius > 0.002 ? radius : RADIUS_M));
    hands[source.handedness] = { side: source.handedness, joints, radii: own, source };
  }
  return hands;
}

/** Returns the pose of a hand: the wrist, and axes along and out of the back of the hand; null if it is not known. */
export function poseOf({ joints }) {
  const [wrist, index, pinky] = [WRIST, INDEX_KNUCKLE, PINKY_KNUCKLE].map((joint) => joints[joint]);
  if (!wrist || !index || !pinky) return null;
  const forward = unit(subtract(middle([index, pinky]), wrist));
  const across = unit(subtract(index, pinky));
  const out = unit(cross(forward, across));
  return [...wrist, ...quaternionOf(unit(cross(out, forward)), out, scale(forward, -1))];
}

/** Returns the distance between the tips of thumb and index finger, and the point between them; null if they are not known. */
export function pinchOf({ joints }) {
  const [thumb, index] = [joints[THUMB_TIP], joints[INDEX_TIP]];
  if (!thumb || !index) return null;
  return { distance: Math.hypot(...subtract(thumb, index)), point: middle([thumb, index]) };
}

/** Largest distance of a fingertip from the plane of a flat hand, in metres, and the smallest part of the length of the bones. */
const FLAT_M = 0.02;
const STRETCHED = 0.93;

/** Returns the height of the fingertips of a hand that lies flat, palm down, and where it points; null if it does not. */
export function flatOf({ joints }) {
  if (!joints.every(Boolean)) return null;
  const [wrist, index, pinky] = [WRIST, INDEX_KNUCKLE, PINKY_KNUCKLE].map((joint) => joints[joint]);
  const normal = unit(cross(subtract(index, wrist), subtract(pinky, wrist)));
  if (Math.abs(normal[1]) < 0.9) return null;
  const tips = TIPS.slice(1).map((tip) => joints[tip]);
  const isFlat = tips.every((tip) => Math.abs(tip[1] - tips[0][1]) < FLAT_M && Math.abs(dot(subtract(tip, wrist), normal)) < 2.5 * FLAT_M);
  const isStretched = CHAINS.slice(1).every((chain) => {
    const bones = chain.slice(3).map((joint, at) => Math.hypot(...subtract(joints[joint], joints[chain[at + 2]])));
    const way = Math.hypot(...subtract(joints[chain.at(-1)], joints[chain[2]]));
    return way > STRETCHED * bones.reduce((sum, bone) => sum + bone, 0);
  });
  if (!isFlat || !isStretched) return null;
  return { height: middle(tips)[1], center: middle(tips), forward: subtract(joints[MIDDLE_KNUCKLE], wrist) };
}

/** Returns a vector or quaternion with the length 1. */
export function unit(v) {
  const length = Math.hypot(...v) || 1;
  return v.map((it) => it / length);
}

/** Returns the quaternion (x, y, z, w) of three axes. */
export function quaternionOf(x, y, z) {
  const trace = x[0] + y[1] + z[2];
  let q;
  if (trace > 0) q = [y[2] - z[1], z[0] - x[2], x[1] - y[0], 1 + trace];
  else if (x[0] > y[1] && x[0] > z[2]) q = [1 + x[0] - y[1] - z[2], y[0] + x[1], z[0] + x[2], y[2] - z[1]];
  else if (y[1] > z[2]) q = [y[0] + x[1], 1 - x[0] + y[1] - z[2], z[1] + y[2], z[0] - x[2]];
  else q = [z[0] + x[2], z[1] + y[2], 1 - x[0] - y[1] + z[2], x[1] - y[0]];
  return unit(q);
}

/** Returns the pose that applies `inner`, then `outer`. */
export function compose(outer, inner) {
  const [a, b] = [outer.slice(3), inner.slice(3)];
  const position = move(outer, inner);
  const vector = add(add(scale(b, a[3]), scale(a, b[3])), cross(a, b));
  return [...position, ...unit([...vector, a[3] * b[3] - dot(a, b)])];
}

/** Returns the pose that undoes a pose. */
export function inverse(pose) {
  const turned = [0, 0, 0, -pose[3], -pose[4], -pose[5], pose[6]];
  return [...scale(move(turned, pose), -1), ...turned.slice(3)];
}
