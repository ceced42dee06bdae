// Poses that no indentation can have, as learn/real_time.py refuses them: limits and sentences are data of the page
// (about.refusals), written by Python.

import { fill, general } from "./verdict.js";

/** Where a push comes to the inclusion, as obstacle of learn/quantities.py has it: {limit, cover} [mm], or null.
 *
 * spans: first rigid level under each point of the grid, and the level after the last, (n * n, 2); answer: of the graph.
 */
function obstacle({ grid, levels, block }, spans, { tip, direction }) {
  const { size, middle, top } = block;
  const cell = (at, k) => Math.min(Math.max(Math.floor(((at - middle[k]) / size[k] + 0.5) * grid), 0), grid - 1);
  for (let k = 1; k <= 2 * levels; k++) {
    const limit = k * (size[2] / (2 * levels) / -direction[2]); // half a level deeper
    const [x, y, z] = tip.map((v, i) => v * 1e3 + limit * direction[i]);
    const level = Math.floor((top - z) * (levels / size[2]) + 1e-9);
    if (level > levels) return null; // below the base
    const column = 2 * (cell(y, 1) * grid + cell(x, 0));
    const [first, last] = [spans[column], spans[column + 1]];
    if (last > first && level > first) return { limit, cover: (first * size[2]) / levels };
  }
  return null;
}

/** Why no indentation can have the pose of a poke, in words; null: it can. Without contact any pose is possible. */
export function refusal(about, spans, poke, answer) {
  if (!(poke.depth > 0)) return null;
  const { site, depth, angle, inclusion } = about.refusals;
  const values = Object.fromEntries(["x", "y", "depth", "angle"].map((key) => [key, general(poke[key], 4)]));
  const beside = ["x", "y"].some((key, k) => poke[key] < site.low[k] || poke[key] > site.high[k]);
  if (beside) return fill(site.text, values);
  if (poke.depth >= depth.least) return fill(depth.text, values);
  if (poke.angle > angle.most) return fill(angle.text, values);
  const met = obstacle(about, spans, answer);
  if (!met || poke.depth < met.limit) return null;
  return fill(inclusion.text, { ...values, limit: general(met.limit, 3), cover: general(met.cover, 3) });
}
