// What the command put into the page: gzipped and in base64, each in a <script> of its own.

/** Bytes of the part with this id, unpacked. */
export async function part(id) {
  const text = document.getElementById(id).textContent;
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const KINDS = { float32: Float32Array, float64: Float64Array, int16: Int16Array, uint8: Uint8Array };

/** The page's description, and a function that gives its arrays by name as {type, shape, data}. */
export async function contents() {
  const about = JSON.parse(new TextDecoder().decode(await part("about")));
  const bytes = await part("arrays");
  const array = (name) => {
    const { type, shape, offset } = about.arrays[name];
    const count = shape.reduce((a, b) => a * b, 1);
    return { type, shape, data: new KINDS[type](bytes.buffer, bytes.byteOffset + offset, count) };
  };
  return { about, array };
}
