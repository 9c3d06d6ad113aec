// The secret of the server: comes for a ticket, and is kept for this tab alone.

// Of the tab and the origin, port included: servers on other ports do not see it, and it goes when the tab is closed.
const TOKEN = "raywarp-token";
const TICKET = "raywarp-ticket";

/// What this tab has to show: `{ token, ticket }`. What stands in the address is the newest; it does not stay there.
export function secret() {
  const told = readSecret(location.href);
  if (told) {
    keep(told);
    history.replaceState(history.state, "", location.pathname);
  }
  return { token: sessionStorage.getItem(TOKEN) ?? "", ticket: sessionStorage.getItem(TICKET) ?? "" };
}

/// Takes what somebody has typed: a secret, or an address that the server printed.
export function typedSecret(text) {
  keep(URL.canParse(text) ? readSecret(text) ?? { token: text } : { token: text });
}

/// The ticket was exchanged.
export function keepToken(token) {
  keep({ token });
}

export function forgetSecret() {
  sessionStorage.removeItem(TOKEN);
  sessionStorage.removeItem(TICKET);
}

function keep({ token, ticket }) {
  forgetSecret();
  if (token) sessionStorage.setItem(TOKEN, token);
  if (ticket) sessionStorage.setItem(TICKET, ticket);
}

/// What follows the `#` never leaves the browser; the query is for links that lost it.
function readSecret(text) {
  const address = new URL(text);
  const after = new URLSearchParams(address.hash.slice(1));
  const find = (name) => after.get(name) ?? address.searchParams.get(name);
  const [token, ticket] = [find("token"), find("ticket")];
  return token !== null || ticket !== null ? { token, ticket } : null;
}
