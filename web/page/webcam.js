// A webcam as glove: its images go to `landmarks.js`, the hands found in them to the stages.

import { VISION } from "./features.js";
import { chooseModel, forgetModel, knownModel } from "./model.js";

/** The size that is asked of the camera, and the width to which its images are reduced. */
const WIDTH = 640;
const HEIGHT = 480;

/** Mean luminance beyond which hands are found badly, 0 to 255. */
const DARK = 55;
const BRIGHT = 215;

/** Time without an answer after which something is wrong, in milliseconds: the first image takes seconds. */
const TIMEOUT_MS = 15000;

/** The landmarks that are joined by lines. */
const CHAINS = [[0, 1, 2, 3, 4], [0, 5, 6, 7, 8], [5, 9, 10, 11, 12], [9, 13, 14, 15, 16], [13, 17, 18, 19, 20], [0, 17]];

const element = (id) => document.getElementById(id);
const panel = element("webcam");
const video = element("webcam-video");
const picture = element("webcam-picture");
const context = picture.getContext("2d");

const REASONS = {
  NotAllowedError: "the browser does not let the page use the camera; allow it beside the address",
  NotFoundError: "there is no camera; connect one",
  NotReadableError: "the camera is used by another program; close it there",
  OverconstrainedError: "the chosen camera is gone; choose another one",
};

let stages = null;
let mostHands = () => 2;
let running = null;
let frames = [];

/** The start that waits for the model or the camera: a person may stop it, or leave the page, before the browser answers. */
let waiting = null;

/** Returns whether the webcam moves the hands. */
export const isRunning = () => running !== null;

/** Returns whether the webcam runs, or will do so when the browser answers. */
const isWanted = () => isRunning() || waiting !== null;

/** Shows a text. A screen reader would read the same text again. */
const put = (id, text) => {
  if (element(id).textContent !== text) element(id).textContent = text;
};

const say = (text) => put("webcam-status", text);

/** Begins or ends to wait for the browser. The button stays enabled, or it would lose the keyboard focus. */
function waitFor(own) {
  waiting = own;
  element("webcam-start").setAttribute("aria-disabled", String(own !== null));
}

const end = (stream) => {
  for (const track of stream.getTracks()) track.stop();
};

const format = () => {
  const [place, mirrored] = [element("webcam-place").value, element("webcam-mirrored").checked ? "yes" : "no"];
  return `hand-landmarks?camera=${place}&mirrored=${mirrored}`;
};

async function start(bytes) {
  stop("");
  const own = {};
  waitFor(own);
  try {
    const model = bytes ?? (await knownModel());
    if (own !== waiting) return;
    if (!model) {
      element("webcam-model").hidden = false;
      element("webcam-file").focus();
      return say("choose the file of the hand model first");
    }
    if (!navigator.mediaDevices) return say("browsers give a camera only to pages that were loaded by https or from 127.0.0.1");
    say("waiting for the camera");
    const chosen = element("webcam-camera").value;
    const device = chosen ? { deviceId: { exact: chosen } } : { facingMode: "user" };
    const wanted = { ...device, width: { ideal: WIDTH }, height: { ideal: HEIGHT }, frameRate: { ideal: 60 } };
    const stream = await navigator.mediaDevices.getUserMedia({ video: wanted });
    if (own === waiting) await run(stream, model);
    else end(stream);
  } catch (error) {
    if (own === waiting) stop(REASONS[error.name] ?? `the camera does not start: ${error.message}`);
  } finally {
    if (own === waiting) waitFor(null);
  }
}

