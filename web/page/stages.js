// The stages in WebAssembly, behind functions with texts. The module exports numbers only: see `crates/web/src/abi.rs`.

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** Loads the module, and returns its functions. */
export async function loadStages() {
  const { instance } = await WebAssembly.instantiateStreaming(fetch("ademan.wasm"), {});
  const { memory, ...exports } = instance.exports;

  /** Writes a text into the input, and returns its length. */
  const put = (text) => {
    const bytes = encoder.encode(text);
    const at = exports.page_input(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    return bytes.length;
  };
  const taken = (length) => decoder.decode(new Uint8Array(memory.buffer, exports.page_output(), length));
  const lines = (length) => taken(length).split("\n").filter(Boolean).map((line) => JSON.parse(line));
  const json = (length) => JSON.parse(taken(length) || "null");

  return {
    layoutNames: () => json(exports.page_shipped()),
    fileText: (name) => taken(exports.page_shipped_text(put(name))),
    preview: (name) => json(exports.page_preview(put(name))),
    setLayout: (text) => lines(exports.page_set_layout(put(text))),
    type: (text) => json(exports.page_type(put(text))) ?? [],
    play: (script) => json(exports.page_play(put(script))) ?? [],
    setPerson: (text) => json(exports.page_set_person(put(text))) ?? [],
    push: (protocol, text) => json(exports.page_push(put(`${protocol}\n${text}`))),
    edit: (targets, edit) => json(exports.page_edit(put(JSON.stringify({ targets, edit })))),
    point: (isLeft, [x, y, z], [i, j, k], travel, isDown) => exports.page_point(isLeft, x, y, z, i, j, k, travel, isDown),
    release: () => exports.page_release(),
    clearText: () => exports.page_clear_text(),
    advance: (ms) => lines(exports.page_advance(ms)),
  };
}
