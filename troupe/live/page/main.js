// The page put together: what comes is drawn at the screen's pace, and told when it has been drawn.

import { Camera } from "./camera.js";
import { Card } from "./card.js";
import { inks } from "./colors.js";
import { Painter } from "./draw.js";
import { Hands } from "./hands.js";
import { Link } from "./link.js";
import { posesOf, savePicture, saveSvg, saveText } from "./save.js";
import { State } from "./state.js";
import { Strip, put } from "./strip.js";
import { printable } from "./texts.js";
import { TimeLine, timeIn } from "./timeline.js";

const find = (id) => document.getElementById(id);
const MOST_LISTED = 500, HIDDEN = 1000;

const page = {
  state: new State(),
  camera: new Camera(),
  canvas: find("canvas"),
  painter: new Painter(find("canvas")),
  view: {
    dark: matchMedia("(prefers-color-scheme: dark)").matches,
    show: {}, selected: new Set(), ghost: null, readOnly: false,
  },
  /** There is something new to be drawn, with the screen's next picture. */
  changed() {
    page.dirty = true;
    if (!page.asked) requestAnimationFrame(frame);
    page.asked = true;
  },
  toggle(layer) {
    const box = document.querySelector(`#layers input[name=${layer}]`);
    box.checked = !box.checked;
    page.view.show[layer] = box.checked;
  },
  which() {
    const box = find("which");
    box.open = !box.open;
    if (box.open) find("layers").open = true;
  },
  help() {
    const shown = find("help").hidden;
    find("help").hidden = !shown;
    find("keys").setAttribute("aria-expanded", String(shown));
  },
  escape() {
    if (!find("help").hidden) page.help();
    else hands.select([]);
    page.canvas.focus();
  },
  drawn: 0,
  dirty: false,
  asked: false,          // a picture is
};

const strip = new Strip(find);
const line = new TimeLine(find, (time) => page.link.ask({ do: "seek", time }),
                          (robot) => page.state.names[robot]);
let unseen = 0, over = false, lined = true, lost = "";

page.link = new Link({
  open() { lost = ""; say("Connected."); },
  closed(reason) {
    if (over) return;
    lost = `The connection has ended${reason && `: ${printable(reason)}`}.`;
    say(lost);
  },
  notices(lines) { notice(...lines.slice(-3)); },
  world(text) { saveText(text, `troupe-${page.state.time.toFixed(1)}.yaml`); },
  scene(message) {
    page.state.begin(message);
    const { scene } = page.state;
    scene.begun = performance.now();
    over = false;
    lined = false;
    page.view.readOnly = scene.read_only || Boolean(scene.log);
    document.title = `${scene.title} · Troupe`;
    find("title").textContent = printable(scene.title, 80);
    find("seed").value = scene.seed;
    find("again").hidden = !scene.again || scene.read_only;
    const what = page.view.readOnly ? "poses" : "world";
    put(find("world"), what);
    find("world").setAttribute("aria-label", `Save ${what}`);
    for (const id of ["go", "step", "slower", "faster", "real", "flat"]) {
      find(id).disabled = scene.read_only || scene.stepped;
    }
    document.body.classList.toggle("log", Boolean(scene.log));
    if (scene.log) goTo(location.hash);
    size();
    page.camera.reset(scene);
    if (page.view.selected.size) hands.select(page.view.selected);
    page.changed();
  },
  moment(message) {
    unseen += 1;
    page.state.take(message, performance.now());
    if (message.entered) list();
    if (!lined) line.begin(page.state.scene.log);   // once robots have names
    lined = true;
    page.changed();
    // Who does not look has no pictures, and takes a moment now and then all the same.
    if (document.hidden) setTimeout(acknowledge, HIDDEN);
  },
});

const hands = (page.hands = new Hands(page));
const card = new Card(find("card"), (what) => page.link.ask(what));

/** Draw what is new, and say so, so that more may come. */
function frame(now) {
  const { state, view, camera } = page;
  page.asked = false;
  if (page.dirty && state.scene) {
    page.dirty = false;
    if (view.show.follow && view.selected.size) {
      const robot = [...view.selected].at(-1);
      if (robot < state.count) {
        [camera.x, camera.y] = state.poses.subarray(3 * robot, 3 * robot + 2);
        camera.whole = false;
      }
    }
    page.painter.draw(state, camera, view);
    const ink = inks(state.scene.palette, view.dark);
    card.show(state, view.selected.size ? [...view.selected].at(-1) : null, ink, view.selected.size);
    strip.show(state, view.dark ? "#7cc4ff" : "#0060a0", now);
    line.show(state, ink);
    place();
    buttons();
    page.drawn = state.moments;
  }
  acknowledge();
}

