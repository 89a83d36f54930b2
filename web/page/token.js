// The token of the link with which a computer opens the page in a headset.

const KEY = "ademan-token";

// It leaves the address bar at once; the tab keeps it until it is closed.
const found = /^#token=([0-9a-f]{64})$/.exec(location.hash)?.[1];
if (found) history.replaceState(null, "", location.pathname + location.search);

let kept = null;
try {
  if (found) sessionStorage.setItem(KEY, found);
  kept = sessionStorage.getItem(KEY);
} catch {
  // Without room, or where the browser keeps nothing of sites, it lasts until the page is loaded again.
}
// Another link in the same tab changes the fragment only.
addEventListener("hashchange", () => location.hash.startsWith("#token=") && location.reload());

/** The token, or null. */
export const token = found ?? kept;

export const forgetToken = () => kept && sessionStorage.removeItem(KEY);
