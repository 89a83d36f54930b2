// The page: a layout, the hands over it, and what they type.

import { pass } from "./clock.js";
import "./completion.js";
import * as editor from "./editor.js";
import { layoutIn, linkTo } from "./fragment.js";
import { offerHeadset } from "./headset-offer.js";
import { clearScore, drawHeat, prepareScore } from "./heat.js";
import { followPointer } from "./pointing.js";
import { onChange, planPicture, showPlan, showPressed } from "./plan.js";
import { session } from "./session.js";
import { loadStages } from "./stages.js";
import { useNewest } from "./update.js";
import { redraw, show, view } from "./view.js";
import { isRunning, prepareWebcam, showHolding } from "./webcam.js";

const FIRST_LAYOUT = "qwerty-flat";
const MAX_EVENTS = 12;

const element = (id) => document.getElementById(id);
await useNewest();
const stages = await loadStages().catch((error) => {
  element("state").textContent = `not loaded: ${error.message}`;
  throw error;
});

// ---- The layout.

let sides = [];
let faultsShown = [];
/** The text of the last layout without faults. */
let valid = "";
/** The text that was opened or kept last. */
let kept = "";

/** Uses a layout if it has no faults; otherwise the last valid one stays. */
function useLayout(text) {
  clearScore();
  for (const message of stages.setLayout(text)) (receivers[message.kind] ?? show)(message);
  if (faultsShown.length === 0) valid = text;
}

/** Opens a layout: one that comes with the program if it has a name. */
function openLayout(text, name = "") {
  element("gallery-list").value = name;
  replaceLayout(text);
  keep();
}

/** Shows a change of the layout, which is not kept yet. */
function replaceLayout(text) {
  editor.setText(text);
  useLayout(text);
}

const keep = () => (kept = editor.text());

function openShipped(name) {
  history.replaceState(null, "", location.pathname + location.search);
  openLayout(stages.fileText(name), name);
}

async function openFragment() {
  try {
    const text = await layoutIn(location.hash);
    if (text === null) {
      notify("");
      return false;
    }
    openLayout(text);
    notify("this layout comes from the link");
    return true;
  } catch {
    notify("the layout in the link is damaged, or larger than 1 MiB; ask for the link again");
    return false;
  }
}

editor.onEdit(useLayout);
onChange((targets, edit) => {
  if (faultsShown.length > 0) {
    notify("correct the faults in the text first: the plan shows the last board without faults");
    return false;
  }
  const edited = stages.edit(targets, edit);
  if (edited.error) {
    notify(edited.error);
    return false;
  }
  replaceLayout(edited.text);
  return true;
});

// ---- The hands.

/** What was said last, and that there is a newer version of the page. */
let [said, newer] = ["", ""];

const notify = (text) => {
  said = text;
  element("notice").textContent = [said, newer].filter(Boolean).join("; ");
};

// A file of the newer version is needed: see `offline.js`.
navigator.serviceWorker?.addEventListener("message", ({ data }) => {
  newer = data;
  notify(said);
});

const sayFaults = (faults) => {
  notify(faults.map((it) => (it.line ? `line ${it.line}, column ${it.column}: ${it.message}` : it.message)).join("; "));
};

element("typing").addEventListener("submit", (event) => {
  event.preventDefault();
  sayFaults(stages.type(element("text-to-type").value));
});
element("scripting").addEventListener("submit", (event) => {
  event.preventDefault();
  sayFaults(stages.play(element("script").value));
});
element("recording").addEventListener("change", (event) => play(event.target.files[0]));
// The same file may be chosen again, to be played again, or because it was replaced on the disk.
for (const input of document.querySelectorAll("[type=file]")) input.addEventListener("click", () => (input.value = ""));
/** Returns true if text is dragged to a field, which takes it. A link that is dropped elsewhere would take the place of the page. */
const isOfField = ({ target, dataTransfer }) => target.matches?.(":read-write") && !dataTransfer.types.includes("Files");
addEventListener("dragover", (event) => isOfField(event) || event.preventDefault());
addEventListener("drop", (event) => {
  if (isOfField(event)) return;
  event.preventDefault();
  play(event.dataTransfer.files[0]);
});
element("stop").addEventListener("click", () => stages.release());
/** The text that was typed with the module before this one. */
let typedBefore = "";
element("clear").addEventListener("click", () => {
  stages.clearText();
  typedBefore = "";
  element("events").replaceChildren();
  notify("");
});
function choosePerson() {
  const name = element("person").value;
  sayFaults(stages.setPerson(name && stages.fileText(`persons/${name}`)));
}
// A browser restores what was chosen before the page was loaded again, without the person and the decoder.
for (const id of ["person", "words"]) element(id).value = "";
element("person").addEventListener("change", choosePerson);
element("words").addEventListener("change", async ({ target }) => {
  try {
    const { correctWords } = await import("./words.js");
    await correctWords(stages, target.value, notify, begin);
  } catch (error) {
    notify(`words are not corrected: ${error.message}`);
    target.value = "";
  }
});

