// Bundles the page's script with three.js and onnxruntime-web into ../bundle, once; needs node 20 and xz:
//
//   cd learn/page/js && npm ci && npm run build
//
// The bundle is committed, so that making a page needs Python alone. bundle.json holds the sum of every source and of
// every file made, which tests/learn/page compares.

import { createHash } from "node:crypto";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const OUT = "../bundle";
const sum = (path) => createHash("sha256").update(readFileSync(path)).digest("hex");
const sums = (folder, names) => Object.fromEntries(names.sort().map((name) => [name, sum(`${folder}/${name}`)]));

mkdirSync(OUT, { recursive: true });
await build({
  entryPoints: ["main.js"],
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "inline",
  // onnxruntime-web takes it for the base of a URL, and a file's is "null" in Firefox and Safari
  define: { "location.origin": "location.href" },
  outfile: `${OUT}/page.js`,
});
const wasm = readFileSync("node_modules/onnxruntime-web/dist/ort-wasm-simd-threaded.wasm");
writeFileSync(`${OUT}/onnxruntime.wasm.xz`, execFileSync("xz", ["-9e", "-T1", "-c"], { input: wasm, maxBuffer: 1e9 }));
writeFileSync(`${OUT}/LICENSE-three.txt`, readFileSync("node_modules/three/LICENSE"));

const { dependencies } = JSON.parse(readFileSync("package.json"));
const sources = readdirSync(".").filter((name) => /\.(js|mjs|json)$/.test(name));
const made = readdirSync(OUT).filter((name) => name !== "bundle.json");
writeFileSync(
  `${OUT}/bundle.json`,
  JSON.stringify({ versions: dependencies, sources: sums(".", sources), made: sums(OUT, made) }, null, 1) + "\n",
);
