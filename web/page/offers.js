// The names that may stand at a position of a layout, from the JSON Schema of layout files.
//
// The text before the position is read up to the bracket in which the position lies; the schema is followed along the same way.

const TOKEN = /\/\/[^\n]*(?:\n|$)|\/\*[^]*?(?:\*\/|$)|"(?:\\.|[^"\\])*(?:"|$)|[-\w.]+|[([{}\])]|[:,]/g;

/** Returns the tokens of a text, and whether a comment is open at its end. */
function tokensOf(text) {
  const tokens = [];
  for (const { 0: token, index } of text.matchAll(TOKEN)) {
    const isComment = token.startsWith("//") || token.startsWith("/*");
    const isOpen = isComment && index + token.length === text.length && !/(\n|\*\/)$/.test(token);
    if (isOpen) return { tokens, inComment: true };
    if (!isComment) tokens.push({ token, index });
  }
  return { tokens, inComment: false };
}

const isQuoted = (token) => token.startsWith('"');
const isWord = (token) => /^[-\w.]/.test(token);
const content = (token) => (isQuoted(token) ? token.slice(1).replace(/"$/, "") : token);

/** Returns the brackets around the end of a text: each with the name before it, and the field or index of the value in it. */
function bracketsAround(tokens) {
  const frames = [{ bracket: "", name: null, key: null, index: 0, keys: [] }];
  let last = null;
  for (const { token } of tokens) {
    const frame = frames.at(-1);
    if ("([{".includes(token)) {
      const name = token === "(" && last !== null && isWord(last) ? last : null;
      frames.push({ bracket: token, name, key: null, index: 0, keys: [] });
    } else if (")]}".includes(token)) {
      if (frames.length > 1) frames.pop();
    } else if (token === ":") {
      frame.key = last === null ? null : content(last);
      frame.keys.push(frame.key);
    } else if (token === ",") {
      frame.key = null;
      frame.index += 1;
    }
    last = token;
  }
  return frames;
}

/** Returns the keys that are written after a position, in the bracket around it. */
function keysAfter(text) {
  const keys = [];
  let depth = 0;
  let last = null;
  for (const { token } of tokensOf(text).tokens) {
    if ("([{".includes(token)) depth += 1;
    else if (")]}".includes(token)) depth -= 1;
    else if (token === ":" && depth === 0 && last !== null) keys.push(content(last));
    if (depth < 0) break;
    last = token;
  }
  return keys;
}

/** Returns a reader of a JSON Schema of a format of files. */
export function offersOf(schema) {
  const resolve = (it) => {
    const name = it?.$ref?.slice("#/$defs/".length);
    return name === undefined ? it : { ...schema.$defs[name], ...(it.description ? { description: it.description } : {}) };
  };

  /** Returns what stands in the bracket of a value: fields, parts or entries. */
  function inside(valueSchema, { bracket, name }) {
    const value = resolve(valueSchema);
    if (!value) return null;
    if (bracket === "[") return { each: value.items };
    if (bracket === "{") return { each: value.additionalProperties, names: value.propertyNames?.enum ?? [] };
    if (name === "Some") return { parts: [value] };
    if (value.oneOf) {
      const found = value.oneOf.find((it) => it.properties?.[name])?.properties[name];
      if (!found) return null;
      if (found.properties) return { fields: found.properties };
      return { parts: found.prefixItems ?? [found] };
    }
    if (value.properties) return { fields: value.properties };
    return { parts: value.prefixItems ?? [] };
  }

  /** Returns the schema of the value at the field or index of a bracket. */
  function valueIn(within, { key, index }) {
    if (!within) return null;
    if (within.fields) return key === null ? null : within.fields[key];
    return within.each ?? within.parts?.[index] ?? null;
  }

  /** Returns the values of a schema that have names. */
  function values(valueSchema) {
    const value = resolve(valueSchema);
    if (!value) return [];
    const about = value.description ?? "";
    if (value.type === "boolean") return ["false", "true"].map((name) => ({ name, insert: name, about }));
    if (value.enum) {
      return value.enum.map((name) => ({ name, insert: value.quoted ? `"${name}"` : name, about, isQuoted: value.quoted === true }));
    }
    return (value.oneOf ?? []).map((it) => {
      if (it.const) return { name: it.const, insert: it.const, about: it.description ?? "" };
      const [name] = Object.keys(it.properties);
      return { name, insert: `${name}()`, back: 1, about: it.description ?? "" };
    });
  }

  /**
   * Returns the names that may stand at a position of a text, and the range that the chosen one replaces:
   * `{ from, to, prefix, offers: [{ name, insert, back, about }] }`; `back` is the distance of the cursor from the end.
   */
  return (text, position) => {
    const { tokens, inComment } = tokensOf(text.slice(0, position));
    const none = { from: position, to: position, prefix: "", offers: [] };
    if (inComment) return none;
    const last = tokens.at(-1);
    const isAtEnd = last && last.index + last.token.length === position;
    const inQuotes = Boolean(isAtEnd && isQuoted(last.token) && (last.token.length === 1 || !last.token.endsWith('"')));
    const inWord = Boolean(isAtEnd && isWord(last.token));
    const typed = inQuotes || inWord ? last : null;
    if (typed) tokens.pop();
    const before = tokens.at(-1)?.token;
    // Between two values without a comma, nothing may stand.
    if (before !== undefined && !"([{:,".includes(before)) return none;

    const frames = bracketsAround(tokens);
    let [within, value] = [null, schema];
    frames.slice(1).forEach((frame, index) => {
      if (index > 0) value = valueIn(within, frames[index]);
      within = inside(value, frame);
    });
    const frame = frames.at(-1);
    // What is written in the place of a value is replaced; before a field, another one may be written.
    const isValue = frame.key !== null || frame.bracket === "[";
    const rest = typed || isValue ? text.slice(position).match(inQuotes ? /^[^"\n]*"?/ : /^[-\w.]*/)[0] : "";
    const isNumber = inWord && /^[-\d.]/.test(last.token);
    if (!within || isNumber) return none;
    const prefix = typed ? content(typed.token) : "";
    const range = { from: typed ? typed.index : position, to: position + rest.length, prefix };
    const after = text.slice(range.to);

    let offers;
    if (frame.key === null && within.fields && frame.bracket === "(") {
      const written = new Set([...frame.keys, ...keysAfter(after)]);
      const colon = /^\s*:/.test(after) ? "" : ": ";
      const names = Object.keys(within.fields).filter((name) => !written.has(name));
      offers = names.map((name) => ({ name, insert: name + colon, about: resolve(within.fields[name]).description ?? "", isField: true }));
    } else if (frame.key === null && frame.bracket === "{") {
      offers = within.names.filter((name) => !frame.keys.includes(name)).map((name) => ({ name, insert: `"${name}": `, about: "", isQuoted: true }));
    } else {
      offers = values(valueIn(within, frame));
    }
    // Inside of quotes only names in quotes may stand.
    offers = offers.filter((it) => !inQuotes || it.isQuoted);
    const wanted = prefix.toLowerCase();
    const begins = offers.filter((it) => it.name.toLowerCase().startsWith(wanted));
    const contains = offers.filter((it) => !begins.includes(it) && wanted.length > 1 && it.name.toLowerCase().includes(wanted));
    offers = [...begins, ...contains];
    if (offers.length === 1 && offers[0].name === prefix && !offers[0].back) offers = [];
    return { ...range, offers };
  };
}
