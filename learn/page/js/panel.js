// The controls and what is read from them: labels, numbers, the table of trained ranges, what a screen reader hears.

const byId = (id) => document.getElementById(id);
const SPOKEN_AFTER = 600; // ms after the last change
const NOT_KNOWN = "not known"; // as the page's description says of a range (learn/page/controls.py)

/** Whether any quantity of an answer, or its kind of inclusion, is beyond what was trained; without contact, where
 * nothing moves, none is. */
export function isOutside({ depth }, { beyond }) {
  return depth > 0 && Boolean(beyond) && beyond.some((part) => part > 0);
}

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
    const force = Number(answer.force[0]);
    const touching = poke.depth > 0;
    byId("force").textContent = number(force);
    let interval = "no interval (run learn.evaluate first)";
    if (answer.factor) {
      const [low, high] = [force / answer.factor[0], force * answer.factor[0]];
      interval = touching ? `90 % interval ${number(low)} to ${number(high)} N` : "no contact";
    }
    byId("interval").textContent = interval;
    const verdict = this._verdict(poke, answer);
    const inside = answer.beyond ? !isOutside(poke, answer) : null;
    const words = { true: "inside the trained ranges", false: "outside the trained ranges" };
    byId("inside").textContent = words[inside] ?? "trained ranges not known";
    byId("verdict").textContent = verdict;
    document.body.dataset.inside = String(inside);
    about.checks.forEach(({ kinds, trained }, k) => {
      const { value, verdict: cell } = this.rows[k];
      value.textContent = kinds ? about.interiors[poke.interior].kind : number(answer.values[k]);
      const outside = touching && answer.beyond[k] > 0;
      cell.textContent = trained === NOT_KNOWN ? NOT_KNOWN : outside ? "outside" : "inside";
      cell.className = outside ? "outside" : "";
    });
    clearTimeout(this.spoken);
    this.spoken = setTimeout(() => {
      byId("spoken").textContent = `Force ${number(force)} newtons, ${interval}. ${verdict}`;
    }, SPOKEN_AFTER);
  }

  _verdict(poke, answer) {
    const { beyond, values } = answer;
    if (!beyond) return "The trained ranges are not known.";
    if (!(poke.depth > 0)) return "No contact: nothing moves.";
    if (!isOutside(poke, answer)) return "Inside the trained ranges.";
    const names = this.about.checks.flatMap(({ name, units, trained, kinds }, k) => {
      if (!(beyond[k] > 0)) return [];
      const value = kinds ? this.about.interiors[poke.interior].kind : `${number(values[k])} ${units}`.trim();
      return [`${name} ${value} (trained: ${trained})`];
    });
    return `Outside the trained ranges: ${names.join("; ")}. The interval is not calibrated here.`;
  }

  /** What the simulated poke beside it says; null: hide it. */
  compare(text) {
    const box = byId("compared");
    box.hidden = text === null;
    if (text !== null) byId("compared-text").textContent = text;
  }
}
