// Recordings of `ademan record` move the hands on the layout with which they were made.

import { loadFull } from "./full.js";

/** Plays a recording. `open` gives the layout and the person to a module without them, and `openLayout` shows a layout. */
export async function playRecording(stages, file, { notify, open, openLayout, counted }) {
  try {
    await loadFull(stages, open);
    const { readings, layout, refused, error } = stages.playRecording(new Uint8Array(await file.arrayBuffer()));
    if (error) return notify(error);
    if (layout) openLayout(layout);
    notify(`${counted(readings)}${layout ? " on the layout of the recording" : ""}${refused ? `; the rest cannot be read: ${refused}` : ""}`);
  } catch (error) {
    notify(`recordings cannot be read: ${error.message}`);
  }
}
