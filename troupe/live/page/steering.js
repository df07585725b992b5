// Driving by hand: a stick to be pushed, and buttons for those who have no pointer.

const REACH = 46;        // pixels that the stick can be pushed
const OFTEN = 50;        // milliseconds between two twists while it moves

/** The twist of a push: ahead and to the left, from -1 to 1, of a drive as the world file has it. */
export function twistOf(drive, ahead, left) {
  const v = 0.6 * Math.min(drive?.max_speed ?? 1, 2), w = 0.5 * Math.min(drive?.max_turn_rate ?? 1, 2);
  return [ahead * v, 0, left * w * (ahead < -0.2 ? -1 : 1)];
}

/** The stick and the buttons, which call `drive(twist)`, and with zeros when they are let go. */
export function steering(drive, told) {
  const box = document.createElement("div");
  box.className = "steering";
  box.append(stick(drive, told), pad(drive, told));
  return box;
}

function stick(drive, told) {
  const base = document.createElement("div"), knob = document.createElement("div");
  base.className = "stick";
  base.setAttribute("aria-hidden", "true");   // the buttons do the same
  base.append(knob);
  let held = false, sent = 0, late = 0;
  const send = (ahead, left) => {
    clearTimeout(late);
    const wait = sent + OFTEN - performance.now();
    if (wait > 0 && (ahead || left)) {
      late = setTimeout(() => { if (held && base.isConnected) send(ahead, left); }, wait);
      return;
    }
    sent = performance.now();
    drive(twistOf(told, ahead, left));
  };
  const push = (event) => {
    const at = base.getBoundingClientRect();
    let dx = event.clientX - at.left - at.width / 2, dy = event.clientY - at.top - at.height / 2;
    const far = Math.hypot(dx, dy), cut = far > REACH ? REACH / far : 1;
    dx *= cut;
    dy *= cut;
    knob.style.translate = `${dx}px ${dy}px`;
    send(-dy / REACH, -dx / REACH);
  };
  base.onpointerdown = (event) => {
    held = true;
    base.setPointerCapture(event.pointerId);
    push(event);
  };
  base.onpointermove = (event) => { if (held) push(event); };
  base.onpointerup = base.onpointercancel = base.onlostpointercapture = () => {
    if (!held) return;
    held = false;
    knob.style.translate = "0px 0px";
    send(0, 0);
  };
  return base;
}

/** Buttons that drive as long as they are held down. */
function pad(drive, told) {
  const box = document.createElement("div");
  box.className = "pad";
  for (const [label, name, ahead, left] of [
    ["↖", "ahead and left", 1, 1], ["↑", "ahead", 1, 0], ["↗", "ahead and right", 1, -1],
    ["←", "turn left", 0, 1], ["■", "stop", 0, 0], ["→", "turn right", 0, -1],
    ["↙", "back and left", -1, 1], ["↓", "back", -1, 0], ["↘", "back and right", -1, -1],
  ]) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: label });
    button.setAttribute("aria-label", name);
    let held = false;
    const go = () => {
      held = true;
      drive(twistOf(told, ahead, left));
    };
    const stop = () => {
      if (held) drive([0, 0, 0]);
      held = false;
    };
    button.onpointerdown = (event) => {
      button.setPointerCapture(event.pointerId);
      go();
    };
    button.onpointerup = button.onpointercancel = button.onblur = stop;
    button.onkeydown = (event) => {
      if ((event.key === "Enter" || event.key === " ") && !event.repeat) go();
    };
    button.onkeyup = stop;
    box.append(button);
  }
  return box;
}
