// SPDX-License-Identifier: BSD-3-Clause
// A client of Foxglove's WebSocket protocol: the page is one viewer among others.

const SUBPROTOCOL = "foxglove.websocket.v1";
const RETRY_MS = 1000;
const MESSAGE_DATA = 1;
const TIME = 2;

/**
 * Subscribes to every topic of the server that the page came from, and connects again when the connection is lost.
 * handlers: open(serverInfo), close(), message(topic, message, timeS), time(timeS), status(message), parameters(map).
 */
export class Connection {
  constructor(handlers) {
    this.handlers = handlers;
    // Behind '#', so that it is sent to nobody but the WebSocket.
    this.token = new URLSearchParams(location.hash.slice(1)).get("token");
    this.decoder = new TextDecoder();
    this.connect();
  }

  connect() {
    const query = this.token ? `?token=${encodeURIComponent(this.token)}` : "";
    this.topics = new Map();  // by subscription id
    this.socket = new WebSocket(`ws://${location.host}/${query}`, [SUBPROTOCOL]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = (event) => {
      if (typeof event.data === "string") {
        this.onText(JSON.parse(event.data));
      } else {
        this.onBinary(new DataView(event.data));
      }
    };
    this.socket.onclose = () => {
      this.handlers.close();
      setTimeout(() => this.connect(), RETRY_MS);
    };
  }

  onText(message) {
    if (message.op === "serverInfo") {
      this.handlers.open(message);
    } else if (message.op === "advertise") {
      this.subscribe(message.channels);
    } else if (message.op === "status") {
      this.handlers.status(message.message);
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
      this.handlers.message(topic, JSON.parse(this.decoder.decode(payload)), timeS);
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

  /** Declares the topics on which publish() will send; their ids are their places, from 1. */
  advertise(topics) {
    this.published = topics;
    this.send({op: "advertise", channels: topics.map((topic, i) => ({id: i + 1, topic, encoding: "json", schemaName: topic}))});
  }

  publish(topic, message) {
    const payload = new TextEncoder().encode(JSON.stringify(message));
    const frame = new DataView(new ArrayBuffer(5 + payload.length));
    frame.setUint8(0, MESSAGE_DATA);
    frame.setUint32(1, this.published.indexOf(topic) + 1, true);
    new Uint8Array(frame.buffer, 5).set(payload);
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(frame.buffer);
    }
  }
}
