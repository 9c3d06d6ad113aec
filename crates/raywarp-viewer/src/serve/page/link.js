// The WebSocket: says hello, keeps trying, and tells apart why it was closed. See the server's `protocol`.

import { forgetSecret, keepToken, secret, typedSecret } from "./secret.js";

const PROTOCOL = 1;
const TOKEN = 4001;
const FULL = 4002;
const VERSION = 4003;
const FIRST_WAIT = 250;
const LONGEST_WAIT = 5000;
// Beyond so many bytes that the network has not taken, moves of the pointer are left out.
const BEHIND = 64 * 1024;

/// A connection that comes back by itself. `on` has: hello, text, binary, size (gives [width, height]), state (what to
/// show, or nothing once all is well), token (asks for another one).
export class Link {
  constructor(on) {
    this.on = on;
    this.wait = FIRST_WAIT;
    this.words = "";
    // An address that differs only behind the `#` does not load the page again.
    addEventListener("hashchange", () => this.connect());
    this.connect();
  }

  connect() {
    clearTimeout(this.timer);
    this.leave();
    this.words = "";
    const address = new URL("live", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.search = address.hash = "";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      const [width, height] = this.on.size();
      this.send({ type: "hello", protocol: PROTOCOL, ...secret(), width, height });
    };
    socket.onmessage = (message) => this.take(message.data);
    socket.onclose = (event) => this.closed(event);
    this.socket = socket;
    this.greeted = false;
  }

  /// Ends the connection before this one; nobody hears of it.
  leave() {
    if (!this.socket) return;
    this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
    this.socket.close();
  }

  take(data) {
    if (typeof data !== "string") return this.on.binary(data);
    const message = JSON.parse(data);
    if (message.type === "hello") return this.hello(message);
    if (message.type === "end") {
      this.words = message.text;
      return undefined;
    }
    return this.on.text(message);
  }

  hello(message) {
    if (message.protocol !== PROTOCOL) return this.reload(message.protocol);
    sessionStorage.removeItem("raywarp-reloaded");
    if (message.token) keepToken(message.token);
    this.greeted = true;
    this.wait = FIRST_WAIT;
    this.on.hello(message);
    return this.on.state("open", "");
  }

  /// A page from before an update: the new one comes with the server. Once, as a proxy may keep the old one.
  reload(protocol) {
    this.old = true;
    const done = sessionStorage.getItem("raywarp-reloaded") === String(protocol);
    this.on.state("old", "This page is older than the server: reload it.");
    if (done) return;
    sessionStorage.setItem("raywarp-reloaded", String(protocol));
    location.reload();
  }

  closed(event) {
    this.greeted = false;
    if (this.old || event.code === VERSION) return;
    const words = this.words || event.reason;
    if (event.code === TOKEN) {
      forgetSecret();
      this.on.state("refused", words);
      this.on.token(words);
      return;
    }
    const wait = event.code === FULL ? LONGEST_WAIT : this.wait;
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    const why = words ? ` (${words})` : "";
    const state = event.code === FULL ? "full" : "lost";
    const sentence = state === "full" ? words : `Connection lost${why}. Trying again.`;
    this.on.state(state, sentence);
    this.timer = setTimeout(() => this.connect(), wait);
  }

  /// Tries another secret.
  open(text) {
    typedSecret(text);
    this.connect();
  }

  get isOpen() {
    return this.greeted && this.socket.readyState === WebSocket.OPEN;
  }

  get isBehind() {
    return this.socket.bufferedAmount > BEHIND;
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
