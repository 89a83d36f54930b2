// Finds hands in images, on a thread of its own: MediaPipe needs 20 to 200 ms for an image.
//
// It receives `{ model }`, the bytes of a hand model, once, and then `{ image, time, most }` again and again; `image` is an ImageBitmap,
// and `most` the number of hands: while fewer are seen, each image is searched for another one, which takes half of the time.
// It sends `{ kind: "ready" }`, `{ kind: "hands", time, size, hands, ms, luminance }` for each image, or `{ kind: "failed", error }`.

import { HandLandmarker } from "./vision_bundle.mjs";

const FILES = { wasmLoaderPath: "vision_wasm_module_internal.js", wasmBinaryPath: "vision_wasm_module_internal.wasm" };

/** The size to which an image is reduced for its mean luminance. */
const SMALL = [32, 24];
const small = new OffscreenCanvas(...SMALL).getContext("2d", { willReadFrequently: true });

let landmarker = null;
let mostHands = 2;

async function start(model) {
  const files = Object.fromEntries(Object.entries(FILES).map(([name, file]) => [name, new URL(file, import.meta.url).href]));
  landmarker = await HandLandmarker.createFromOptions(files, {
    numHands: mostHands,
    runningMode: "VIDEO",
    canvas: new OffscreenCanvas(1, 1),
    baseOptions: { modelAssetBuffer: new Uint8Array(model), delegate: "CPU" },
  });
  postMessage({ kind: "ready" });
}

/** Returns the mean luminance of an image, 0 to 255 (ITU-R BT.601). */
function luminanceOf(image) {
  small.drawImage(image, 0, 0, ...SMALL);
  const { data } = small.getImageData(0, 0, ...SMALL);
  let sum = 0;
  for (let at = 0; at < data.length; at += 4) sum += 0.299 * data[at] + 0.587 * data[at + 1] + 0.114 * data[at + 2];
  return sum / (SMALL[0] * SMALL[1]);
}

const numbers = (points) => points.map(({ x, y, z }) => [x, y, z]);

async function find(image, time, most) {
  if (most !== mostHands) {
    mostHands = most;
    await landmarker.setOptions({ numHands: most });
  }
  const before = performance.now();
  const found = landmarker.detectForVideo(image, time);
  const ms = performance.now() - before;
  const hands = found.landmarks.map((points, index) => ({
    label: found.handedness[index][0].categoryName,
    score: found.handedness[index][0].score,
    image: numbers(points),
    world: numbers(found.worldLandmarks[index]),
  }));
  const [size, luminance] = [[image.width, image.height], luminanceOf(image)];
  image.close();
  postMessage({ kind: "hands", time, size, hands, ms, luminance });
}

addEventListener("message", async ({ data: { model, image, time, most } }) => {
  try {
    if (model) await start(model);
    else await find(image, time, most);
  } catch (error) {
    postMessage({ kind: "failed", error: String(error?.message ?? error) });
  }
});
