// The connection to the run: what comes, and what is asked for. It is taken up again when it breaks.

import { decode } from "./frames.js";

export class Link {
  constructor(take) {
    this.take = take;         // {scene, moment, notices, world, open, closed}
    this.tries = 0;
    this.connect();
  }

  connect() {
    const address = new URL("socket", document.baseURI);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.tries = 0; this.take.open(); };
    socket.onmessage = ({ data }) => this.#message(data);
    socket.onclose = ({ code, reason }) => {
      this.take.closed(reason);
      if (code === 1008 || this.tries > 4) return;
      this.tries += 1;
      setTimeout(() => this.connect(), 1000 * this.tries);
    };
    this.socket = socket;
  }

  #message(data) {
    if (typeof data === "string") {
      for (const [what, told] of Object.entries(JSON.parse(data))) this.take[what]?.(told);
      return;
    }
    const message = decode(data);
    this.take[message.kind](message);
  }

  ask(what) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(what));
  }
}
