// Loads the code for a headset where the browser reaches one, or where the link of a computer opened the page.

import { token } from "./token.js";

const MODES = ["immersive-vr", "immersive-ar"];

/** Returns the modes of WebXR that the browser supports. */
async function supportedModes() {
  const isSupported = await Promise.all(MODES.map((mode) => navigator.xr?.isSessionSupported(mode).catch(() => false)));
  return MODES.filter((_, index) => isSupported[index]);
}

/** Offers what the browser supports; returns the headset, or null if there is nothing to offer. `of` has the stages, and functions of the page. */
export async function offerHeadset(of) {
  const modes = await supportedModes();
  if (modes.length === 0 && !token) return null;
  const headset = await import("./headset.js");
  headset.offer(modes, of);
  return headset;
}
