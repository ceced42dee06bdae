// The page: one poke at a time from the controls to the graph, and its answer to the picture and the panel.

import { contents } from "./payload.js";
import { Surrogate } from "./surrogate.js";
import { View } from "./view.js";
import { Panel, number } from "./panel.js";
import { refusal } from "./refusal.js";
import { outside } from "./verdict.js";
import { listen } from "./pointer.js";

const byId = (id) => document.getElementById(id);
const PRESS = 1200; // ms from the surface to the depth

class Page {
  constructor(about, array, surrogate) {
    Object.assign(this, { about, array, surrogate });
    this.poke = { ...about.start };
    this.times = []; // of each frame [ms]: {inference, whole}
    this.compared = null; // {poke, frame} of the simulated poke beside it
    this.spans = about.interiors.map((_, k) => array(`spans-${k}`).data);
    this.view = new View(byId("picture"), about, this.spans);
    this.panel = new Panel(about, (keys) => this.change(keys));
    this.moved = new Float32Array(about.grid ** 2 * 3);
    this.off = new Float32Array(about.grid ** 2);
    this.shade = new Float32Array(about.grid ** 2);
    this.rest = new Float32Array(about.grid ** 2 * 3);
    listen(this.view, () => this.poke, (keys) => this.change(keys));
    this.view.controls.addEventListener("change", () => this.wake());
    new ResizeObserver(() => { this.view.resize(); this.wake(); }).observe(this.view.canvas);
    this._buttons();
    this.view.showInterior(this.poke.interior);
    this.asked = true;
    this.panel.follow(this.poke);
  }

  _buttons() {
    for (const button of document.querySelectorAll("[data-look]")) {
      button.addEventListener("click", () => { this.view.look(button.dataset.look); this.wake(); });
    }
    for (const button of document.querySelectorAll("[data-zoom]")) {
      button.addEventListener("click", () => { this.view.zoom(Number(button.dataset.zoom)); this.wake(); });
    }
    byId("halo").addEventListener("change", () => this.ask());
    byId("press").addEventListener("click", () => this.press());
    const choice = byId("simulated");
    this.about.simulated.forEach(({ label }, k) => choice.add(new Option(label, k)));
    byId("beside").addEventListener("click", () => this.beside(this.compared ? null : Number(choice.value)));
    choice.addEventListener("change", () => this.compared && this.beside(Number(choice.value)));
    byId("beside-form").hidden = !this.about.simulated.length;
  }

  /** Change keys of the poke, kept within the sliders' limits, and ask anew. */
  change(keys) {
    this.motion = null;
    this._set(keys);
  }

  _set(keys) {
    const old = this.poke;
    this.poke = { ...old, ...keys };
    this.poke.heading = ((((this.poke.heading + 180) % 360) + 360) % 360) - 180;
    for (const [key, { low, high }] of Object.entries(this.about.sliders)) {
      this.poke[key] = Math.min(Math.max(this.poke[key], low), high);
    }
    if (this.compared) this._follow(old);
    if (this.poke.interior !== old.interior) this.view.showInterior(this.poke.interior);
    this.panel.follow(this.poke);
    this.ask();
  }

  /** Beside a simulated poke the depth goes through its frames; any other change ends the comparison. */
  _follow(old) {
    const other = ["x", "y", "angle", "heading", "modulus", "interior"].some((key) => this.poke[key] !== old[key]);
    if (other) {
      this.beside(null);
      return;
    }
    const { depths } = this.about.simulated[this.compared.index];
    const nearest = (d) => depths.reduce((best, v, k) => (Math.abs(v - d) < Math.abs(depths[best] - d) ? k : best), 0);
    let frame = nearest(this.poke.depth);
    if (depths[frame] === old.depth && this.poke.depth !== old.depth) {
      frame += Math.sign(this.poke.depth - old.depth); // a step of a key, less than to the next frame
      frame = Math.min(Math.max(frame, 0), depths.length - 1);
    }
    this.compared.frame = frame;
    this.poke.depth = depths[frame];
  }

  /** Show a simulated poke, by its index, beside the surrogate's answer to the same poke; null: end that. */
  beside(index) {
    this.motion = null;
    const button = byId("beside");
    button.setAttribute("aria-pressed", String(index !== null));
    button.textContent = index === null ? "Show the FEM poke beside it" : "Hide the FEM poke";
    document.body.classList.toggle("beside", index !== null);
    this.compared = null;
    if (index === null) this.panel.compare(null);
    else {
      const { poke, depths } = this.about.simulated[index];
      const frame = depths.length - 1;
      this._set({ ...poke, depth: depths[frame] });
      this.compared = { index, frame };
    }
    this.view.beside = index !== null;
    this.view.resize();
    this.ask();
  }

