// The model that finds hands: a file beside the page, the one that was chosen before, or one that a person chooses.

import { MODEL } from "./features.js";

const FILE = "hand_landmarker.task";

/** The cache of the browser in which a chosen model stays. It has no version: the page may change without it. */
const CACHE = "hand-model";

/** The size of a model, in bytes: MediaPipe's has 7.8 MB. */
const SIZES = [1e5, 6e7];

/** Returns the reason why bytes are not a model: a model is an archive of two networks that are not compressed. */
function wrongModel(bytes) {
  const view = new Uint8Array(bytes, 0, Math.min(bytes.byteLength, 4));
  if (bytes.byteLength < SIZES[0] || bytes.byteLength > SIZES[1]) return "a hand model has another size";
  if (view[0] !== 0x50 || view[1] !== 0x4b) return "it is not a .task file";
  return null;
}

/** Returns the bytes of the model; null if a person has to choose one. */
export async function knownModel() {
  const kept = await globalThis.caches?.match(FILE, { cacheName: CACHE }).catch(() => undefined);
  if (kept) return kept.arrayBuffer();
  if (!MODEL) return null;
  const answer = await fetch(FILE);
  if (!answer.ok) return null;
  const bytes = await answer.arrayBuffer();
  return wrongModel(bytes) ? null : bytes;
}

/** Keeps a model that a person has chosen, and returns its bytes. Throws an error about one that is wrong. */
export async function chooseModel(file) {
  const bytes = await file.arrayBuffer();
  const wrong = wrongModel(bytes);
  if (wrong) throw new Error(`${file.name} is not used: ${wrong}`);
  try {
    const cache = await caches.open(CACHE);
    await cache.put(FILE, new Response(bytes));
  } catch {
    // Without room or in a private window, it is chosen again the next time.
  }
  return bytes;
}

/** Forgets a model that does not work. */
export const forgetModel = () => globalThis.caches?.delete(CACHE);
