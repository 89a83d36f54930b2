// Words are corrected as they are typed: a module with the text decoder takes the place of the one without it, and its candidates are
// buttons. Module and language are loaded when a person asks for them.

const element = (id) => document.getElementById(id);

let isLoaded = false;
let language = "";

/** Loads the module with the decoder, which begins without a layout: `open` gives it the layout and the person. */
async function loadModule(stages, open) {
  stages.release();
  await stages.load("words.wasm");
  isLoaded = true;
  open();
}

async function loadLanguage(stages, name) {
  const answer = await fetch(`${name}.adm`);
  if (!answer.ok) throw new Error(`${name}.adm: ${answer.status}`);
  const error = stages.useLanguage(new Uint8Array(await answer.arrayBuffer()));
  if (error) throw new Error(error);
  language = name;
}

/** Corrects or suggests words as `choice` says: a mode and a language, or nothing. */
export async function correctWords(stages, choice, notify, open) {
  const [mode, name] = choice.split(" ");
  try {
    if (mode && !isLoaded) await loadModule(stages, open);
    if (mode && name !== language) await loadLanguage(stages, name);
    if (isLoaded) stages.setTextMode(mode || "literal");
    element("candidates").hidden = !mode;
    notify("");
  } catch (error) {
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
  row.replaceChildren(...(mode ? buttons : ["This layout has too few letters to correct words."]));
}
