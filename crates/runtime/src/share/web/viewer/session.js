// The state of the session, from its messages.

export const session = { layout: null, boards: [], state: "connecting", hands: {}, pressed: new Map(), keys: [], text: "" };

const receivers = {
  layout(message) {
    session.layout = message;
    session.boards = message.boards.map((board) => board.pose);
    session.pressed.clear();
  },
  scene(message) {
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
    if (message.state !== "running" && message.state !== "paused") session.hands = {};
  },
  pose(message) {
    session.hands[message.side] = message.positions;
  },
  events(message) {
    if (message.event === "character") session.text += message.character;
    if (message.event === "key-down") session.text = after(session.text, message.key);
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
  const isHeld = (name) => session.keys.some((it) => it.startsWith(name));
  if (["Control", "Alt", "Meta"].some(isHeld)) return text;
  if (key === "Backspace") return [...text].slice(0, -1).join("");
  const sign = SIGNS[key] ?? SIGNS_OF_PUNCTUATION[key] ?? (key.length === 1 ? key.toLowerCase() : "");
  if (!isHeld("Shift")) return text + sign;
  return text + (SHIFTED[PLAIN.indexOf(sign)] ?? sign.toUpperCase());
}

/** Takes a message into the state. */
export function receive(message) {
  receivers[message.kind]?.(message);
}
