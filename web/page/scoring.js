// Simulated people type on a layout, on a thread of its own: it receives `{ people, layout }`, and sends the score after each person.
// Its module is loaded only here, and exports numbers only: see `crates/web/src/abi_score.rs`.

addEventListener("message", async ({ data: { people, layout } }) => {
  try {
    const { instance } = await WebAssembly.instantiateStreaming(fetch("score.wasm"), {});
    const { memory, score_input: input, score_output: output, score_begin: begin, score_next: next } = instance.exports;
    const taken = (length) => new TextDecoder().decode(new Uint8Array(memory.buffer, output(), length));
    const bytes = new TextEncoder().encode(layout);
    const at = input(bytes.length);
    if (at === 0) throw new Error("the layout is larger than 2 MiB");
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    const error = taken(begin(people, bytes.length));
    if (error) return postMessage({ error });
    for (;;) {
      const score = JSON.parse(taken(next()));
      postMessage(score ?? { isDone: true });
      if (score === null || score.error) return undefined;
    }
  } catch (error) {
    return postMessage({ error: `the score cannot be computed: ${error?.message ?? error}` });
  }
});
