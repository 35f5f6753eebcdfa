// The window's side of the desk: what comes over the web socket goes to the panels.
import { compare } from "./compare.js";
import { controls } from "./controls.js";
import { graph } from "./graph.js";
import { inspect } from "./inspect.js";
import { cost, diagnostics, exports_ } from "./panels.js";
import { stage } from "./stage.js";

export const $ = (id) => document.getElementById(id);
export const state = { content: null, glance: { pictures: 0 } };
const TABS = ["parameters", "diagnostics", "inspect", "compare", "cost", "export"];
let socket = null;
let loaded = 0;
let loading = false;

export function tag(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export function send(command) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
}

export function say(text) {
  $("note").textContent = text;
  $("note").hidden = !text;
}

// Answers that are refused come as a text that says why.
export async function fetched(url, options) {
  const answer = await fetch(url, options);
  if (!answer.ok) {
    const why = (await answer.text()).trim();
    say(why);
    throw new Error(why);
  }
  return answer;
}

export function hexImage(hex) {
  const bytes = new Uint8Array(hex.match(/../g).map((pair) => parseInt(pair, 16)));
  return URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
}

function connect() {
  const url = new URL("live", location.href);
  url.protocol = url.protocol.replace("http", "ws");
  socket = new WebSocket(url);
  socket.onmessage = (message) => take(JSON.parse(message.data));
  socket.onclose = () => {
    $("status").textContent = "not connected";
    setTimeout(connect, 1000);
  };
}

function take(said) {
  if (said.refused) {
    say(said.refused);
    return;
  }
  state.glance = said.glance;
  if (state.content) state.content.frame = said.glance.frame ?? state.content.frame;
  if (said.content) {
    if (!state.content && !said.content.sound) show("diagnostics");
    state.content = said.content;
    header(said.content);
    controls(said.content);
    diagnostics(said.content);
    graph(said.content);
    inspect.refresh(said.content);
    compare.refresh(said.content);
    exports_(said.content);
  }
  status();
  picture();
}

function header(content) {
  document.title = `${content.project}: nau-view`;
  $("project").textContent = content.project;
  $("project").title = content.file;
  choose($("pipeline"), content.pipelines, content.pipeline);
  $("known").replaceChildren(...content.effects.known.map((value) => tag("option", { value })));
  if (document.activeElement !== $("effects")) $("effects").value = content.effects.chosen;
  if (document.activeElement !== $("frame")) $("frame").value = content.frame;
  $("time").textContent = `${(content.frame * content.step).toFixed(2)} s`;
  $("play").textContent = content.playing ? "⏸" : "▶";
  $("undo").disabled = content.undo === 0;
  $("save").disabled = content.changed.length === 0;
  const errors = content.diagnostics.filter((d) => d.severity === "error").length;
  const wrong = errors ? `${errors} error${errors > 1 ? "s" : ""}: see diagnostics. ` : "";
  say(wrong + content.note);
  $("empty").textContent = errors ? "The project cannot be drawn: see diagnostics." : "No picture yet.";
}

export function choose(select, names, chosen) {
  if (document.activeElement === select && select.options.length) return;
  select.replaceChildren(...names.map((n) => tag("option", { selected: n === chosen }, n)));
}

function status() {
  const { coarse, steps, spp, error, ms, width, height, pictures } = state.glance;
  if (!pictures) return;
  const parts = [`${width}×${height}`, `${ms.toFixed(0)} ms`];
  if (coarse) parts.push("coarse");
  else if (spp) parts.push(`${spp} spp (${steps} step${steps > 1 ? "s" : ""})`);
  if (error != null) parts.push(`est. error ${error.toFixed(4)}`);
  $("status").textContent = parts.join(" · ");
  $("status").dataset.pictures = pictures;
  $("status").dataset.coarse = coarse;
}

// One picture at a time is loaded: a slow window skips some, and holds up nobody.
async function picture() {
  if (loading || state.glance.pictures === loaded) return;
  loading = true;
  const wanted = state.glance.pictures;
  try {
    const answer = await fetch(`picture.png?n=${wanted}`);
    if (answer.ok) {
      const url = URL.createObjectURL(await answer.blob());
      const before = $("picture").src;
      $("picture").src = url;
      $("picture").dataset.n = wanted;
      $("empty").hidden = true;
      await $("picture").decode().catch(() => {});
      if (before) URL.revokeObjectURL(before);
    }
    loaded = wanted;
  } finally {
    loading = false;
  }
  if (state.glance.pictures !== loaded) picture();
}

export function show(name) {
  for (const other of TABS) $(other).hidden = other !== name;
  for (const button of $("tabs").children)
    button.setAttribute("aria-selected", button.dataset.tab === name);
}

function begin() {
  for (const name of TABS)
    $("tabs").append(tag("button", { "data-tab": name, onclick: () => show(name) }, name));
  show("parameters");
  $("pipeline").onchange = (e) => { send({ do: "pipeline", name: e.target.value }); e.target.blur(); };
  $("effects").onchange = (e) => { send({ do: "effects", value: e.target.value }); e.target.blur(); };
  $("frame").onchange = (e) => send({ do: "frame", index: Number(e.target.value) });
  $("play").onclick = () => send({ do: "play", on: !state.content.playing });
  $("undo").onclick = () => send({ do: "undo" });
  $("save").onclick = () => send({ do: "save" });
  addEventListener("keydown", (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key === "z") send({ do: "undo" });
    if ((event.ctrlKey || event.metaKey) && event.key === "s") {
      event.preventDefault();
      send({ do: "save" });
    }
  });
  stage();
  compare.begin();
  cost();
  connect();
}

begin();
