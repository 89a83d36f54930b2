// The module that corrects words and reads recordings, too. It takes the place of the first one when a person asks for either.

let isLoaded = false;

/** Whether the module is in use. */
export const isFull = () => isLoaded;

/** Loads the module, which begins without a layout: `open` gives it the layout and the person. */
export async function loadFull(stages, open) {
  if (isLoaded) return;
  stages.release();
  await stages.load("full.wasm");
  isLoaded = true;
  open();
}
