// The controls and what is read from them: labels, numbers, the table of trained ranges, what a screen reader hears.

import { excess, outside, verdict } from "./verdict.js";

const byId = (id) => document.getElementById(id);
const SPOKEN_AFTER = 600; // ms after the last change
const NONE = "\u2013"; // in place of a number
const NOT_KNOWN = "not known"; // as the page's description says of a range (learn/page/controls.py)

/** A number with three significant digits and no exponent. */
export function number(value) {
  if (!Number.isFinite(value)) return NOT_KNOWN;
  if (value === 0) return "0";
  const digits = Math.min(Math.max(2 - Math.floor(Math.log10(Math.abs(value))), 0), 8);
  return value.toFixed(digits);
}

export class Panel {
  /** change: called with the keys of a poke that were changed. */
  constructor(about, change) {
    this.about = about;
    this.sliders = {};
    for (const [key, limits] of Object.entries(about.sliders)) {
      const slider = byId(key);
      const logarithmic = limits.scale === "log";
      const to = logarithmic ? Math.log10 : (v) => v;
      const from = logarithmic ? (v) => 10 ** v : (v) => v;
      slider.min = to(limits.low);
      slider.max = to(limits.high);
      slider.step = logarithmic ? 0.005 : limits.step;
      this.sliders[key] = { slider, to };
      slider.addEventListener("input", () => change({ [key]: from(Number(slider.value)) }));
      const share = (v) => (100 * (to(v) - to(limits.low))) / (to(limits.high) - to(limits.low));
      const trained = limits.trained;
      byId(`${key}-trained`).textContent = trained ? `trained: ${trained.text}` : "";
      const [a, b] = trained?.range ? trained.range.map((v) => Math.min(Math.max(share(v), 0), 100)) : [0, 100];
      slider.style.setProperty("--from", `${a}%`);
      slider.style.setProperty("--to", `${b}%`);
    }
    const choice = byId("interior");
    about.interiors.forEach(({ label }, k) => choice.add(new Option(label, k)));
    choice.addEventListener("change", () => change({ interior: Number(choice.value) }));
    const levels = byId("levels");
    for (const { name, modulus } of about.softness) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.setAttribute("aria-label", `Modulus of ${name}, ${number(modulus)} kilopascals`);
      button.addEventListener("click", () => change({ modulus }));
      levels.append(button);
    }
    this.rows = about.checks.map(({ name, units, trained }) => {
      const row = byId("checks").insertRow();
      row.insertCell().outerHTML = `<th scope="row">${name}${units ? ` [${units}]` : ""}</th>`;
      const [value, range, verdict] = [row.insertCell(), row.insertCell(), row.insertCell()];
      range.textContent = trained;
      return { value, verdict };
    });
  }

  /** The sliders and their numbers follow the poke. */
  follow(poke) {
    for (const [key, { slider, to }] of Object.entries(this.sliders)) {
      slider.value = to(poke[key]);
      const text = `${number(poke[key])} ${this.about.sliders[key].units}`;
      byId(`${key}-value`).textContent = text;
      slider.setAttribute("aria-valuetext", text);
    }
    byId("interior").value = poke.interior;
  }

  /** Force, interval and verdict of an answer of the graph. */
  tell(poke, answer) {
    const { about } = this;
    const { sentences } = about.words;
    const force = Number(answer.force[0]);
    const touching = poke.depth > 0;
    byId("force").textContent = number(force);
    let interval = "no interval (run learn.evaluate first)";
    if (answer.factor) {
      const [low, high] = [force / answer.factor[0], force * answer.factor[0]];
      interval = touching ? `90 % interval ${number(low)} to ${number(high)} N` : "no contact";
    }
    byId("interval").textContent = interval;
    const words = verdict(about, poke, answer);
    const found = new Set(outside(poke, answer));
    this._judge(answer.beyond ? String(!found.size) : "null", touching ? words : sentences.inside, words);
    about.checks.forEach((check, k) => {
      const { value, verdict: cell } = this.rows[k];
      value.textContent = check.kinds ? about.interiors[poke.interior].kind : number(answer.values[k]);
      const far = found.has(k) ? ["outside", excess(about.words, check, answer.beyond[k])].filter(Boolean).join(", ") : "";
      cell.textContent = check.trained === NOT_KNOWN ? NOT_KNOWN : far || "inside";
      cell.className = far ? "outside" : "";
    });
    this._say(`Force ${number(force)} newtons, ${interval}. ${words}`);
  }

  /** In place of an answer, why there is none. */
  refuse(reason) {
    const words = `No prediction: ${reason}.`;
    byId("force").textContent = NONE;
    byId("interval").textContent = "";
    this._judge("refused", words, words);
    for (const { value, verdict: cell } of this.rows) {
      value.textContent = cell.textContent = NONE;
      cell.className = "";
    }
    this._say(words);
  }

  /** The verdict below the picture, and its beginning in the picture. */
  _judge(inside, short, words) {
    document.body.dataset.inside = inside;
    [byId("inside").textContent] = short.split(/[:.]/);
    byId("verdict").textContent = words;
  }

  _say(words) {
    clearTimeout(this.spoken);
    this.spoken = setTimeout(() => { byId("spoken").textContent = words; }, SPOKEN_AFTER);
  }

  /** What the simulated poke beside it says; null: hide it. */
  compare(text) {
    const box = byId("compared");
    box.hidden = text === null;
    if (text !== null) byId("compared-text").textContent = text;
  }
}
