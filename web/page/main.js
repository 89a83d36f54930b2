// The page: a layout, the hands over it, and what they type.

import * as editor from "./editor.js";
import { layoutIn, linkTo } from "./fragment.js";
import { followPointer } from "./pointing.js";
import { onChange, planPicture, showPlan, showPressed } from "./plan.js";
import { session } from "./session.js";
import { loadStages } from "./stages.js";
import { redraw, show, view } from "./view.js";

const FIRST_LAYOUT = "qwerty-flat";
const MAX_EVENTS = 12;

const element = (id) => document.getElementById(id);
const stages = await loadStages();

// ---- The layout.

let sides = [];
let faultsShown = [];

/** Uses a layout if it has no faults; otherwise the last valid one stays. */
function useLayout(text) {
  for (const message of stages.setLayout(text)) {
    if (message.kind === "faults") {
      faultsShown = message.faults;
      editor.setFaults(message.faults);
      if (message.plan) {
        sides = message.plan.map((board) => board.side);
        showPlan(message.plan);
      }
    } else {
      (receivers[message.kind] ?? show)(message);
    }
  }
}

function openLayout(text) {
  editor.setText(text);
  useLayout(text);
}

function openShipped(name) {
  element("gallery-list").value = name;
  history.replaceState(null, "", location.pathname + location.search);
  openLayout(stages.fileText(name));
}

async function openFragment() {
  try {
    const text = await layoutIn(location.hash);
    if (text === null) return false;
    element("gallery-list").value = "";
    openLayout(text);
    notify("this layout comes from the link");
    return true;
  } catch (error) {
    notify(`the layout in the link cannot be read: ${error.message}; ask for the link again`);
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
  openLayout(edited.text);
  return true;
});

// ---- The hands.

const notify = (text) => {
  element("notice").textContent = text;
};

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
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  play(event.dataTransfer.files[0]);
});
element("stop").addEventListener("click", () => stages.release());
element("clear").addEventListener("click", () => {
  stages.clearText();
  element("events").replaceChildren();
  notify("");
});
element("person").addEventListener("change", (event) => {
  const name = event.target.value;
  sayFaults(stages.setPerson(name && stages.fileText(`persons/${name}`)));
});

const MAX_RECORDING_BYTES = 15e6;

/** Plays a file with lines of JSON, whose protocol the first line shows; a layout is opened. */
async function play(file) {
  if (!file) return;
  if (file.size > MAX_RECORDING_BYTES) return notify("the file is larger than 15 MB; cut it");
  const text = await file.text();
  if (file.name.endsWith(".ron")) return openLayout(text);
  const protocol = protocolOf(text);
  if (!protocol) return notify("the file has no lines with hands of a headset or webcam; a layout ends with .ron");
  const { readings, error } = stages.push(protocol, text);
  notify(error ?? `${readings} readings of ${protocol}`);
}

/** Returns the protocol of lines of JSON; undefined if they have no hands. */
function protocolOf(text) {
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
  ({ point, normal, travel, board }, isDown) => stages.point(sides[board] === "left", point, normal, travel, isDown),
  () => hand === "resting" || hand === "pointing",
);

// ---- What comes of them.

const receivers = {
  session(message) {
    hand = message.hand;
    const field = element("typed");
    if (field.value !== message.text) {
      field.value = message.text;
      field.scrollTop = field.scrollHeight;
    }
  },
  notice: (message) => notify(message.text),
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

let steps = 0;
let measured = { ms: 0, steps: 0, count: 0 };

/** Shows the mean time of a step about twice a second: a browser rounds what one step takes. */
function measure(ms, allSteps) {
  measured.ms += ms;
  measured.steps += allSteps - steps;
  measured.count += 1;
  steps = allSteps;
  if (measured.count < 30) return;
  if (measured.steps > 0) element("latency").textContent = `${Math.round((1e3 * measured.ms) / measured.steps)} µs a step`;
  measured = { ms: 0, steps: 0, count: 0 };
}

let lastFrame = performance.now();

function frame(now) {
  requestAnimationFrame(frame);
  const before = performance.now();
  const messages = stages.advance(Math.max(now - lastFrame, 0));
  const ms = performance.now() - before;
  lastFrame = now;
  for (const message of messages) {
    (receivers[message.kind] ?? show)(message);
    if (message.kind === "session") measure(ms, message.steps);
  }
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
  const link = await linkTo(editor.text());
  history.replaceState(null, "", link);
  try {
    await navigator.clipboard.writeText(link);
    notify(`the link is copied (${link.length} characters); the layout is in it, nothing is stored elsewhere`);
  } catch {
    notify("the link is in the address bar");
  }
});
element("save").addEventListener("click", () => {
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
if (!(await openFragment())) openShipped(FIRST_LAYOUT);
if (session.layout === null) openShipped(FIRST_LAYOUT);
requestAnimationFrame(frame);
redraw();
document.documentElement.dataset.ready = "true";
navigator.serviceWorker?.register("offline.js").catch(() => {});
