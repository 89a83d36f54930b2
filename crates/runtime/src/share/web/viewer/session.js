// The state of the session, from its messages.

export const session = { layout: null, boards: [], state: "connecting", hands: {}, pressed: new Map(), keys: [], text: "" };

/** Readings of two hands may be late by less: a scene that is earlier belongs to another session. */
const MAX_LATE_US = 1e6;

/** A hand without a pose for longer is lost, although the other hand is still seen. */
const MAX_UNSEEN_US = 5e5;

/** The time of the last scene. */
let timeUs = 0;
/** The time of the last pose of each hand. */
const seenUs = {};
/** The keys that are down, also those of events after the last scene. */
let held = new Set();

/** Forgets the hands, the keys and the text of a session before another one. */
export function restart() {
  Object.assign(session, { hands: {}, keys: [], text: "" });
  session.pressed.clear();
  held.clear();
}

const receivers = {
  layout(message) {
    session.layout = message;
    session.boards = message.boards.map((board) => board.pose);
    session.pressed.clear();
  },
  scene(message) {
    if (message.time_us < timeUs - MAX_LATE_US) restart();
    timeUs = message.time_us;
    session.state = message.state;
    message.boards.forEach((pose, index) => {
      if (pose) session.boards[index] = pose;
    });
    const now = performance.now();
    const pressed = new Set(message.pressed);
    for (const [id, light] of session.pressed) {
      if (!pressed.has(id) && light.releasedAt === null) light.releasedAt = now;
    }
    for (const id of pressed) session.pressed.set(id, { releasedAt: null });
    session.keys = message.keys;
    held = new Set(message.keys);
    if (message.state !== "running" && message.state !== "paused") session.hands = {};
    for (const side of Object.keys(session.hands)) {
      if (timeUs - seenUs[side] > MAX_UNSEEN_US) delete session.hands[side];
    }
  },
  pose(message) {
    session.hands[message.side] = message.positions;
    seenUs[message.side] = message.time_us;
  },
  events({ event, key, character }) {
    if (event === "character") session.text += character;
    if (event === "key-down") {
      session.text = after(session.text, key);
      held.add(key);
    }
    if (event === "key-up") held.delete(key);
    session.text = [...session.text].slice(-48).join("");
  },
};

const SIGNS = { Space: " ", Enter: "⏎", Tab: "⇥" };
const SIGNS_OF_PUNCTUATION = {
  Comma: ",", Period: ".", Minus: "-", Equal: "=", Slash: "/", Semicolon: ";", Quote: "'", Backslash: "\\", Backquote: "`",
  BracketLeft: "[", BracketRight: "]",
};
const PLAIN = "1234567890,.-=/;'\\`[]";
const SHIFTED = "!@#$%^&*()<>_+?:\"|~{}";

/** Returns the text after a key, on a US keymap. Shortcuts change nothing. */
function after(text, key) {
  const isHeld = (name) => [...held].some((it) => it.startsWith(name));
  if (["Control", "Alt", "Meta"].some(isHeld)) return text;
  if (key === "Backspace") return [...text].slice(0, -1).join("");
  const sign = SIGNS[key] ?? SIGNS_OF_PUNCTUATION[key] ?? (key.length === 1 ? key.toLowerCase() : "");
  if (!sign || !isHeld("Shift")) return text + sign;
  return text + (SHIFTED[PLAIN.indexOf(sign)] ?? sign.toUpperCase());
}

/** Takes a message into the state. */
export function receive(message) {
  receivers[message.kind]?.(message);
}
