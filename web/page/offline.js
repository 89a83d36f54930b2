// Keeps the files of the page, so that it opens without a network after the first visit. `web/build` fills in the two lines below.

const VERSION = "VERSION";
const FILES = ["FILES"];

self.addEventListener("install", (event) => {
  event.waitUntil(
    caches.open(VERSION)
      .then((cache) => cache.addAll(FILES.map((file) => new Request(file, { cache: "reload" }))))
      .then(() => self.skipWaiting()),
  );
});

self.addEventListener("activate", (event) => {
  const isOld = (name) => name.startsWith("ademan-") && name !== VERSION;
  event.waitUntil(
    caches.keys()
      .then((names) => Promise.all(names.filter(isOld).map((name) => caches.delete(name))))
      .then(() => self.clients.claim()),
  );
});

/** Loads a file, and keeps it if it is one that is loaded on demand: what few visitors use is large. */
async function load(request) {
  const answer = await fetch(request);
  if (answer.ok && /\/(vision_|hand_landmarker|(score|full|words|recordings|e[ns])\.)/.test(new URL(request.url).pathname)) {
    await caches.open(VERSION).then((cache) => cache.put(request, answer.clone())).catch(() => {});
  }
  return answer;
}

self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || new URL(event.request.url).origin !== location.origin) return;
  const wanted = event.request.mode === "navigate" ? "./" : event.request;
  // A browser whose storage is damaged or full gets the file from the server.
  const kept = caches.match(wanted, { cacheName: VERSION, ignoreSearch: true }).catch(() => null);
  event.respondWith(kept.then((it) => it ?? load(event.request)));
});