/** Gives layout and person to a module without them. */
function begin() {
  typedBefore = element("typed").value;
  useLayout(valid);
  useLayout(editor.text());
  choosePerson();
}

const MAX_RECORDING_BYTES = 15e6;
const MAX_LAYOUT_BYTES = 1 << 20;

const counted = (readings) => `${readings} ${readings === 1 ? "reading" : "readings"}`;

/** Plays a recording, a motion capture file or one with lines of JSON, whose protocol the first line shows; a layout is opened. */
async function play(file) {
  if (!file) return;
  if (file.size > MAX_RECORDING_BYTES) return notify("the file is larger than 15 MB; cut it");
  try {
    if (file.name.endsWith(".mcap")) {
      const { playRecording } = await import("./recordings.js");
      return playRecording(stages, file, { notify, open: begin, openLayout, counted });
    }
    const text = await file.text();
    if (file.name.endsWith(".ron")) return file.size > MAX_LAYOUT_BYTES ? notify("the layout is larger than 1 MiB") : openLayout(text);
    const protocol = protocolOf(text);
    if (!protocol) return notify("the file is neither a recording (.mcap) nor motion capture (BVH) nor lines with hands of a headset or webcam; a layout ends with .ron");
    if (protocol.startsWith("bvh")) await (await import("./full.js")).loadFull(stages, begin);
    const { readings, refused, error } = stages.playFile(protocol, text);
    notify(error ?? `${counted(readings)} of ${protocol.split("?")[0]}${refused ? `; the rest cannot be read: ${refused}` : ""}`);
  } catch (error) {
    notify(`the file cannot be read: ${error.message}`);
  }
}

/** Returns the protocol of a file; undefined if it has no hands. */
function protocolOf(text) {
  if (/^\s*HIERARCHY\b/i.test(text)) return sides.every((side) => side === "left") ? "bvh?hand=left" : "bvh";
  for (const line of text.split("\n", 200)) {
    try {
      const [hand] = JSON.parse(line).hands ?? [];
      if (hand?.image || hand?.world) return "hand-landmarks";
      if (hand?.joints) return hand.joints.length === 26 ? "openxr" : "webxr";
    } catch {
      return undefined;
    }
  }
  return undefined;
}

let hand = "resting";
followPointer(
  ({ point, normal, travel, board }, isDown) => isRunning() || stages.point(sides[board] === "left", point, normal, travel, isDown),
  () => hand === "resting" || hand === "pointing",
);

// ---- What comes of them.

const receivers = {
  faults({ faults, plan }) {
    faultsShown = faults;
    editor.setFaults(faults);
    if (!plan) return;
    sides = plan.map((board) => board.side);
    showPlan(plan);
    measureSoon();
    drawHeat();
  },
  live: showHolding,
  session(message) {
    hand = message.hand;
    const field = element("typed");
    const text = typedBefore + message.text;
    if (field.value !== text) {
      field.value = text;
      field.scrollTop = field.scrollHeight;
    }
  },
  notice: (message) => notify(message.text),
  candidates: async (message) => (await import("./words.js")).showCandidates(stages, message),
  touches() {},
  events(message) {
    show(message);
    const { kind: _, time_us: time, event, ...rest } = message;
    const item = document.createElement("li");
    item.textContent = `${(time / 1e6).toFixed(3)}  ${event} ${Object.values(rest).join(" ")}`;
    const list = element("events");
    list.prepend(item);
    while (list.children.length > MAX_EVENTS) list.lastChild.remove();
  },
  scene(message) {
    show(message);
    showPressed(message.pressed);
  },
};

prepareScore(() => editor.text());
prepareWebcam(stages, () => (sides.includes("left") ? 2 : 1));

