"""A script for the browser: the contrast of each text of a page."""

# contrast of text against the first opaque background behind it, white if none is opaque: WCAG 2.2, 1.4.3
CONTRAST = """() => {
  const parse = (c) => c.match(/[\\d.]+/g).map(Number);
  const linear = (v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = (colour) => colour.slice(0, 3).map((v) => linear(v / 255))
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const found = {};
  const names = 'p, label, output, small, button, summary, h1, th, td, option, span';
  for (const e of document.querySelectorAll(names)) {
    if (!e.textContent.trim() || !e.checkVisibility()) continue;
    let ground = [255, 255, 255];
    for (let up = e; up; up = up.parentElement) {
      const c = parse(getComputedStyle(up).backgroundColor);
      if (c.length === 3 || c[3] === 1) { ground = c; break; }
    }
    const [a, b] = [light(parse(getComputedStyle(e).color)), light(ground)];
    found[e.textContent.trim().slice(0, 40)] = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  }
  return found;
}"""
