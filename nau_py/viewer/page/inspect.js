// A target at full size: channels, exposure, the mask, and the numbers under the cursor.
import { fetchOrNote, state } from "./connection.js";
import { $, fillSelect, showTab, tag } from "./dom.js";

const CHANNELS = ["rgb", "r", "g", "b", "a"];
let name = "", channel = "rgb", exposure = 0, mask = false, full = false;
let busy = false, next = null;

async function read(event) {
  const image = event.currentTarget;
  const scale = image.naturalWidth / image.clientWidth;
  const at = [Math.floor(event.offsetX * scale), Math.floor(event.offsetY * scale)];
  if (busy) { next = at; return; }
  busy = true;
  try {
    await said(at);
  } finally {
    busy = false;
    if (next) { const later = next; next = null; said(later); }
  }
}

async function said([x, y]) {
  const answer = await fetchOrNote(`pixel?${new URLSearchParams({ name, x, y })}`);
  const { values } = await answer.json();
  const labels = "rgba";
  const lines = values.map((v, i) => `${labels[i]} = ${typeof v === "number" ? Number(v.toPrecision(7)) : v}`);
  $("read").textContent = `(${x}, ${y}), row 0 at the top\n${lines.join("   ")}`;
}

async function load() {
  const image = $("target");
  if (!image || !name) return;
  const query = new URLSearchParams({ name, channel, exposure, mask: mask ? 1 : 0, n: state.glance.pictures });
  const answer = await fetchOrNote(`target.png?${query}`);
  const before = image.src;
  image.src = URL.createObjectURL(await answer.blob());
  image.dataset.name = name;
  if (before) URL.revokeObjectURL(before);
}

function build() {
  const box = (label, checked, change) => {
    const input = tag("input", { type: "checkbox", checked });
    input.onchange = () => change(input.checked);
    return tag("label", {}, input, ` ${label}`);
  };
  const targets = tag("select", { id: "targets", "aria-label": "target" });
  targets.onchange = () => { name = targets.value; targets.blur(); $("read").textContent = ""; load(); };
  const channels = tag("select", { id: "channel", "aria-label": "channel" },
    ...CHANNELS.map((c) => tag("option", {}, c)));
  channels.onchange = () => { channel = channels.value; load(); };
  const stops = tag("input", { id: "exposure", type: "range", min: -10, max: 10, step: 0.5, value: exposure,
    "aria-label": "exposure, stops" });
  stops.oninput = () => { exposure = Number(stops.value); $("stops").textContent = `${exposure} EV`; load(); };
  const image = tag("img", { id: "target", alt: "the target" });
  image.addEventListener("pointermove", read);
  const view = tag("div", { class: "view" }, image);
  $("inspect").replaceChildren(
    tag("div", { class: "row" }, targets, channels),
    tag("div", { class: "row" }, stops, tag("span", { id: "stops" }, `${exposure} EV`)),
    tag("div", { class: "row" }, box("mask", mask, (on) => { mask = on; load(); }),
      box("full size", full, (on) => { full = on; view.classList.toggle("full", on); })),
    view, tag("div", { id: "read", class: "read" }, "Move over the picture to read its values."),
    tag("p", { class: "soft" }, "NaN is magenta, infinity cyan. Depth is stretched over what the target holds, near is bright."));
}

let version = -1;
export const inspect = {
  open(target) {
    name = target;
    showTab("inspect");
    this.refresh(state.content, true);
  },
  refresh(content, force = false) {
    const names = content.targets.map(([target]) => target);
    if (!$("targets")) build();
    if (!names.includes(name)) name = names[0] || "";
    fillSelect($("targets"), names, name);
    if (!$("inspect").hidden && (force || version !== content.version) && name) {
      version = content.version;
      load().catch(() => {});
    }
  },
};