let measuring = 0;

/** Shows the time of a step soon: the shortest mean of five rehearsals of some seconds of typing. */
function measureSoon() {
  clearTimeout(measuring);
  measuring = setTimeout(() => {
    stages.prepareRehearsal();
    const times = Array.from({ length: 5 }, () => {
      const before = performance.now();
      const steps = stages.rehearse();
      return (1e3 * (performance.now() - before)) / steps;
    });
    element("latency").textContent = `${Math.min(...times).toFixed(1)} µs a step`;
  }, 700);
}

let lastFrame = performance.now();
let headset = null;

/** Moves the stages on: in the frames of the window, and in the frames of a headset. */
function advance(now) {
  const elapsed = Math.max(now - lastFrame, 0);
  lastFrame = Math.max(now, lastFrame);
  pass(elapsed);
  for (const message of stages.advance(elapsed)) {
    headset?.hear(message);
    (receivers[message.kind] ?? show)(message);
  }
}

function frame(now) {
  requestAnimationFrame(frame);
  advance(now);
}

const STATES = { starting: "ready", stalled: "ready" };
let shownKeys = "";
view.onDraw = () => {
  const state = STATES[session.state] ?? session.state;
  if (element("state").textContent !== state) element("state").textContent = state;
  element("state").className = state === "ready" ? "running" : session.state;
  const name = session.layout?.name ?? "";
  if (element("layout").textContent !== name) element("layout").textContent = name;
  const keys = session.keys.join(" ");
  if (keys === shownKeys) return;
  shownKeys = keys;
  element("keys").replaceChildren(...session.keys.map((key) => {
    const chip = document.createElement("kbd");
    chip.textContent = key;
    return chip;
  }));
};

// ---- Sharing and the gallery.

element("share").addEventListener("click", async () => {
  if (new Blob([editor.text()]).size > MAX_LAYOUT_BYTES) return notify("the layout is larger than 1 MiB; save it as a file");
  let link = "";
  try {
    link = await linkTo(editor.text());
    history.replaceState(null, "", link);
  } catch (error) {
    return notify(`there is no link: ${error.message}; save the layout as a file`);
  }
  keep();
  try {
    await navigator.clipboard.writeText(link);
    notify(`the link is copied (${link.length} characters); the layout is in it, nothing is stored elsewhere`);
  } catch {
    notify("the link is in the address bar");
  }
});
element("save").addEventListener("click", () => {
  keep();
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([editor.text()], { type: "text/plain" }));
  link.download = `${(session.layout?.name ?? "layout").toLowerCase().replaceAll(/[^a-z0-9]+/g, "-")}.ron`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
});

const names = stages.layoutNames();
element("gallery-list").append(...["", ...names].map((name) => {
  const option = document.createElement("option");
  [option.value, option.textContent] = [name, name || "your own"];
  return option;
}));
element("gallery-list").addEventListener("change", (event) => event.target.value && openShipped(event.target.value));
element("gallery").addEventListener("click", () => {
  const dialog = element("gallery-dialog");
  const cards = element("gallery-cards");
  if (cards.children.length === 0) cards.append(...names.map(card));
  dialog.showModal();
});

function card(name) {
  const { title, description, plan } = stages.preview(name);
  const button = document.createElement("button");
  button.type = "button";
  button.className = "card";
  button.dataset.name = name;
  const [heading, words] = [document.createElement("strong"), document.createElement("span")];
  [heading.textContent, words.textContent] = [title, description];
  const picture = planPicture(plan);
  picture.setAttribute("aria-hidden", "true");
  button.append(picture, heading, words);
  button.addEventListener("click", () => {
    element("gallery-dialog").close();
    openShipped(name);
  });
  return button;
}

addEventListener("hashchange", openFragment);
addEventListener("beforeunload", (event) => editor.text() !== kept && event.preventDefault());
if (!(await openFragment())) openShipped(FIRST_LAYOUT);
if (session.layout === null) {
  // The layout of the link has faults, which are shown over a board without faults.
  useLayout(stages.fileText(FIRST_LAYOUT));
  useLayout(editor.text());
}
requestAnimationFrame(frame);
offerHeadset({ stages, advance, notify, openLayout }).then((it) => (headset = it));
redraw();
document.documentElement.dataset.ready = "true";
navigator.serviceWorker?.register("offline.js").catch(() => {});
