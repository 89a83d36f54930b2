// The click of a key at press and release, and the pulse of a controller.

let context = null;

/** Prepares the sound. A browser permits it after a click only. */
export function prepareSound() {
  context ??= new AudioContext();
  return context.resume();
}

/** Stops the sound. */
export function stopSound() {
  context?.suspend();
}

/** Plays a click: higher and louder for a press than for a release. */
export function click(isPress) {
  if (context?.state !== "running") return;
  const now = context.currentTime;
  const [oscillator, gain] = [context.createOscillator(), context.createGain()];
  oscillator.type = "triangle";
  oscillator.frequency.setValueAtTime(isPress ? 1500 : 900, now);
  oscillator.frequency.exponentialRampToValueAtTime(isPress ? 320 : 260, now + 0.03);
  gain.gain.setValueAtTime(isPress ? 0.3 : 0.14, now);
  gain.gain.exponentialRampToValueAtTime(0.001, now + 0.05);
  oscillator.connect(gain).connect(context.destination);
  oscillator.start(now);
  oscillator.stop(now + 0.06);
}

/** Gives a pulse where the hand has a motor. */
export function pulse(source) {
  source?.gamepad?.hapticActuators?.[0]?.pulse(0.4, 12);
}
