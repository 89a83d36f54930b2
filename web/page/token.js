// The token of the link with which a computer opens the page in a headset.

const KEY = "ademan-token";

// It leaves the address bar at once; the tab keeps it until it is closed.
const found = /^#token=([0-9a-f]{64})$/.exec(location.hash)?.[1];
if (found) {
  sessionStorage.setItem(KEY, found);
  history.replaceState(null, "", location.pathname + location.search);
}
// Another link in the same tab changes the fragment only.
addEventListener("hashchange", () => location.hash.startsWith("#token=") && location.reload());

/** The token, or null. */
export const token = found ?? sessionStorage.getItem(KEY);

export const forgetToken = () => sessionStorage.removeItem(KEY);
