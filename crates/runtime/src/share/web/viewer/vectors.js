// Vectors in metres, X to the right, Y up, -Z forward, and poses: [x, y, z, i, j, k, w].

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, t) => [a[0] * t, a[1] * t, a[2] * t];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const middle = (points) => scale(points.reduce(add, [0, 0, 0]), 1 / points.length);

export function rotate(pose, v) {
  const axis = [pose[3], pose[4], pose[5]];
  const t = scale(cross(axis, v), 2);
  return add(add(v, scale(t, pose[6])), cross(axis, t));
}

export const move = (pose, v) => add(pose, rotate(pose, v));
