// The stages in WebAssembly, behind functions with texts. The module exports numbers only: see `crates/web/src/abi.rs`.

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** Loads the module, and returns its functions. */
export async function loadStages() {
  let memory, exports;
  const load = async (file) => {
    const { instance } = await WebAssembly.instantiateStreaming(fetch(file), {});
    ({ memory, ...exports } = instance.exports);
  };
  await load("ademan.wasm");

  /** Writes a text or bytes into the input, and returns the length. */
  const put = (input) => {
    const bytes = typeof input === "string" ? encoder.encode(input) : input;
    const at = exports.page_input(bytes.length);
    if (at === 0) throw new Error("the text is larger than 16 MiB");
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    return bytes.length;
  };
  const taken = (length) => decoder.decode(new Uint8Array(memory.buffer, exports.page_output(), length));
  const lines = (length) => taken(length).split("\n").filter(Boolean).map((line) => JSON.parse(line));
  const json = (length) => JSON.parse(taken(length) || "null");

  return {
    /** Exchanges the module for one that does more, without a layout. */
    load,
    useLanguage: (bytes) => taken(exports.page_use_language(put(bytes))),
    setTextMode: (mode) => exports.page_set_text_mode(put(mode)),
    choose: (number) => exports.page_choose(number),
    layoutNames: () => json(exports.page_shipped()),
    fileText: (name) => taken(exports.page_shipped_text(put(name))),
    preview: (name) => json(exports.page_preview(put(name))),
    setLayout: (text) => lines(exports.page_set_layout(put(text))),
    type: (text) => json(exports.page_type(put(text))) ?? [],
    play: (script) => json(exports.page_play(put(script))) ?? [],
    setPerson: (text) => json(exports.page_set_person(put(text))) ?? [],
    push: (protocol, text) => json(exports.page_push(put(`${protocol}\n${text}`))),
    playFile: (protocol, text) => json(exports.page_play_file(put(`${protocol}\n${text}`))),
    playRecording: (bytes) => json(exports.page_play_recording(put(bytes))),
    pushLive: (format, text) => json(exports.page_push_live(put(`${format}\n${text}`))),
    placeUnderHands: () => exports.page_place_under_hands(),
    edit: (targets, edit) => json(exports.page_edit(put(JSON.stringify({ targets, edit })))),
    point: (isLeft, [x, y, z], [i, j, k], travel, isDown) => exports.page_point(isLeft, x, y, z, i, j, k, travel, isDown),
    release: () => exports.page_release(),
    clearText: () => exports.page_clear_text(),
    prepareRehearsal: () => exports.page_prepare_rehearsal(),
    rehearse: () => exports.page_rehearse(),
    advance: (ms) => lines(exports.page_advance(ms)),
  };
}
