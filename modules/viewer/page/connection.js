// SPDX-License-Identifier: BSD-3-Clause
// A client of Foxglove's WebSocket protocol, like any other viewer.

const SUBPROTOCOL = "foxglove.websocket.v1";
const RETRY_MS = 1000;
// A live server sends its own STATUS every second, one that plays a recording the time 50 times a second.
const SECOND_MS = 1000;
const SILENT_S = 5;
const MAX_SILENT_S = 40;
const LONG_LIFE_S = 60;
// The first byte of a binary frame, from the server and from us.
const MESSAGE_DATA = 1;
const TIME = 2;
const SERVICE_REQUEST = 2;
const SERVICE_RESPONSE = 3;

/** The token in an address; null if there is none. */
export function tokenIn(hash) {
  return new URLSearchParams(hash.slice(1)).get("token");
}

/**
 * Subscribes to every topic of the server that the page came from, and connects again when the connection is lost, or brings nothing: after a
 * radio link was away for long, a browser keeps a connection of which the server knows nothing any more.
 * handlers: open(serverInfo), services(), close(), tokenRefused(), message(topic, read, timeS), time(timeS), parameters(map).
 * `read()` returns the message; a message that is never read is never decoded.
 */
export class Connection {
  constructor(handlers) {
    this.handlers = handlers;
    // After '#', so that browsers do not send it; only the WebSocket gets it.
    this.token = tokenIn(location.hash);
    this.decoder = new TextDecoder();
    this.maxSilentS = SILENT_S;
    this.connect();
    setInterval(() => this.watch(), SECOND_MS);
  }

  connect() {
    clearTimeout(this.retry);
    this.openS = this.silentS = 0;  // counted in calls of watch(), so that a page that is busy or suspended finds no silence
    const query = this.token ? `?token=${encodeURIComponent(this.token)}` : "";
    this.topics = new Map();    // by subscription id
    this.services = new Map();  // ids by name
    this.calls = new Map();     // functions that take the answer, by call id
    this.nextCall = 1;
    const scheme = location.protocol === "https:" ? "wss" : "ws";  // a proxy may do TLS
    this.socket = new WebSocket(`${scheme}://${location.host}/${query}`, [SUBPROTOCOL]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = (event) => {
      this.silentS = 0;
      if (typeof event.data === "string") {
        this.onText(JSON.parse(event.data));
      } else {
        this.onBinary(new DataView(event.data));
      }
    };
    let opened = false;
    this.socket.onopen = () => { opened = true; };
    this.socket.onclose = () => {
      if (this.token && !opened) {
        this.askWhetherRefused();
      }
      this.end();
      this.retry = setTimeout(() => this.connect(), RETRY_MS);
    };
  }

  end() {
    this.calls.forEach((done) => done({ok: false, isLost: true, text: "No answer: the connection was lost."}));
    this.calls.clear();
    this.handlers.close();
  }

  /** Gives up the present connection for a new one. */
  renew() {
    this.socket.onmessage = this.socket.onopen = this.socket.onclose = null;
    this.socket.close();
    this.end();
    this.connect();
  }

  /** Once a second. No message arrives while a large one is on a slow link: therefore connections that soon end in silence are given more time. */
  watch() {
    const isOpen = this.socket.readyState === WebSocket.OPEN;
    this.openS += isOpen ? 1 : 0;
    this.silentS += 1;
    if (this.silentS > (isOpen ? this.maxSilentS : SILENT_S)) {
      if (isOpen) {
        this.maxSilentS = this.openS > LONG_LIFE_S ? SILENT_S : Math.min(2 * this.maxSilentS, MAX_SILENT_S);
      }
      this.renew();
    }
  }

  /** A browser does not say why a WebSocket was refused; if the page itself is still served, it was because of the token. */
  async askWhetherRefused() {
    const served = await fetch(location.pathname, {method: "HEAD", cache: "no-store"}).then(({ok}) => ok, () => false);
    if (served && this.token) {
      this.handlers.tokenRefused();
    }
  }

  onText(message) {
    if (message.op === "serverInfo") {
      this.handlers.open(message);
    } else if (message.op === "advertise") {
      this.subscribe(message.channels);
    } else if (message.op === "advertiseServices") {
      message.services.forEach((service) => this.services.set(service.name, service.id));
      this.handlers.services();
    } else if (message.op === "serviceCallFailure") {
      this.answer(message.callId, {ok: false, text: message.message});
    } else if (message.op === "parameterValues") {
      this.handlers.parameters(new Map(message.parameters.map((p) => [p.name, p.value])));
    }
  }

  subscribe(channels) {
    const usable = channels.filter((channel) => channel.encoding === "json");
    usable.forEach((channel) => this.topics.set(channel.id, channel.topic));
    this.send({op: "subscribe", subscriptions: usable.map((channel) => ({id: channel.id, channelId: channel.id}))});
  }

  onBinary(view) {
    const op = view.getUint8(0);
    if (op === TIME) {
      this.handlers.time(Number(view.getBigUint64(1, true)) / 1e9);
    } else if (op === MESSAGE_DATA) {
      const topic = this.topics.get(view.getUint32(1, true));
      const timeS = Number(view.getBigUint64(5, true)) / 1e9;
      const payload = new Uint8Array(view.buffer, 13);
      this.handlers.message(topic, () => JSON.parse(this.decoder.decode(payload)), timeS);
    } else if (op === SERVICE_RESPONSE) {
      const payload = new Uint8Array(view.buffer, 13 + view.getUint32(9, true));  // after the name of its encoding
      this.answer(view.getUint32(5, true), JSON.parse(this.decoder.decode(payload)));
    }
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify(message));
    }
  }

  setParameter(name, value) {
    this.send({op: "setParameters", parameters: [{name, value}]});
  }

  answer(callId, answer) {
    this.calls.get(callId)?.(answer);
    this.calls.delete(callId);
  }

  /** Calls a service; returns a promise of its answer, {ok, text}. `isLost`: it is this page that says so, and the server may not know of the call. */
  call(service, request) {
    if (this.socket.readyState !== WebSocket.OPEN || !this.services.has(service)) {
      return Promise.resolve({ok: false, isLost: true, text: "Not sent: no connection."});
    }
    const encoding = new TextEncoder().encode("json");
    const payload = new TextEncoder().encode(JSON.stringify(request));
    const frame = new DataView(new ArrayBuffer(13 + encoding.length + payload.length));
    const callId = this.nextCall++;
    frame.setUint8(0, SERVICE_REQUEST);
    frame.setUint32(1, this.services.get(service), true);
    frame.setUint32(5, callId, true);
    frame.setUint32(9, encoding.length, true);
    new Uint8Array(frame.buffer).set(encoding, 13);
    new Uint8Array(frame.buffer).set(payload, 13 + encoding.length);
    this.socket.send(frame.buffer);
    return new Promise((done) => this.calls.set(callId, done));
  }
}
