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
    if (message.event === "key-down") session.text += typed(message.key);
    session.text = [...session.text].slice(-48).join("");
  },
};

const SIGNS = { Space: " ", Enter: "⏎", Backspace: "⌫", Tab: "⇥", Escape: "⎋", Delete: "⌦" };
const SIGNS_OF_PUNCTUATION = {
  Comma: ",", Period: ".", Minus: "-", Equal: "=", Slash: "/", Semicolon: ";", Quote: "'", Backslash: "\\", Backquote: "`",
};

/** Returns what a key adds to the line of text. */
function typed(key) {
  if (key.length === 1) {
    return session.keys.some((it) => it.startsWith("Shift")) ? key : key.toLowerCase();
  }
  return SIGNS[key] ?? SIGNS_OF_PUNCTUATION[key] ?? "";
}

/** Takes a message into the state. */
export function receive(message) {
  receivers[message.kind]?.(message);
}