/** What has come may be followed by more. */
function acknowledge() {
  for (; unseen > 0; unseen--) page.link.ask({ do: "seen" });
}

/** The address is a link to where a log stands. */
function place() {
  const { scene, status, time } = page.state, hash = `#t=${Number(time.toFixed(3))}`;
  if (scene.log && status.paused && location.hash !== hash) history.replaceState(null, "", hash);
}

/** Go to the time of a link, if it has one. */
function goTo(hash) {
  const time = timeIn(hash);
  if (time !== null) page.link.ask({ do: "seek", time });
}

function buttons() {
  const { status, scene } = page.state;
  put(find("go"), !status.paused ? "Pause" : scene.log ? "Play" : "Go on");
  const pace = status.pace;
  put(find("pace"), pace === null || pace === undefined ? "flat out" : `${pace} ×`);
  const { state } = page;
  if (status.outcome) {
    over = true;
    say(`The run is over: ${status.outcome.replace("_", " ")}.`);
  } else if (lost) say(lost);
  else if (scene.log && state.time >= scene.log.until) {
    say(`The end of the log: ${(scene.log.outcome ?? "the run was cut off").replace("_", " ")}.`);
  } else if (status.paused) say(`Paused at ${state.time.toFixed(2)} s, tick ${state.tick}.`);
  else if (status.waiting?.length) say(`Waiting for ${status.waiting[0][0]}.`);
  else say(scene.log ? "Playing." : "Running.");
}

function say(text) { put(find("state"), text); }

/** Lines that stay for a while, whatever the run does meanwhile. */
function notice(...lines) {
  const box = find("notices");
  box.replaceChildren(...lines.map((line) => {
    const p = document.createElement("p");
    p.textContent = printable(line, 300);
    return p;
  }));
  clearTimeout(page.clearing);
  page.clearing = setTimeout(() => box.replaceChildren(), 6000);
}

/** The robots' names, for whoever types one. */
function list() {
  const names = page.state.names.slice(0, MOST_LISTED);
  find("names").replaceChildren(...names.map((name) => {
    const option = document.createElement("option");
    option.value = name;
    return option;
  }));
}

function size() {
  const { width, height } = find("stage").getBoundingClientRect();
  page.camera.resize(width, height);
  page.changed();
}

function looks() {
  document.documentElement.dataset.looks = page.view.dark ? "dark" : "light";
  find("looks").setAttribute("aria-pressed", String(page.view.dark));
  page.changed();
}

for (const box of document.querySelectorAll("#layers input")) {
  page.view.show[box.name] = box.checked;
  box.onchange = () => {
    page.view.show[box.name] = box.checked;
    page.changed();
  };
}
find("go").onclick = () => hands.toggle();
find("step").onclick = () => hands.step();
find("slower").onclick = () => hands.shift(-1);
find("faster").onclick = () => hands.shift(1);
find("real").onclick = () => hands.pace(1);
find("flat").onclick = () => hands.pace(null);
find("picture").onclick = () => savePicture(page.canvas, `troupe-${page.state.time.toFixed(1)}`);
find("svg").onclick = () => saveSvg(page, `troupe-${page.state.time.toFixed(1)}`);
find("here").onclick = async () => {
  page.link.ask({ do: "pause" });
  const link = new URL(`#t=${Number(page.state.time.toFixed(3))}`, location.href).href;
  history.replaceState(null, "", link);
  try {
    await navigator.clipboard.writeText(link);
    notice("The link is on the clipboard.");
  } catch {
    notice("The link stands in the address bar.");
  }
};
find("world").onclick = () => {
  if (page.view.readOnly) saveText(posesOf(page.state), `troupe-${page.state.time.toFixed(1)}.yaml`);
  else page.link.ask({ do: "world" });
};
find("keys").onclick = () => page.help();
find("looks").onclick = () => {
  page.view.dark = !page.view.dark;
  looks();
};
find("again").onsubmit = (event) => {
  event.preventDefault();
  const seed = find("seed").value.trim();
  if (seed === "") page.link.ask({ do: "again" });
  else if (/^\d{1,15}$/.test(seed)) page.link.ask({ do: "again", seed: Number(seed) });
  else notice("A seed is a whole number.");
};
find("find").onsubmit = (event) => {
  event.preventDefault();
  const robot = page.state.names.indexOf(find("robot").value.trim());
  if (robot >= 0) hands.select([robot]);
  else notice("There is no robot of that name.");
};
window.addEventListener("hashchange", () => goTo(location.hash));
if (innerWidth <= 720) find("layers").open = false;
new ResizeObserver(size).observe(find("stage"));
looks();
window.troupe = page;   // for those who look at the page with a program
