// The page: messages of the server go to the panels, the toolbar sends commands.
import { compare } from "./compare.js";
import { connect, send, state } from "./connection.js";
import { controls } from "./controls.js";
import { $, fillSelect, showNote, showTab, TABS, tag } from "./dom.js";
import { graph } from "./graph.js";
import { inspect } from "./inspect.js";
import { cost, diagnostics, exports_ } from "./panels.js";
import { stage } from "./stage.js";

let loaded = 0;
let loading = false;

function receive(message) {
  if (message.refused) {
    showNote(message.refused);
    return;
  }
  state.glance = message.glance;
  if (state.content) state.content.frame = message.glance.frame ?? state.content.frame;
  if (message.content) {
    if (!state.content && !message.content.sound) showTab("diagnostics");
    state.content = message.content;
    header(message.content);
    controls(message.content);
    diagnostics(message.content);
    graph(message.content);
    inspect.refresh(message.content);
    compare.refresh(message.content);
    exports_(message.content);
  }
  status();
  picture();
}

function header(content) {
  document.title = `${content.project}: nau-view`;
  $("project").textContent = content.project;
  $("project").title = content.file;
  fillSelect($("pipeline"), content.pipelines, content.pipeline);
  $("known").replaceChildren(...content.effects.known.map((value) => tag("option", { value })));
  if (document.activeElement !== $("effects")) $("effects").value = content.effects.chosen;
  if (document.activeElement !== $("frame")) $("frame").value = content.frame;
  $("time").textContent = `${(content.frame * content.step).toFixed(2)} s`;
  $("play").textContent = content.playing ? "⏸" : "▶";
  $("undo").disabled = content.undo === 0;
  $("save").disabled = content.changed.length === 0;
  const errors = content.diagnostics.filter((d) => d.severity === "error").length;
  const summary = errors ? `${errors} error${errors > 1 ? "s" : ""}: see diagnostics. ` : "";
  showNote(summary + content.note);
  $("empty").textContent = errors ? "The project cannot be drawn: see diagnostics." : "No picture yet.";
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

// Load one picture at a time: a slow window skips some.
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

function begin() {
  for (const name of TABS)
    $("tabs").append(tag("button", { "data-tab": name, onclick: () => showTab(name) }, name));
  showTab("parameters");
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
  connect(receive, () => { $("status").textContent = "not connected"; });
}

begin();
