// Shows the hands of a session over its boards.

import { restart, session } from "./session.js";
import { redraw, show, view } from "./view.js";

// ---- The connection, which is opened again whenever it is lost.

const KINDS = ["layout", "scene", "pose", "events"];
let retryMs = 500;

function connect() {
  const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
  socket.onopen = () => {
    retryMs = 500;
    socket.send(JSON.stringify({ kinds: KINDS, rate_hz: 60 }));
    restart();
    session.state = "connected";
    redraw();
  };
  socket.onmessage = (event) => {
    show(JSON.parse(event.data));
  };
  socket.onclose = () => {
    session.state = "lost";
    session.hands = {};
    session.keys = [];
    session.pressed.clear();
    redraw();
    setTimeout(connect, retryMs);
    retryMs = Math.min(retryMs * 2, 5000);
  };
}

const element = (id) => document.getElementById(id);
let shownKeys = "";

view.onDraw = function showWords() {
  const words = { lost: "not connected", connected: "waiting for the hand" };
  setText("state", words[session.state] ?? session.state);
  element("state").className = session.state;
  setText("layout", session.layout?.name ?? "");
  setText("text", session.text);
  const keys = session.keys.join(" ");
  if (keys !== shownKeys) {
    shownKeys = keys;
    element("keys").replaceChildren(...session.keys.map((key) => {
      const chip = document.createElement("kbd");
      chip.textContent = key;
      return chip;
    }));
  }
};

function setText(id, text) {
  if (element(id).textContent !== text) element(id).textContent = text;
}

connect();
redraw();
