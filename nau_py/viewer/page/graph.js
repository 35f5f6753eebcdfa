// The pipeline: passes in their order, targets below them, and who reads and writes what.
import { $, fetched, hexImage, state } from "./app.js";
import { inspect } from "./inspect.js";

const NS = "http://www.w3.org/2000/svg";
const WIDTH = 190, GAP = 40, TOP = 10, HEIGHT = 58, THUMB = [96, 72], PITCH = THUMB[0] + 14;
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

function passBox(pass, x) {
  const rays = Object.entries(pass.rays || {}).reduce((sum, [, n]) => sum + n, 0);
  const spent = pass.ms != null && pass.runs ? `${pass.ms.toFixed(1)} ms` : "";
  const traced = rays ? ` · ${rays.toLocaleString("en")} rays` : "";
  const second = pass.runs ? spent + traced : short(`left out: ${pass.reason}`, 34);
  const detail = Object.entries(pass.rays || {}).map(([k, n]) => `${k} ${n.toLocaleString("en")}`);
  const title = pass.runs ? [pass.name, spent, ...detail].join("\n") : `left out: ${pass.reason}`;
  return svg("g", { class: "pass", "data-pass": pass.name, opacity: pass.runs ? 1 : 0.55 },
    svg("title", {}, title),
    svg("rect", { x, y: TOP, width: WIDTH, height: HEIGHT, rx: 5, stroke: "#334",
      fill: pass.runs ? "#dbeafe" : "#eeeeee", "stroke-dasharray": pass.runs ? "" : "5 4" }),
    svg("text", { x: x + 8, y: TOP + 18, "font-weight": "bold" }, short(pass.name)),
    svg("text", { x: x + 8, y: TOP + 33, fill: "#556" }, pass.class),
    svg("text", { x: x + 8, y: TOP + 48, fill: "#334" }, second));
}

function targetBox(target, x, y) {
  const picture = pictures[target.name];
  const made = svg("g", { class: "target", "data-target": target.name, tabindex: 0, role: "button" },
    svg("title", {}, `${target.name}: click to inspect`),
    svg("rect", { x, y, width: THUMB[0] + 8, height: THUMB[1] + 22, rx: 4, fill: "white", stroke: "#889" }),
    svg("text", { x: x + 4, y: y + THUMB[1] + 16 }, short(target.name.replace(/^.*::/, ""), 16)));
  if (picture) made.append(svg("image", { href: picture, x: x + 4, y: y + 4, width: THUMB[0], height: THUMB[1] }));
  else made.append(svg("text", { x: x + 12, y: y + 40, fill: "#889" }, target.kind));
  const open = () => { if (pictures[target.name]) inspect.open(target.name); };
  made.addEventListener("click", open);
  made.addEventListener("keydown", (event) => { if (event.key === "Enter") open(); });
  return made;
}

export function graph(content) {
  draw(content);
  thumbnails();
}

function draw(content) {
  const { passes, targets } = content.graph;
  const shape = JSON.stringify([content.graph, Object.keys(pictures).length, asked]);
  if (shape === last) return;
  last = shape;
  const homes = targets.map((t) => Math.min(...(t.writers.length ? t.writers : t.readers)));
  const at = [];
  let x = 12;
  passes.forEach((_, i) => {
    at.push(x);
    x += Math.max(WIDTH, homes.filter((h) => h === i).length * PITCH) + GAP;
  });
  const taken = passes.map(() => 0);
  const drawn = [];
  const lines = [];
  const y = TOP + HEIGHT + 40;
  targets.forEach((target, i) => {
    const left = at[homes[i]] + taken[homes[i]]++ * PITCH;
    drawn.push(targetBox(target, left, y));
    const middle = left + THUMB[0] / 2;
    for (const w of target.writers) lines.push(edge(at[w] + WIDTH / 2, TOP + HEIGHT, middle, y, "#1f7a4d"));
    for (const r of target.readers) {
      if (!target.writers.includes(r)) lines.push(edge(middle, y, at[r] + 24, TOP + HEIGHT, "#9a4d00"));
    }
  });
  const width = x, deepest = y + THUMB[1] + 30;
  $("graph").replaceChildren(svg("svg", { width, height: deepest, viewBox: `0 0 ${width} ${deepest}` },
    svg("defs", {}, svg("marker", { id: "arrow", markerWidth: 7, markerHeight: 7, refX: 6, refY: 3, orient: "auto" },
      svg("path", { d: "M0,0 L6,3 L0,6 z", fill: "context-stroke" }))),
    ...lines, ...passes.map((p, i) => passBox(p, at[i])), ...drawn));
}

function edge(x1, y1, x2, y2, colour) {
  const bend = (y2 - y1) / 2;
  return svg("path", { d: `M${x1},${y1} C${x1},${y1 + bend} ${x2},${y2 - bend} ${x2},${y2}`, fill: "none",
    stroke: colour, "stroke-opacity": 0.6, "marker-end": "url(#arrow)" });
}

// Thumbnails are asked for once a state of the picture, once it has its full size.
async function thumbnails() {
  const version = state.content.full;
  if (!version || asked === version) return;
  asked = version;
  try {
    const found = await (await fetched("thumbnails")).json();
    Object.values(pictures).forEach((url) => url.startsWith("blob:") && URL.revokeObjectURL(url));
    pictures = Object.fromEntries(Object.entries(found).map(([name, hex]) => [name, hexImage(hex)]));
    draw(state.content);
  } catch { /* what is wrong has been said */ }
}
