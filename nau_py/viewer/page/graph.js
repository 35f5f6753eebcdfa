// The pipeline: passes, targets with thumbnails, and arrows from writers to readers. Python
// computes the positions (nau_py/viewer/graph.py); this file draws them.
import { fetchOrNote, state } from "./connection.js";
import { $, imageOfHex } from "./dom.js";
import { inspect } from "./inspect.js";

const NS = "http://www.w3.org/2000/svg";
const COLOURS = { write: "#1f7a4d", read: "#9a4d00", order: "#667" };
let pictures = {};
let asked = -1;
let last = "";

function svg(name, attributes, ...children) {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const short = (text, most = 28) => (text.length > most ? text.slice(0, most - 1) + "…" : text);

function passBox(pass) {
  const [x, y, width, height] = pass.box;
  const rays = Object.entries(pass.rays || {}).reduce((sum, [, n]) => sum + n, 0);
  const spent = pass.ms != null && pass.runs ? `${pass.ms.toFixed(1)} ms` : "";
  const traced = rays ? ` · ${rays.toLocaleString("en")} rays` : "";
  const second = pass.runs ? spent + traced : short(`left out: ${pass.reason}`, 34);
  const detail = Object.entries(pass.rays || {}).map(([k, n]) => `${k} ${n.toLocaleString("en")}`);
  const title = pass.runs ? [pass.name, spent, ...detail].join("\n") : `left out: ${pass.reason}`;
  return svg("g", { class: "pass", "data-pass": pass.name, opacity: pass.runs ? 1 : 0.55 },
    svg("title", {}, title),
    svg("rect", { x, y, width, height, rx: 5, stroke: "#334",
      fill: pass.runs ? "#dbeafe" : "#eeeeee", "stroke-dasharray": pass.runs ? "" : "5 4" }),
    svg("text", { x: x + 8, y: y + 18, "font-weight": "bold" }, short(pass.name)),
    svg("text", { x: x + 8, y: y + 33, fill: "#556" }, pass.class),
    svg("text", { x: x + 8, y: y + 48, fill: "#334" }, second));
}

function targetBox(target) {
  const [x, y, width, height] = target.box;
  const picture = pictures[target.name];
  const made = svg("g", { class: "target", "data-target": target.name, tabindex: 0, role: "button" },
    svg("title", {}, `${target.name}: click to inspect`),
    svg("rect", { x, y, width, height, rx: 4, fill: "white", stroke: "#889" }),
    svg("text", { x: x + 4, y: y + height - 5 }, short(target.name.replace(/^.*::/, ""), 13)));
  if (picture) made.append(svg("image", { href: picture, x: x + 4, y: y + 3, width: width - 8, height: height - 20 }));
  else made.append(svg("text", { x: x + 12, y: y + 36, fill: "#889" }, target.kind));
  const open = () => { if (pictures[target.name]) inspect.open(target.name); };
  made.addEventListener("click", open);
  made.addEventListener("keydown", (event) => { if (event.key === "Enter") open(); });
  return made;
}

function arrow({ path, kind, both, previous }) {
  const made = svg("path", { d: path, fill: "none", stroke: COLOURS[kind], "stroke-opacity": 0.6,
    "stroke-dasharray": previous ? "6 4" : kind === "order" ? "2 4" : "", "marker-end": "url(#arrow)" });
  if (both) made.setAttribute("marker-start", "url(#arrow)");
  return made;
}

export function graph(content) {
  draw(content);
  thumbnails();
}

function draw(content) {
  const { width, height, margin, passes, targets, arrows } = content.graph;
  const shape = JSON.stringify([content.graph, Object.keys(pictures).length, asked]);
  if (shape === last) return;
  last = shape;
  $("graph").replaceChildren(svg("svg", { width, height, viewBox: `0 0 ${width} ${height}` },
    svg("defs", {}, svg("marker", { id: "arrow", markerWidth: 7, markerHeight: 7, refX: 6, refY: 3,
      orient: "auto-start-reverse" }, svg("path", { d: "M0,0 L6,3 L0,6 z", fill: "context-stroke" }))),
    svg("g", { transform: `translate(${margin},${margin})` }, ...arrows.map(arrow)),
    ...passes.map(passBox), ...targets.map(targetBox)));
}

// Fetch the thumbnails once for each state of the picture, when it has its full size.
async function thumbnails() {
  const version = state.content.full;
  if (!version || asked === version) return;
  asked = version;
  try {
    const found = await (await fetchOrNote("thumbnails")).json();
    Object.values(pictures).forEach((url) => url.startsWith("blob:") && URL.revokeObjectURL(url));
    pictures = Object.fromEntries(Object.entries(found).map(([name, hex]) => [name, imageOfHex(hex)]));
    draw(state.content);
  } catch { /* fetchOrNote() has reported the error */ }
}
