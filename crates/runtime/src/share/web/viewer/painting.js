// The canvas, and shapes and colors on it.

export const canvas = document.getElementById("view");
export const context = canvas.getContext("2d");

/** The size of the font in which labels are written before they are laid on keys. */
export const FONT_PX = 100;

export function trace(points, isClosed) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  if (isClosed) context.closePath();
}

export function fill(points, color) {
  trace(points, true);
  context.fillStyle = color;
  context.fill();
}

export function stroke(points, isClosed, width, color) {
  trace(points, isClosed);
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}

/** Returns the convex hull of points on the screen (Andrew's monotone chain). */
export function hull(points) {
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

/** Returns a color between two, written as #rrggbb. */
export function mix(from, to, t) {
  if (t <= 0) return from;
  const channel = (color, index) => parseInt(color.slice(1 + 2 * index, 3 + 2 * index), 16);
  const mixed = [0, 1, 2].map((index) => Math.round(channel(from, index) * (1 - t) + channel(to, index) * t));
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

const COLOR_NAMES = [
  "board", "board-edge", "key", "key-side", "label", "lit", "lit-side", "lit-label",
  "skin", "skin-edge", "skin-light", "sleeve", "sleeve-edge", "shadow",
];

export function colorsOfTheme() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(COLOR_NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

const widths = new Map();

export function textWidth(text) {
  if (!widths.has(text)) widths.set(text, context.measureText(text).width);
  return widths.get(text);
}
