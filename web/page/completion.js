// The list of names below the cursor of the text editor.
//
// The focus stays in the text, as a screen reader expects of a text field with a list: `aria-activedescendant` names the chosen one.

import { offersOf } from "./offers.js";

const MAX_SHOWN = 60;

const editor = document.getElementById("editor");
const list = document.getElementById("completion");
const about = document.getElementById("completion-about");
const status = document.getElementById("completion-status");

let offersAt = null;
let loading = null;
let shown = null;
let chosen = 0;

/** Loads the schema when the editor is used for the first time. */
async function load() {
  loading ??= fetch("layout.schema.json").then((answer) => answer.json());
  try {
    offersAt ??= offersOf(await loading);
  } catch {
    // It is tried again at the next use.
    loading = null;
  }
}

/** Shows the names that may stand at the cursor. Without `isAsked`, only once a letter of one is typed. */
function offer(isAsked) {
  // The names may have been loaded when a person was somewhere else already.
  if (document.activeElement !== editor) return;
  const { selectionStart, selectionEnd, value } = editor;
  const found = offersAt && selectionStart === selectionEnd ? offersAt(value, selectionStart) : null;
  if (!found || found.offers.length === 0 || (!isAsked && found.prefix === "")) {
    if (isAsked && offersAt) status.textContent = "no names here";
    return close();
  }
  shown = { ...found, offers: found.offers.slice(0, MAX_SHOWN) };
  list.replaceChildren(...shown.offers.map((it, index) => {
    const item = document.createElement("li");
    item.id = `completion-${index}`;
    item.setAttribute("role", "option");
    item.textContent = it.name;
    // The mouse must not take the focus from the text.
    item.addEventListener("mousedown", (event) => event.preventDefault());
    item.addEventListener("click", () => accept(index));
    return item;
  }));
  const box = list.parentElement;
  box.hidden = false;
  choose(0);
  place(box);
  editor.setAttribute("aria-controls", list.id);
  const count = shown.offers.length;
  status.textContent = `${count} ${count === 1 ? "name" : "names"}; Tab or Enter accepts, Escape closes`;
}

function close() {
  if (!shown) return;
  shown = null;
  list.parentElement.hidden = true;
  list.replaceChildren();
  editor.removeAttribute("aria-activedescendant");
  editor.removeAttribute("aria-controls");
  status.textContent = "";
}

function choose(index) {
  chosen = index;
  [...list.children].forEach((item, at) => item.setAttribute("aria-selected", String(at === chosen)));
  const item = list.children[chosen];
  editor.setAttribute("aria-activedescendant", item.id);
  item.scrollIntoView({ block: "nearest" });
  about.textContent = shown.offers[chosen].about;
}

function accept(index) {
  const { insert, back = 0, isField } = shown.offers[index];
  const { from, to } = shown;
  close();
  editor.focus();
  editor.setSelectionRange(from, to);
  // This keeps the undo list of the browser, and fires `input`.
  if (!document.execCommand("insertText", false, insert)) {
    editor.setRangeText(insert, from, to, "end");
    editor.dispatchEvent(new Event("input"));
  }
  const cursor = from + insert.length - back;
  editor.setSelectionRange(cursor, cursor);
  if (isField || back) offer(true);
  else close();
}

/** Places the box below the cursor, or above it if there is no room. */
function place(box) {
  const style = getComputedStyle(editor);
  const context = document.createElement("canvas").getContext("2d");
  context.font = style.font;
  const before = editor.value.slice(0, shown.from);
  const line = before.slice(before.lastIndexOf("\n") + 1);
  const row = before.split("\n").length - 1;
  const height = parseFloat(style.lineHeight);
  const field = editor.getBoundingClientRect();
  const left = field.left + parseFloat(style.paddingLeft) + context.measureText(line).width - editor.scrollLeft;
  const top = field.top + parseFloat(style.paddingTop) + row * height - editor.scrollTop;
  const own = box.getBoundingClientRect();
  const isAbove = top + height + own.height > innerHeight && top > own.height;
  box.style.left = `${Math.max(8, Math.min(left, document.documentElement.clientWidth - own.width - 8))}px`;
  box.style.top = `${isAbove ? top - own.height : top + height}px`;
}

editor.addEventListener("focus", load);
editor.addEventListener("input", (event) => {
  // Names that a drag in the plan or an undo writes are no typing.
  if (!event.inputType?.startsWith("insert") && !event.inputType?.startsWith("delete")) close();
  else if (offersAt) offer(false);
  else load().then(() => offer(false));
});
editor.addEventListener("blur", close);
editor.addEventListener("scroll", close);
editor.addEventListener("pointerdown", close);
addEventListener("resize", close);
editor.addEventListener("keydown", (event) => {
  if (event.isComposing) return;
  if (event.key === " " && event.ctrlKey) {
    event.preventDefault();
    load().then(() => offer(true));
    return;
  }
  if (!shown || event.ctrlKey || event.altKey || event.metaKey) return;
  const last = shown.offers.length - 1;
  const steps = { ArrowDown: chosen === last ? 0 : chosen + 1, ArrowUp: chosen === 0 ? last : chosen - 1, PageDown: Math.min(chosen + 8, last), PageUp: Math.max(chosen - 8, 0) };
  if (event.key in steps) choose(steps[event.key]);
  else if (event.key === "Enter" || (event.key === "Tab" && !event.shiftKey)) accept(chosen);
  else if (event.key === "Escape") close();
  else {
    if (["ArrowLeft", "ArrowRight", "Home", "End"].includes(event.key)) close();
    return;
  }
  event.preventDefault();
});
