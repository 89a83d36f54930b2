// Layouts in the fragment of a link: `#layout=`, then the text compressed as raw DEFLATE in base64url. A browser sends a fragment
// to no server.

/** The largest layout that a link may carry, in bytes: as for a file. */
const MAX_BYTES = 1 << 20;

/** Returns the link to a layout. */
export async function linkTo(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  const base64 = btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return `${location.origin}${location.pathname}#layout=${base64}`;
}

/** Returns the layout in a fragment; null if there is none. Throws an error about one that is wrong. */
export async function layoutIn(fragment) {
  const encoded = /^#layout=(.*)/.exec(fragment)?.[1];
  if (encoded === undefined) return null;
  const binary = atob(encoded.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (char) => char.charCodeAt(0));
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const parts = [];
  let size = 0;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > MAX_BYTES) {
      reader.cancel();
      throw new Error("too large");
    }
    parts.push(value);
  }
  return new TextDecoder("utf-8", { fatal: true }).decode(await new Blob(parts).arrayBuffer());
}
