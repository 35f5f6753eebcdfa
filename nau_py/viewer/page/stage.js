// Mouse, wheel and keys over the picture move the camera.
import { send } from "./connection.js";
import { $ } from "./dom.js";

const TURN = 0.008; // radians a pixel
const STEP = 0.01; // parts of the scene's diagonal a key press
const KEYS = {
  w: [STEP, 0, 0], s: [-STEP, 0, 0], a: [0, -STEP, 0], d: [0, STEP, 0], q: [0, 0, -STEP], e: [0, 0, STEP],
};
const LOOK = { ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, 0.05], ArrowDown: [0, -0.05] };
let held = null;
let waiting = null;

// Moves of one drag are one step of undo; those within a frame of the screen are sent as one.
function move(how, by, more) {
  if (waiting && waiting.how === how) {
    waiting.by = how === "dolly" ? [waiting.by[0] * by[0]] : waiting.by.map((v, i) => v + by[i]);
    return;
  }
  if (waiting) flush();
  waiting = { do: "move", how, by, more };
  requestAnimationFrame(flush);
}

function flush() {
  if (waiting) send(waiting);
  waiting = null;
}

export function stage() {
  const area = $("stage");
  area.addEventListener("pointerdown", (event) => {
    if (event.target === $("bar")) return;
    held = { x: event.clientX, y: event.clientY, moved: false };
    area.setPointerCapture(event.pointerId);
    area.focus();
  });
  area.addEventListener("pointermove", (event) => {
    if (!held) return;
    const dx = event.clientX - held.x;
    const dy = event.clientY - held.y;
    const size = area.clientHeight;
    if (event.shiftKey || event.buttons & 4) move("pan", [-dx / size, dy / size], held.moved);
    else if (event.buttons & 2) move("look", [dx * TURN, -dy * TURN], held.moved);
    else move("orbit", [dx * TURN, -dy * TURN], held.moved);
    held = { x: event.clientX, y: event.clientY, moved: true };
  });
  area.addEventListener("pointerup", () => { held = null; });
  area.addEventListener("contextmenu", (event) => event.preventDefault());
  area.addEventListener("wheel", (event) => {
    event.preventDefault();
    move("dolly", [Math.exp(event.deltaY * 0.001)], false);
  }, { passive: false });
  area.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (KEYS[key]) move("fly", KEYS[key], event.repeat);
    else if (LOOK[key]) move("look", LOOK[key], event.repeat);
    else if (key === "+" || key === "-") move("dolly", [key === "+" ? 0.9 : 1 / 0.9], event.repeat);
    else return;
    event.preventDefault();
  });
}
