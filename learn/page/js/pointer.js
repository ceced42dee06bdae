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
  const { canvas, controls } = view;
  let moving = null; // the pointer that holds the rod
  let leaning = false;

  const hold = (event) => {
    const at = view.under(event);
    if (!at) return;
    if (leaning) {
      const { x, y } = now();
      const [dx, dy] = [at.x - x, at.y - y];
      // the push points from the hand to the site
      change({ angle: Math.min(Math.hypot(dx, dy) * 1.5, 45), heading: (Math.atan2(-dy, -dx) * 180) / Math.PI });
    } else change({ x: at.x, y: at.y });
  };

  // before OrbitControls hears of it: on the block a pointer moves the rod, beside it the view
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    const at = view.under(event);
    const mine = moving === null && at?.inside && (event.button === 0 || event.button === 2);
    controls.enabled = !mine;
    if (!mine) return;
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
      if (event.pointerId !== moving) return;
      moving = null;
      controls.enabled = true;
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
