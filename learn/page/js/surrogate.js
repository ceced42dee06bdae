// The graph that the command exported, run by onnxruntime-web on one thread. It computes nothing itself.

import * as ort from "onnxruntime-web/wasm";
import { part } from "./payload.js";

export class Surrogate {
  /** about, array: from payload.js */
  static async load(about, array) {
    ort.env.wasm.numThreads = 1;
    ort.env.wasm.wasmBinary = (await part("wasm")).buffer;
    const session = await ort.InferenceSession.create(await part("graph"), { executionProviders: ["wasm"] });
    return new Surrogate(session, about, array);
  }

  constructor(session, about, array) {
    this.session = session;
    this.interiors = about.interiors.map((_, k) => {
      const feeds = {};
      for (const name of about.interior_inputs) {
        const { type, data, shape } = array(`${name}-${k}`);
        feeds[name] = new ort.Tensor(type, data, shape);
      }
      return feeds;
    });
    this.poke = new Float64Array(6);
    this.input = new ort.Tensor("float64", this.poke, [6]);
  }

  /** Outputs of the graph by name, for a poke as in the sliders (mm, degrees, kPa). */
  async ask({ interior, x, y, angle, heading, depth, modulus }) {
    const turn = Math.PI / 180;
    this.poke.set([x * 1e-3, y * 1e-3, angle * turn, heading * turn, depth * 1e-3, modulus * 1e3]);
    const found = await this.session.run({ poke: this.input, ...this.interiors[interior] });
    return Object.fromEntries(Object.entries(found).map(([name, tensor]) => [name, tensor.data]));
  }
}