async function run(stream, model) {
  const worker = new Worker("landmarks.js", { type: "module" });
  running = { stream, worker, isReady: false, isBusy: false, asked: performance.now(), watch: 0 };
  const own = running;
  worker.addEventListener("message", ({ data }) => own === running && receivers[data.kind](data));
  worker.addEventListener("error", (event) => own === running && receivers.failed({ error: event.message || "its files cannot be loaded" }));
  worker.postMessage({ model });
  const [track] = stream.getVideoTracks();
  track.addEventListener("ended", () => own === running && stop("the camera was disconnected"));
  video.srcObject = stream;
  const isFocused = document.activeElement === element("webcam-start");
  panel.classList.add("is-running");
  if (isFocused) element("webcam-stop").focus();
  say("loading MediaPipe");
  await video.play();
  if (own !== running) return;
  listCameras(track.getSettings().deviceId);
  frames = [];
  own.watch = setInterval(check, 500);
  next(own);
}

/** Stops the camera: its light goes off, and all keys are released. */
export function stop(text = "the camera is off") {
  const own = running;
  running = null;
  waitFor(null);
  if (own) {
    end(own.stream);
    own.worker.terminate();
    clearInterval(own.watch);
    video.srcObject = null;
    stages.release();
    showHolding({ holding: null, advice: null, is_placed: false });
  }
  const isFocused = document.activeElement?.classList.contains("while-running");
  panel.classList.remove("is-running");
  if (isFocused) element("webcam-start").focus();
  put("webcam-numbers", "");
  put("webcam-hint", "");
  context.clearRect(0, 0, picture.width, picture.height);
  say(text);
}

/** Sends the next image, unless the one before it is still looked at. */
function next(own) {
  const wait = video.requestVideoFrameCallback ? (call) => video.requestVideoFrameCallback(call) : requestAnimationFrame;
  wait(async () => {
    if (own !== running) return;
    next(own);
    if (!own.isReady || own.isBusy || video.videoWidth === 0) return;
    own.isBusy = true;
    own.asked = performance.now();
    const size = { resizeWidth: Math.min(WIDTH, video.videoWidth), resizeQuality: "low" };
    const image = await createImageBitmap(video, size).catch(() => null);
    if (image && own === running) own.worker.postMessage({ image, time: own.asked, most: mostHands() }, [image]);
    else own.isBusy = false;
  });
}

/** Says that the finder of hands hangs. Its keys are released by then. */
function check() {
  if (running && (running.isBusy || !running.isReady) && performance.now() - running.asked > TIMEOUT_MS) {
    running.asked = performance.now();
    // The next hand takes the message back.
    running.wasSeen = false;
    say("MediaPipe does not answer; this may be a slow machine, or stop and start the camera");
  }
}

const receivers = {
  ready() {
    running.isReady = true;
    say("show your hand to the camera");
  },
  failed({ error }) {
    forgetModel();
    element("webcam-model").hidden = false;
    stop(`hands cannot be found: ${error}; choose another model, or reload the page`);
  },
  hands({ time, size, hands, ms, luminance }) {
    running.isBusy = false;
    const line = JSON.stringify({ time_us: Math.round(time * 1000), image_size: size, hands });
    const { error, refused } = stages.pushLive(format(), `${line}\n`);
    const now = performance.now();
    frames = [...frames.filter((it) => now - it < 2000), now];
    const rate = frames.length > 1 ? (1000 * (frames.length - 1)) / (now - frames[0]) : 0;
    const scores = hands.map(({ label, score }) => `${shownSide(label)} hand ${Math.round(score * 100)} %`);
    element("webcam-numbers").textContent = [scores.join(", ") || "no hand", `${rate.toFixed(0)} images/s`, `${ms.toFixed(0)} ms each`].join(" · ");
    put("webcam-hint", error ?? hintOf(hands, luminance, refused));
    if (hands.length > 0 && !running.wasSeen) {
      running.wasSeen = true;
      say("hands are followed; put the board under your fingers");
    }
    draw(size, hands);
  },
};

/** A label names the hand of an image that is not mirrored. */
function shownSide(label) {
  const isLeft = (label === "Left") !== element("webcam-mirrored").checked;
  return isLeft ? "left" : "right";
}

