// Words are corrected as they are typed, and the candidates of the decoder are buttons. Module and language are loaded when a person asks
// for them.

import { isFull, loadFull } from "./full.js";

const element = (id) => document.getElementById(id);

let language = "";

async function loadLanguage(stages, name, isMeant) {
  const answer = await fetch(`${name}.adm`);
  if (!answer.ok) throw new Error(`${name}.adm: ${answer.status}`);
  const bytes = new Uint8Array(await answer.arrayBuffer());
  if (!isMeant()) return;
  const error = stages.useLanguage(bytes);
  if (error) throw new Error(error);
  language = name;
}

/** Corrects or suggests words as `choice` says: a mode and a language, or nothing. */
export async function correctWords(stages, choice, notify, open) {
  const [mode, name] = choice.split(" ");
  // A person may choose again while the files are loaded.
  const isMeant = () => element("words").value === choice;
  try {
    if (mode) await loadFull(stages, open);
    if (mode && name !== language) await loadLanguage(stages, name, isMeant);
    if (!isMeant()) return;
    if (isFull()) stages.setTextMode(mode || "literal");
    element("candidates").hidden = !mode;
    notify("");
  } catch (error) {
    if (!isMeant()) return;
    // The decoder of another language may be in use.
    if (isFull()) stages.setTextMode("literal");
    element("candidates").hidden = true;
    notify(`words are not corrected: ${error.message}`);
    element("words").value = "";
  }
}

/** Shows the words that may be meant as buttons; none in a layout without letters. */
export function showCandidates(stages, { mode, words }) {
  const row = element("candidates");
  row.hidden = mode === "literal" || (!mode && !element("words").value);
  const buttons = words.map((word, index) => {
    const button = document.createElement("button");
    [button.type, button.textContent] = ["button", word];
    button.addEventListener("click", () => stages.choose(index + 1));
    return button;
  });
  const focused = [...row.children].indexOf(document.activeElement);
  row.replaceChildren(...(mode ? buttons : ["This layout has too few letters to correct words."]));
  // A person who chooses words with the keyboard goes on from there.
  if (focused >= 0) (row.children[Math.min(focused, words.length - 1)] ?? row).focus();
}
