// Exchanges the page for a newer version, which the browser has loaded in the background, before a person has done anything in it.

/** Longest waits for the answer of the newer version, and for its begin, in milliseconds. */
const ANSWER_MS = 2000;
const BEGIN_MS = 5000;

/** Loads the page again if a newer version waits and no other tab shows this one. Returns once the page goes on. */
export async function useNewest() {
  const { serviceWorker } = navigator;
  if (!serviceWorker?.controller) return;
  // The files of the other version would not fit the ones that are loaded.
  serviceWorker.addEventListener("controllerchange", () => location.reload());
  const registration = await serviceWorker.getRegistration().catch(() => null);
  if (!registration?.waiting) return;
  const { port1, port2 } = new MessageChannel();
  const answer = new Promise((done) => {
    port1.onmessage = ({ data }) => done(data);
    setTimeout(done, ANSWER_MS, false);
  });
  registration.waiting.postMessage("begin", [port2]);
  if (await answer) await new Promise((done) => setTimeout(done, BEGIN_MS));
}
