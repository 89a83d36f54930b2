// Keeps the files of the page, so that it opens without a network after the first visit, and gives each page the files of one version: of
// the one with which it was opened. `web/build` fills in the two lines below.

const VERSION = "VERSION";
const FILES = ["FILES"];

const NEWER = "the server has another version of this page: load the page again";

/** Returns the name of a file of the page; a path if it is not beside this one. */
const nameOf = (url) => new URL(url).pathname.replace(new URL("./", location).pathname, "");

/** Returns whether the server still has this version of the page. */
const isCurrent = async () => (await (await fetch("offline.js", { cache: "no-store" })).text()).includes(`"${VERSION}"`);

async function keep() {
  const cache = await caches.open(VERSION);
  await cache.addAll(FILES.map((file) => new Request(file, { cache: "reload" })));
  // Files that were replaced while they were loaded would be of two versions.
  if (!(await isCurrent())) throw new Error(NEWER);
}

// Pages of the version before keep the worker of that version: this one begins when they are closed, or when `update.js` asks for it.
self.addEventListener("install", (event) => event.waitUntil(keep()));

async function begin() {
  const old = (await caches.keys()).filter((name) => name.startsWith("ademan-") && name !== VERSION);
  await Promise.all(old.map((name) => caches.delete(name)));
  // The page of the first visit is of this version. An open page without a worker may be of another one.
  if (old.length === 0) await clients.claim();
}

self.addEventListener("activate", (event) => event.waitUntil(begin()));

/** Begins at once if one page is open only. Returns whether it does. */
async function beginAlone() {
  const open = await clients.matchAll({ includeUncontrolled: true, type: "window" });
  const isAlone = open.filter(({ url }) => url.startsWith(registration.scope)).length === 1;
  if (isAlone) self.skipWaiting();
  return isAlone;
}

self.addEventListener("message", (event) => event.waitUntil(beginAlone().then((isBegun) => event.ports[0].postMessage(isBegun))));

/** Tells the open pages that there is a newer version, whose file they do not get. */
async function refuse() {
  for (const page of await clients.matchAll()) page.postMessage(NEWER);
  return Response.error();
}

/** Loads a file, and keeps it if it is one that is loaded on demand: what few visitors use is large. */
async function load(request) {
  const isOnDemand = /^(vision_|hand_landmarker|(score|full|words|recordings|e[ns])\.)[^/]*$/.test(nameOf(request.url));
  // Without the kept files the page comes from the server, too.
  if (isOnDemand && (await caches.has(VERSION).catch(() => false)) && !(await isCurrent())) return refuse();
  const answer = await fetch(request);
  if (answer.ok && isOnDemand) {
    await caches.open(VERSION).then((cache) => cache.put(request, answer.clone())).catch(() => {});
  }
  return answer;
}

self.addEventListener("fetch", (event) => {
  const { method, mode, url } = event.request;
  if (method !== "GET" || new URL(url).origin !== location.origin) return;
  const isPage = ["", "index.html"].includes(nameOf(url));
  // A site may have other pages, and the licence of MediaPipe is one.
  if (mode === "navigate" && !isPage) return;
  const wanted = isPage ? "./" : event.request;
  // A browser whose storage is damaged or full gets the file from the server.
  const kept = caches.match(wanted, { cacheName: VERSION, ignoreSearch: true }).catch(() => null);
  event.respondWith(kept.then((it) => it ?? load(event.request)));
});
