// The score of the layout: figures, and a map of the keys that are missed.

const PEOPLE = 8;

/** The part of missed strokes that has the strongest color. */
const HOTTEST = 0.3;

/** Keys with fewer strokes show nothing: one miss of two is no sign. */
const MIN_STROKES = 5;

const MAX_LISTED = 6;

const element = (id) => document.getElementById(id);

let layoutText = () => "";
let worker = null;
let shown = null;

/** Prepares the panel. `text` returns the layout. */
export function prepareScore(text) {
  layoutText = text;
  element("score-start").addEventListener("click", () => (worker ? end("stopped") : start()));
  element("score-clear").addEventListener("click", clearScore);
}

function start() {
  clearScore();
  worker = new Worker("scoring.js", { type: "module" });
  // A message of a worker that was ended may still wait.
  worker.addEventListener("message", ({ data, target }) => target === worker && receive(data));
  worker.addEventListener("error", (event) => end(`the score cannot be computed: ${event.message || "its files cannot be loaded"}`));
  worker.postMessage({ people: PEOPLE, layout: layoutText() });
  element("score-start").textContent = "Stop";
  element("score-progress").hidden = false;
  element("score-progress").value = 0;
  element("score-text").textContent = "simulated people begin to type";
}

function end(text) {
  worker?.terminate();
  worker = null;
  element("score-start").textContent = "Score this layout";
  element("score-progress").hidden = true;
  if (text) element("score-text").textContent = text;
}

/** Removes a score: another layout has another one. */
export function clearScore() {
  end("");
  shown = null;
  element("score-text").textContent = "";
  element("score-keys").replaceChildren();
  if (document.activeElement === element("score-clear")) element("score-start").focus();
  element("score-clear").hidden = true;
  drawHeat();
}

function receive(score) {
  if (score.error) return end(score.error);
  if (score.isDone) return end("");
  shown = score;
  element("score-clear").hidden = false;
  element("score-progress").value = score.people / score.of;
  element("score-text").textContent = sentence(score);
  const keys = Object.entries(score.keys).map(([name, key]) => ({ name, ...key, missed: missed(key) }));
  const worst = keys.filter((it) => it.missed > 0).sort((a, b) => b.missed - a.missed).slice(0, MAX_LISTED);
  element("score-keys").replaceChildren(...worst.map(({ name, meant, nothing, hit, missed: part }) => {
    const item = document.createElement("li");
    item.textContent = `${name}: ${percent(part)} of ${meant} missed, ${meant - hit - nothing} on another key, ${nothing} on none`;
    return item;
  }));
  drawHeat();
}

const percent = (part) => `${(100 * part).toFixed(part < 0.1 ? 1 : 0)} %`;

/** Returns the part of the strokes that missed a key; 0 if there are too few. */
const missed = ({ meant, hit }) => (meant >= MIN_STROKES ? 1 - hit / meant : 0);

function sentence({ people, of, errors, wpm, untypable, tasks }) {
  const who = people < of ? `${people} of ${of} people` : `${of} simulated people`;
  if (tasks[1] > 0) return `${who}: ${tasks[0]} of ${tasks[1]} tasks are done.`;
  const parts = [`${who}: ${percent(errors[0])} wrong characters (${percent(errors[1])} to ${percent(errors[2])})`, `${wpm[0].toFixed(0)} words a minute (${wpm[1].toFixed(0)} to ${wpm[2].toFixed(0)})`];
  return `${parts.join(", ")}.${untypable ? ` Not typable: ${untypable}` : ""}`;
}

/** Colors the keys of the plan, which may just have been drawn. */
export function drawHeat() {
  for (const key of document.querySelectorAll("#plan .plan-key")) {
    const counts = shown?.keys[key.dataset.name];
    key.querySelector(".heat-number")?.remove();
    const label = key.querySelector("text");
    label.removeAttribute("y");
    key.classList.toggle("is-heated", Boolean(counts && counts.meant >= MIN_STROKES));
    key.removeAttribute("aria-description");
    if (!counts || counts.meant < MIN_STROKES) continue;
    const part = missed(counts);
    key.style.setProperty("--heat", `${Math.round(100 * Math.min(part / HOTTEST, 1))}%`);
    key.setAttribute("aria-description", `${percent(part)} of ${counts.meant} strokes miss it`);
    const number = document.createElementNS("http://www.w3.org/2000/svg", "text");
    number.setAttribute("class", "heat-number");
    const box = key.querySelector("rect, ellipse");
    const half = box.tagName === "ellipse" ? Number(box.getAttribute("ry")) : box.getAttribute("height") / 2;
    label.setAttribute("y", String(-half * 0.22));
    number.setAttribute("y", String(half * 0.62));
    number.setAttribute("font-size", String(Math.min(half * 0.55, 5)));
    number.textContent = Math.round(100 * part);
    key.append(number);
  }
}