  /** Push from the surface to the depth of the slider. */
  press() {
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (calm || this.compared) return;
    this.motion = { to: this.poke.depth || this.about.start.depth, begun: performance.now() };
    this.wake();
  }

  ask() {
    this.asked = true;
    this.wake();
  }

  wake() {
    if (this.awake) return;
    this.awake = true;
    requestAnimationFrame((time) => this._frame(time));
  }

  async _frame(time) {
    const begun = performance.now();
    if (this.motion) {
      const share = Math.min(Math.max((time - this.motion.begun) / PRESS, 0), 1);
      this._set({ depth: this.motion.to * share });
      if (share === 1) this.motion = null;
    }
    let inference = null;
    if (this.asked) {
      this.asked = false;
      const poke = this.poke;
      const answer = await this.surrogate.ask(poke);
      inference = performance.now() - begun;
      this._show(poke, answer);
    }
    this.view.render();
    if (inference !== null) this.times.push({ inference, whole: performance.now() - begun });
    if (this.times.length > 1000) this.times.shift();
    this.awake = false;
    if (this.asked || this.motion) this.wake();
  }

  _show(poke, answer) {
    const { direction, tip, displacement } = answer;
    const { radius, edge } = this.about.rod;
    const depth = Math.max(poke.depth, 0);
    const now = Array.from(tip, (v, k) => v * 1e3 + direction[k] * depth);
    const rod = { tip: now, push: direction, radius, edge };
    this.view.placeRod(now, direction);
    const refused = refusal(this.about, this.spans[poke.interior], poke, answer);
    if (refused) {
      this.view.show("surrogate", this.rest, null, true, null);
      this.panel.refuse(refused);
    } else {
      const grey = outside(poke, answer).length > 0; // and no halo: the intervals are not calibrated there
      const halo = answer.radius && byId("halo").checked && depth > 0 && !grey;
      if (halo) this._scaled(answer.radius);
      this.view.show("surrogate", displacement, halo ? this.shade : null, grey, rod);
      this.panel.tell(poke, answer);
    }
    if (this.compared) this._compare(poke, refused ? null : answer, rod);
  }

  /** Lengths [m] on the halo's scale, from 0 to 1, logarithmic. */
  _scaled(lengths) {
    const { low, high } = this.about.halo;
    const [from, over] = [Math.log(low), Math.log(high / low)];
    for (let k = 0; k < lengths.length; k++) this.shade[k] = (Math.log(lengths[k] * 1e3 + 1e-9) - from) / over;
  }

  /** Show the simulated poke's frame, and the error of an answer to the same poke; null: it was refused. */
  _compare(poke, answer, rod) {
    const { index, frame } = this.compared;
    const { steps, forces } = this.about.simulated[index];
    const moves = this.array(`simulated-${index}`).data;
    const { moved, off } = this;
    let [largest, mean, held] = [0, 0, 0];
    for (let k = 0; k < off.length; k++) {
      let square = 0;
      for (let p = 3 * k; p < 3 * k + 3; p++) {
        moved[p] = moves[frame * moved.length + p] * steps[frame];
        if (answer) square += (moved[p] - answer.displacement[p]) ** 2;
      }
      off[k] = Math.sqrt(square);
      largest = Math.max(largest, off[k]);
      mean += off[k] / off.length;
      if (answer?.radius) held += (off[k] <= answer.radius[k]) / off.length;
    }
    if (answer) this._scaled(off);
    this.view.show("simulated", moved, answer ? this.shade : null, false, rod);
    const force = forces[frame];
    const simulated = `FEM: ${number(force)} N at ${number(poke.depth)} mm.`;
    if (!answer) {
      this.panel.compare(simulated);
      return;
    }
    const wrong = (100 * (Number(answer.force[0]) - force)) / force;
    const share = answer.radius ? ` ${(100 * held).toFixed(0)} % of the points lie within their intervals.` : "";
    this.panel.compare(
      `${simulated} Error of the surrogate: ${wrong.toFixed(1)} % of the force, ` +
      `${number(mean * 1e3)} mm on average and ${number(largest * 1e3)} mm at most.${share}`,
    );
  }
}

async function start() {
  const { about, array } = await contents();
  const surrogate = await Surrogate.load(about, array);
  const page = new Page(about, array, surrogate);
  page.wake();
  while (!page.times.length) await new Promise(requestAnimationFrame);
  page.times.length = 0; // the first frame compiles
  byId("loading").hidden = true;
  document.documentElement.dataset.ready = "true";
  return page;
}

window.tisim = start().catch((error) => {
  const why = error.message.replace(/\.$/, "");
  byId("loading").textContent = `This page could not start: ${why}. It needs WebAssembly and WebGL 2.`;
  document.documentElement.dataset.ready = "failed";
  throw error;
});
