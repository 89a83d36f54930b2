// The time of the stages, in milliseconds.

/** The stages make one step in this time; a longer gap than the second one is skipped (crates/web). */
const PERIOD_MS = 10;
const MAX_ELAPSED_MS = 100;

let [time, rest] = [0, 0];

/** Counts the time for which the stages were moved on. */
export function pass(elapsed) {
  rest = Math.min(rest + elapsed, MAX_ELAPSED_MS);
  const steps = Math.floor(rest / PERIOD_MS);
  rest -= steps * PERIOD_MS;
  time += steps * PERIOD_MS;
}

/** Returns the time of the stages, with what was passed of the next step. */
export const stagesTime = () => time + rest;
