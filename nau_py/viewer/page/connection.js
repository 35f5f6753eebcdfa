// The viewer's server: commands and state over a web socket, files over HTTP.
import { showNote } from "./dom.js";

export const state = { content: null, glance: { pictures: 0 } };
const RECONNECT = 1000; // milliseconds
let socket = null;

// Call onMessage for every message, onClose when the server is gone; then connect again.
export function connect(onMessage, onClose) {
  const url = new URL("live", location.href);
  url.protocol = url.protocol.replace("http", "ws");
  socket = new WebSocket(url);
  socket.onmessage = (message) => onMessage(JSON.parse(message.data));
  socket.onclose = () => {
    onClose();
    setTimeout(() => connect(onMessage, onClose), RECONNECT);
  };
}

export function send(command) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
}

// Fetch, and show the reason if the server refuses.
export async function fetchOrNote(url, options) {
  const response = await fetch(url, options);
  if (!response.ok) {
    const reason = (await response.text()).trim();
    showNote(reason);
    throw new Error(reason);
  }
  return response;
}
