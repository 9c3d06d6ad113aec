// The secret of the server: taken out of the address, and kept for this tab alone.

// Of the tab and the origin, port included: servers on other ports do not see it, and it goes when the tab is closed.
const KEPT = "raywarp-token";

/// The secret that this tab knows. One in the address is the newest; it does not stay there.
export function secret() {
  const told = secretOf(new URL(location.href));
  if (told !== null) {
    keepSecret(told);
    history.replaceState(history.state, "", location.pathname);
  }
  return told ?? sessionStorage.getItem(KEPT) ?? "";
}

export function keepSecret(text) {
  sessionStorage.setItem(KEPT, text);
}

export function forgetSecret() {
  sessionStorage.removeItem(KEPT);
}

/// What follows the `#` never leaves the browser; the query is for links that lost it.
function secretOf(address) {
  const after = new URLSearchParams(address.hash.slice(1)).get("token");
  return after ?? address.searchParams.get("token");
}
