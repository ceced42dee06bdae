// The domain of validity of a poke in words, as learn/verdict.py states it: sentences, grades and their limits are
// data of the page (about.words), written by Python.

/** A template with its {names} replaced. */
export function fill(template, values) {
  return template.replace(/\{(\w+)\}/g, (_, name) => values[name]);
}

/** A number with this many significant digits and no trailing zeros, as format "g" of Python writes it. */
export function general(value, digits) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e").map(Number);
  if (exponent >= -4 && exponent < digits) return String(Number(value.toPrecision(digits)));
  return `${mantissa}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
}

/** Numbers of the checks (about.checks) that are outside; without contact, where nothing moves, there are none. */
export function outside({ depth }, { beyond }) {
  if (!(depth > 0) || !beyond) return [];
  return Array.from(beyond.keys()).filter((k) => beyond[k] > 0);
}

/** The excess of a quantity in words; empty inside, and for a kind of inclusion, which has none. */
export function excess({ multiples, sentences }, { kinds, unit }, beyond) {
  if (kinds || !(beyond > 0)) return "";
  const { text, factor, digits } = multiples.find(({ least }) => beyond >= least);
  const times = fill(text, { number: (factor * beyond).toFixed(digits) });
  return fill(sentences.excess, { times, unit });
}

/** The verdict on an answer of the graph. */
export function verdict(about, poke, answer) {
  const { sentences, grades } = about.words;
  const { beyond, values, distance } = answer;
  if (!(poke.depth > 0)) return sentences.contact;
  if (!beyond) return sentences.unknown;
  const found = outside(poke, answer);
  if (!found.length) return sentences.inside;
  const places = found.map((k) => {
    const check = about.checks[k];
    const { name, units, trained, kinds } = check;
    const value = kinds ? about.interiors[poke.interior].kind : `${general(values[k], 4)} ${units}`.trim();
    const far = excess(about.words, check, beyond[k]);
    return fill(far ? sentences.place_with_excess : sentences.place, { name, value, trained, excess: far });
  });
  const { place, follows, wider } = grades.find(({ above }) => distance[0] > above);
  const intervals = answer.factor ? fill(sentences.intervals, { wider }) : "";
  return fill(sentences.outside, { grade: place, places: places.join(", "), follows, intervals });
}
