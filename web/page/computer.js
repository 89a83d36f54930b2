// The computer that serves the page with `ademan serve --lan`: it receives the hands, once it was shown the token of the link.

import { forgetToken, token } from "./token.js";

const FIRST_WAIT_MS = 1000;
const LONGEST_WAIT_MS = 10000;
/** Lines without hands are sent for so long: the computer releases the keys of hands that are gone, and then needs no more. */
const FAREWELL_MS = 500;
/** A line is left out while so many bytes wait: a late hand is worse than none. */
const MAX_WAITING_BYTES = 16384;

/** Returns the name of the headset, as the browser states it. */
function nameOfHeadset() {
  const words = /(Quest [\w ]+|Pico [\w ]+|Android XR|Vision Pro)/i.exec(navigator.userAgent);
  return (words?.[1] ?? navigator.userAgentData?.platform ?? "browser").trim().slice(0, 40);
}

/** Prepares the connection. `open` receives the layout of the computer. */
export function connectComputer(notify, open) {
  let [socket, state, wait, last, seenAt, isOpen, shown] = [null, "", FIRST_WAIT_MS, 0, -Infinity, false, null];

  const say = (text) => {
    state = text;
    const line = document.getElementById("computer");
    line.textContent = text;
    if (text) document.getElementById("headset").hidden = false;
  };

  const receivers = {
    welcome({ layout }) {
      wait = FIRST_WAIT_MS;
      isOpen = true;
      say("the hands move the pointer of the computer, and type once it allows keys");
      // The same layout again would put the boards back.
      if (layout && layout !== shown) open(layout);
      shown = layout;
    },
    busy: () => say("the computer reads another headset; trying again"),
  };

  function connect() {
    const own = new WebSocket(`wss://${location.host}/hands`);
    let [isRefused, isBusy] = [false, false];
    socket = own;
    own.onopen = () => own.send(JSON.stringify({ token, name: nameOfHeadset() }));
    own.onmessage = ({ data }) => {
      const message = JSON.parse(data);
      isRefused ||= message.kind === "refused";
      isBusy ||= message.kind === "busy";
      receivers[message.kind]?.(message);
    };
    own.onclose = () => {
      [socket, isOpen] = [null, false];
      if (isRefused) {
        forgetToken();
        say("the computer refuses this page: open the link that it shows now");
        notify(state);
        return;
      }
      if (!isBusy) say("not connected to the computer; trying again");
      setTimeout(connect, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  }

  return {
    start() {
      if (token && location.protocol === "https:") connect();
    },
    state: () => state,
    /** Sends the hands that are seen; without hands the keys are released. */
    send(hands) {
      if (!isOpen || socket?.readyState !== WebSocket.OPEN) return;
      const now = performance.now();
      if (hands.length > 0) seenAt = now;
      const isDue = hands.length > 0 ? socket.bufferedAmount < MAX_WAITING_BYTES : now - seenAt < FAREWELL_MS;
      if (!isDue) return;
      const time = Math.max(Math.round(now * 1000), last + 1);
      last = time;
      socket.send(JSON.stringify({ time_us: time, hands }));
    },
  };
}
