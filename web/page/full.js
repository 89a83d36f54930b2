// The module that corrects words and reads recordings and motion capture files, too. It takes the place of the first one when a person asks for either.

let isLoaded = false;
let loading = null;

/** Returns true if the module is in use. */
export const isFull = () => isLoaded;

async function load(stages, open) {
  stages.release();
  await stages.load("full.wasm");
  isLoaded = true;
  open();
}

/** Loads the module once, which begins without a layout: `open` gives it the layout and the person. */
export function loadFull(stages, open) {
  // A second one would take the place of the first one, with its language.
  loading ??= load(stages, open).catch((error) => {
    loading = null;
    throw error;
  });
  return loading;
}