function hintOf(hands, luminance, refused) {
  if (luminance < DARK) return "It is too dark: turn on a light in front of you.";
  if (luminance > BRIGHT) return "It is too bright: turn away from the window or lamp.";
  if (refused?.includes("bend backwards")) return "The fingers seem to bend backwards: change “The image is mirrored”.";
  if (refused) return refused;
  if (hands.some(({ score }) => score < 0.7)) return "The hand is hard to see: more light from the front and a plain background help.";
  if (hands.some(({ image }) => image.some(([x, y]) => x < 0 || x > 1 || y < 0 || y > 1))) return "A part of the hand is out of the picture.";
  return "";
}

/** Draws the landmarks over the picture of the camera. */
function draw([width, height], hands) {
  if (picture.width !== width || picture.height !== height) [picture.width, picture.height] = [width, height];
  context.clearRect(0, 0, width, height);
  context.lineWidth = 3;
  const style = getComputedStyle(panel);
  context.strokeStyle = style.getPropertyValue("--lit") || "orange";
  context.fillStyle = style.getPropertyValue("--skin-light") || "white";
  for (const { image } of hands) {
    context.beginPath();
    for (const chain of CHAINS) chain.forEach((at, index) => context[index ? "lineTo" : "moveTo"](image[at][0] * width, image[at][1] * height));
    context.stroke();
    for (const [x, y] of image) {
      context.beginPath();
      context.arc(x * width, y * height, 4, 0, 7);
      context.fill();
    }
  }
}

async function listCameras(used) {
  const devices = await navigator.mediaDevices.enumerateDevices();
  const cameras = devices.filter((it) => it.kind === "videoinput");
  const list = element("webcam-camera");
  // A camera of the list may be unplugged, and another one connected that is not in it.
  list.replaceChildren(new Option("any", ""), ...cameras.map(({ deviceId, label }, index) => new Option(label || `camera ${index + 1}`, deviceId)));
  if (used) list.value = used;
}

/** Shows the state of the boards: `holding` in percent, the advice, and whether they are under the hands. */
export function showHolding({ holding, advice, is_placed: isPlaced }) {
  const progress = element("webcam-progress");
  progress.hidden = holding === null;
  progress.value = holding ?? 0;
  put("webcam-advice", advice ?? (isPlaced ? "the boards are under your hands" : ""));
}

/** Prepares the panel. `handsOfLayout` returns the number of hands that the layout is for. */
export function prepareWebcam(stagesOfPage, handsOfLayout) {
  stages = stagesOfPage;
  mostHands = handsOfLayout;
  if (VISION) {
    element("webcam-start").disabled = true;
    return say(VISION);
  }
  element("webcam-start").addEventListener("click", () => waiting === null && start());
  element("webcam-stop").addEventListener("click", () => stop());
  element("webcam-place-boards").addEventListener("click", () => stages.placeUnderHands());
  element("webcam-camera").addEventListener("change", () => isRunning() && start());
  const mirror = element("webcam-mirror");
  mirror.checked = true;
  mirror.addEventListener("change", () => panel.classList.toggle("is-mirrored", mirror.checked));
  element("webcam-file").addEventListener("change", async (event) => {
    const [file] = event.target.files;
    if (!file) return;
    try {
      const bytes = await chooseModel(file);
      const isFocused = document.activeElement === event.target;
      element("webcam-model").hidden = true;
      if (isFocused) element("webcam-start").focus();
      await start(bytes);
    } catch (error) {
      say(error.message);
    }
  });
  // Whoever types by something else, or looks at another page, is not filmed.
  for (const id of ["typing", "scripting"]) element(id).addEventListener("submit", () => isWanted() && stop(), { capture: true });
  for (const id of ["stop", "enter-vr", "enter-ar"]) element(id).addEventListener("click", () => isWanted() && stop());
  element("recording").addEventListener("change", () => isWanted() && stop());
  addEventListener("drop", ({ dataTransfer }) => isWanted() && [...dataTransfer.files].some((it) => !it.name.endsWith(".ron")) && stop());
  document.addEventListener("visibilitychange", () => document.hidden && isWanted() && stop("the camera was stopped because the page was hidden"));
  addEventListener("pagehide", () => isWanted() && stop());
}
