// Mouse, finger and keys on the picture of the block.

const KEYS = {
  ArrowLeft: (p, s) => ({ x: p.x - s }),
  ArrowRight: (p, s) => ({ x: p.x + s }),
  ArrowDown: (p, s) => ({ y: p.y - s }),
  ArrowUp: (p, s) => ({ y: p.y + s }),
  "+": (p) => ({ depth: p.depth + 0.5 }),
  "=": (p) => ({ depth: p.depth + 0.5 }),
  PageDown: (p) => ({ depth: p.depth + 0.5 }),
  "-": (p) => ({ depth: p.depth - 0.5 }),
  PageUp: (p) => ({ depth: p.depth - 0.5 }),
  Home: () => ({ depth: 0 }),
  "[": (p) => ({ angle: p.angle - 2 }),
  "]": (p) => ({ angle: p.angle + 2 }),
  ",": (p) => ({ heading: p.heading - 5 }),
  ".": (p) => ({ heading: p.heading + 5 }),
};

/** view: View; now: function that gives the poke; change: function that takes changed keys of it. */
export function listen(view, now, change) {
  const steepest = view.about.sliders.angle.high;
  const { canvas, controls } = view;
  let moving = null; // the pointer that holds the rod
  let leaning = false;
  let last = null; // its last event
  let before = null; // where the rod was when it came
  let passing = false; // an event is passed on to OrbitControls
  const turning = new Set(); // fingers that turn the view

  const hold = (event) => {
    last = event;
    const at = view.under(event);
    if (!at) return;
    if (leaning) {
      const { x, y } = now();
      const [dx, dy] = [at.x - x, at.y - y];
      // the push points from the hand to the site
      change({ angle: Math.min(Math.hypot(dx, dy) * 1.5, steepest), heading: (Math.atan2(-dy, -dx) * 180) / Math.PI });
    } else change({ x: at.x, y: at.y });
  };

  const release = () => {
    moving = null;
    controls.enabled = true;
  };

  /** A second finger: both are the view's from now on, and the rod is where it was before they came. */
  const handOver = () => {
    const { pointerId, pointerType, clientX, clientY } = last;
    release();
    change(before);
    passing = true;
    const passed = { pointerId, pointerType, clientX, clientY, bubbles: true, cancelable: true };
    canvas.dispatchEvent(new PointerEvent("pointerdown", passed));
    passing = false;
    turning.add(pointerId);
  };

  // before OrbitControls hears of it: on the block a pointer moves the rod, beside it the view
  canvas.addEventListener("pointerdown", (event) => {
    if (passing) return;
    canvas.focus({ preventScroll: true });
    if (moving !== null) handOver();
    const at = view.under(event);
    const mine = !turning.size && at?.inside && (event.button === 0 || event.button === 2);
    controls.enabled = !mine;
    if (!mine) {
      if (event.pointerType === "touch") turning.add(event.pointerId);
      return;
    }
    const { x, y, angle, heading } = now();
    before = { x, y, angle, heading };
    moving = event.pointerId;
    leaning = event.button === 2 || event.shiftKey;
    canvas.setPointerCapture(moving);
    hold(event);
  }, { capture: true });
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerId === moving) hold(event);
    else if (moving === null && event.pointerType === "mouse") {
      canvas.style.cursor = view.under(event)?.inside ? "crosshair" : "grab";
    }
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => {
      turning.delete(event.pointerId);
      if (event.pointerId === moving) release();
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (event.ctrlKey || !view.under(event)?.inside) return; // the view's own zoom
    event.preventDefault();
    event.stopImmediatePropagation();
    change({ depth: now().depth + Math.sign(event.deltaY) * 0.25 });
  }, { capture: true, passive: false });
  canvas.addEventListener("keydown", (event) => {
    const move = KEYS[event.key];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    change(move(now(), event.shiftKey ? 5 : 1));
  });
}
