// Draws every .tisim-view of a page with WebGL 2. Its data: numbers of `tisim.view._pack`.
"use strict";
(() => {
  const VERTEX = `#version 300 es
    in vec3 position; in float value;
    uniform mat4 camera, lens; uniform vec3 corner, size;
    out vec3 place; out float shade;
    void main() {
      vec4 p = camera * vec4(corner + size * position, 1.0);
      place = p.xyz; shade = value; gl_Position = lens * p;
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 place; in float shade;
    uniform sampler2D ramp; uniform vec4 colour; uniform float coloured, lit;
    out vec4 pixel;
    void main() {
      float light = 1.0;
      if (lit > 0.5) { // a line has no normal
        vec3 n = normalize(cross(dFdx(place), dFdy(place)));
        light = 0.62 + 0.42 * max(0.0, dot(n, normalize(vec3(-0.35, 0.75, 0.8))));
      }
      vec3 c = coloured > 0.5 ? texture(ramp, vec2((shade * 255.0 + 0.5) / 256.0, 0.5)).rgb : colour.rgb;
      pixel = vec4(c * light, colour.a);
    }`;
  const FIELD = 0.5; // of view, up and down [rad]

  const unpack = async (text) => {
    if (!("DecompressionStream" in globalThis)) throw new Error("This picture needs a browser of 2023 or later.");
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).arrayBuffer();
  };

  // Positions are differences from frame to frame, modulo 2^16.
  const summed = (buffer, part, frames) => {
    const found = new Uint16Array(buffer, part.at, part.count).slice();
    const row = part.count / frames;
    for (let i = row; i < found.length; i++) found[i] += found[i - row];
    return found;
  };


  class Scene {
    constructor(gl, data, buffer) {
      this.gl = gl;
      const shader = (kind, text) => {
        const s = gl.createShader(kind);
        gl.shaderSource(s, text);
        gl.compileShader(s);
        return s;
      };
      const program = (this.program = gl.createProgram());
      gl.attachShader(program, shader(gl.VERTEX_SHADER, VERTEX));
      gl.attachShader(program, shader(gl.FRAGMENT_SHADER, FRAGMENT));
      gl.linkProgram(program);
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      gl.useProgram(program);
      this.at = {};
      for (const name of ["camera", "lens", "corner", "size", "ramp", "colour", "coloured", "lit"]) {
        this.at[name] = gl.getUniformLocation(program, name);
      }
      this.position = gl.getAttribLocation(program, "position");
      this.value = gl.getAttribLocation(program, "value");
      const fill = (target, values) => {
        const made = gl.createBuffer();
        gl.bindBuffer(target, made);
        gl.bufferData(target, values, gl.STATIC_DRAW);
        return made;
      };
      const indices = (part) => part && {
        buffer: fill(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(buffer, part.at, part.count)), count: part.count,
      };
      this.meshes = data.meshes.map((m) => ({
        ...m,
        points: fill(gl.ARRAY_BUFFER, summed(buffer, m.positions, m.frames)),
        faces: indices(m.triangles), opened: indices(m.opened), rims: indices(m.edges), openedRims: indices(m.opened_edges),
        fields: (m.fields || []).map((f) => fill(gl.ARRAY_BUFFER, new Uint8Array(buffer, f.at, f.count))),
      }));
      gl.uniform3fv(this.at.corner, data.corner);
      gl.uniform3fv(this.at.size, data.size);
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      const ramp = new Uint8Array(buffer, data.ramp.at, data.ramp.count);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, ramp);
      for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
      for (const way of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, way, gl.CLAMP_TO_EDGE);
      gl.enable(gl.DEPTH_TEST);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    }

    draw(state, camera, lens) {
      const { gl, at } = this;
      gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(at.camera, false, camera);
      gl.uniformMatrix4fv(at.lens, false, lens);
      const solid = this.meshes.filter((m) => !m.rest && (m.frame ?? state.frame) === state.frame);
      for (const m of solid) this.faces(m, state);
      if (state.rest) for (const m of this.meshes.filter((m) => m.rest)) this.faces(m, state);
    }

    faces(m, state) {
      const { gl, at } = this;
      const frame = m.frames > 1 ? state.frame : 0;
      const opened = state.opened && m.opened;
      gl.bindBuffer(gl.ARRAY_BUFFER, m.points);
      gl.enableVertexAttribArray(this.position);
      gl.vertexAttribPointer(this.position, 3, gl.UNSIGNED_SHORT, true, 6, frame * m.nodes * 6);
      const coloured = m.fields.length > 0 && this.value >= 0;
      if (coloured) {
        gl.bindBuffer(gl.ARRAY_BUFFER, m.fields[state.colouring]);
        gl.enableVertexAttribArray(this.value);
        gl.vertexAttribPointer(this.value, 1, gl.UNSIGNED_BYTE, true, 1, frame * m.nodes);
      } else {
        gl.disableVertexAttribArray(this.value);
        gl.vertexAttrib1f(this.value, 0);
      }
      gl.uniform1f(at.coloured, coloured ? 1 : 0);
      gl.uniform1f(at.lit, 1);
      gl.uniform4fv(at.colour, m.colour);
      const clear = m.colour[3] < 1;
      gl[clear ? "enable" : "disable"](gl.BLEND);
      gl.depthMask(!clear);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1.5, 6);
      const list = opened ? m.opened : m.faces;
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, list.buffer);
      gl.drawElements(gl.TRIANGLES, list.count, gl.UNSIGNED_INT, 0);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      const rims = opened ? m.openedRims : m.rims;
      if (rims && state.edges) {
        gl.enable(gl.BLEND);
        gl.depthMask(false);
        gl.uniform1f(at.coloured, 0);
        gl.uniform1f(at.lit, 0);
        gl.uniform4f(at.colour, 0.4, 0.42, 0.46, 0.55);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, rims.buffer);
        gl.drawElements(gl.LINES, rims.count, gl.UNSIGNED_INT, 0);
      }
      gl.depthMask(true);
    }
  }

  class View {
    constructor(section) {
      this.section = section;
      this.find = (name) => section.querySelector(name);
      this.data = JSON.parse(this.find(".data").textContent);
      this.canvas = this.find("canvas");
      const last = this.data.labels.length - 1;
      this.state = { frame: last, colouring: 0, opened: this.data.opened, edges: this.data.edges, rest: this.data.rest };
      this.home();
      this.controls();
      this.pointers();
      this.show();
      new ResizeObserver(() => {
        this.curve();
        this.show();
      }).observe(this.canvas);
      // a page of many views: only those on the screen hold a context
      new IntersectionObserver((seen) => {
        const here = seen.at(-1).isIntersecting;
        if (here) this.open();
        else this.close();
      }, { rootMargin: "200px" }).observe(this.canvas);
    }

    home() {
      const { turn, rise, corners } = this.data.camera;
      Object.assign(this, { turn, rise, zoom: 1, middle: [0, 0, 0] });
      for (const v of this.axes()) { // the middle of what is seen
        const along = corners.map((c) => c[0] * v[0] + c[1] * v[1] + c[2] * v[2]);
        const half = (Math.min(...along) + Math.max(...along)) / 2;
        for (let i = 0; i < 3; i++) this.middle[i] += half * v[i];
      }
      this.centre = [...this.middle];
    }

    async open() {
      if (this.scene || this.opening) return;
      this.opening = true;
      try {
        this.buffer ??= await unpack(this.data.numbers);
        const gl = this.canvas.getContext("webgl2", { antialias: true, alpha: true });
        if (!gl) throw new Error("This picture needs WebGL 2, which this browser does not have or has switched off.");
        if (gl.isContextLost()) {
          this.canvas.addEventListener("webglcontextrestored", () => this.open(), { once: true });
          this.lost?.restoreContext();
          return;
        }
        this.lost = gl.getExtension("WEBGL_lose_context");
        this.scene = new Scene(gl, this.data, this.buffer);
        this.find(".fault").textContent = "";
        this.section.dataset.ready = "";
        this.ask();
      } catch (error) {
        this.find(".fault").textContent = error.message;
      } finally {
        this.opening = false;
      }
    }

    close() {
      if (!this.scene || !this.lost) return;
      this.canvas.addEventListener("webglcontextlost", (e) => e.preventDefault(), { once: true });
      this.scene = null;
      this.lost.loseContext();
    }

    ask() {
      if (this.asked || !this.scene) return;
      this.asked = requestAnimationFrame(() => {
        this.asked = 0;
        this.draw();
      });
    }

    draw() {
      if (!this.scene) return;
      const c = this.canvas, sharp = Math.min(devicePixelRatio || 1, 2);
      const [w, h] = [Math.max(1, Math.round(c.clientWidth * sharp)), Math.max(1, Math.round(c.clientHeight * sharp))];
      if (c.width !== w || c.height !== h) Object.assign(c, { width: w, height: h });
      this.scene.draw(this.state, this.cameraMatrix(), this.lens(w / h));
    }

    axes() {
      const [a, e] = [this.turn, this.rise];
      const towards = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
      const right = [-Math.sin(a), Math.cos(a), 0];
      const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
      return [right, up, towards];
    }

    distance(aspect) {
      // all that is shown, whole in the picture
      const [right, up, towards] = this.axes();
      let far = 0;
      const tall = Math.tan(FIELD / 2) * 0.9;
      for (const corner of this.data.camera.corners) {
        const d = corner.map((x, i) => x - this.centre[i]);
        const along = (v) => d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
        far = Math.max(far, along(towards) + Math.max(Math.abs(along(up)) / tall, Math.abs(along(right)) / (tall * aspect)));
      }
      return far / this.zoom;
    }

    cameraMatrix() {
      const v = this.axes(), m = new Float32Array(16), d = this.distance(this.canvas.width / this.canvas.height);
      for (let i = 0; i < 3; i++) {
        for (let k = 0; k < 3; k++) m[4 * k + i] = v[i][k];
        m[12 + i] = -(v[i][0] * this.middle[0] + v[i][1] * this.middle[1] + v[i][2] * this.middle[2]);
      }
      m[14] -= d;
      m[15] = 1;
      this.away = d;
      return m;
    }

    lens(aspect) {
      const f = 1 / Math.tan(FIELD / 2), near = this.away * 0.02, far = this.away + 4 * this.data.camera.radius;
      const m = new Float32Array(16);
      m[0] = f / aspect;
      m[5] = f;
      m[10] = (far + near) / (near - far);
      m[11] = -1;
      m[14] = (2 * far * near) / (near - far);
      return m;
    }

    move(dx, dy) {
      const [right, up] = this.axes(), size = (2 * this.away * Math.tan(FIELD / 2)) / this.canvas.clientHeight;
      for (let i = 0; i < 3; i++) this.middle[i] += size * (dy * up[i] - dx * right[i]);
    }

    rotate(dx, dy) {
      this.turn -= dx * 0.008;
      this.rise = Math.max(-1.55, Math.min(1.55, this.rise + dy * 0.008));
    }

    scale(by) {
      this.zoom = Math.max(0.3, Math.min(20, this.zoom * by));
    }

    pointers() {
      const c = this.canvas, down = new Map();
      const spread = () => {
        const [a, b] = [...down.values()];
        return [Math.hypot(a.x - b.x, a.y - b.y), (a.x + b.x) / 2, (a.y + b.y) / 2];
      };
      c.addEventListener("pointerdown", (e) => {
        down.set(e.pointerId, { x: e.clientX, y: e.clientY });
        c.setPointerCapture(e.pointerId);
      });
      c.addEventListener("pointermove", (e) => {
        const before = down.get(e.pointerId);
        if (!before) return;
        const [dx, dy] = [e.clientX - before.x, e.clientY - before.y];
        if (down.size === 2) {
          const [was, x, y] = spread();
          down.set(e.pointerId, { x: e.clientX, y: e.clientY });
          const [now, u, v] = spread();
          this.scale(now / Math.max(was, 1));
          this.move(u - x, v - y);
        } else {
          down.set(e.pointerId, { x: e.clientX, y: e.clientY });
          if (e.shiftKey || e.buttons & 2) this.move(dx, dy);
          else this.rotate(dx, dy);
        }
        this.ask();
      });
      for (const end of ["pointerup", "pointercancel"]) c.addEventListener(end, (e) => down.delete(e.pointerId));
      c.addEventListener("contextmenu", (e) => e.preventDefault());
      c.addEventListener("wheel", (e) => {
        if (document.activeElement !== c) return; // the page scrolls until the picture is chosen
        e.preventDefault();
        this.scale(Math.exp(-e.deltaY * 0.001));
        this.ask();
      }, { passive: false });
      const keys = {
        ArrowLeft: () => this.rotate(12, 0), ArrowRight: () => this.rotate(-12, 0),
        ArrowUp: () => this.rotate(0, 12), ArrowDown: () => this.rotate(0, -12),
        "+": () => this.scale(1.15), "=": () => this.scale(1.15), "-": () => this.scale(1 / 1.15), 0: () => this.home(),
      };
      c.addEventListener("keydown", (e) => {
        if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
        e.preventDefault();
        keys[e.key]();
        this.ask();
      });
    }

    controls() {
      const { data, state } = this, find = this.find;
      const slider = (this.slider = find(".frame")), play = (this.play = find(".play"));
      slider.addEventListener("input", () => {
        this.stop();
        state.frame = Number(slider.value);
        this.show();
      });
      play.addEventListener("click", () => (this.playing ? this.stop() : this.start()));
      find(".reset").addEventListener("click", () => {
        this.home();
        this.ask();
      });
      if (data.colourings.length > 1) {
        const select = find(".colouring select");
        find(".colouring").hidden = false;
        data.colourings.forEach((c, i) => select.add(new Option(c.unit ? `${c.name} [${c.unit}]` : c.name, i)));
        select.addEventListener("change", () => {
          state.colouring = Number(select.value);
          this.show();
        });
      }
      const tick = (name, there) => {
        const box = find(`.${name} input`);
        find(`.${name}`).hidden = !there;
        box.checked = state[name];
        box.addEventListener("change", () => {
          state[name] = box.checked;
          this.ask();
        });
      };
      tick("opened", data.meshes.some((m) => m.opened));
      tick("edges", data.meshes.some((m) => m.edges));
      tick("rest", data.meshes.some((m) => m.rest));
      const key = find(".key");
      for (const m of data.meshes.filter((m) => m.name && (m.frame ?? 0) === 0)) {
        const [r, g, b] = m.colour, item = key.appendChild(document.createElement("li"));
        const patch = item.appendChild(document.createElement("i"));
        patch.style.background = `rgb(${r * 255} ${g * 255} ${b * 255})`;
        item.append(m.name);
        key.hidden = false;
      }
    }

    start() {
      const { data, state } = this;
      this.play.textContent = "Pause";
      if (state.frame === data.labels.length - 1) state.frame = -1;
      const step = () => {
        state.frame += 1;
        this.show();
        if (state.frame === data.labels.length - 1) this.stop();
      };
      step();
      if (state.frame < data.labels.length - 1) this.playing = setInterval(step, data.pace);
    }

    stop() {
      clearInterval(this.playing);
      this.playing = 0;
      this.play.textContent = "Play";
    }

    show() {
      const { data, state, find } = this;
      this.slider.value = state.frame;
      this.slider.setAttribute("aria-valuetext", data.labels[state.frame]);
      find(".readout").textContent = data.labels[state.frame];
      const c = data.colourings[state.colouring], bar = find(".bar");
      bar.hidden = !c;
      if (c) {
        find(".bar .name").textContent = c.unit ? `${c.name} [${c.unit}]` : c.name;
        find(".bar .ramp").style.background = `linear-gradient(to right, ${data.swatches.join(",")})`;
        const ends = find(".bar .ticks").children;
        c.ticks.forEach((t, i) => (ends[i].textContent = t));
      }
      if (this.dot) {
        const at = this.dot.points[state.frame];
        this.dot.circle.setAttribute("cx", at[0]);
        this.dot.circle.setAttribute("cy", at[1]);
      }
      this.ask();
    }

    curve() {
      const c = this.data.curve, svg = this.find(".curve");
      if (!c) return;
      svg.removeAttribute("hidden");
      svg.setAttribute("aria-label", `${c.y_name} over ${c.x_name}`);
      svg.replaceChildren();
      const width = svg.clientWidth || 480;
      svg.setAttribute("viewBox", `0 0 ${width} 130`);
      const put = (name, attributes, text) => {
        const e = document.createElementNS(svg.namespaceURI, name);
        for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
        if (text !== undefined) e.textContent = text;
        return svg.appendChild(e);
      };
      const [left, right, top, bottom] = [52, width - 10, 22, 104];
      const span = (v) => [Math.min(0, ...v), Math.max(0, ...v)];
      const [x0, x1] = c.x_from_zero ? span(c.x) : [Math.min(...c.x), Math.max(...c.x)], [y0, y1] = span(c.y);
      const u = (x) => left + ((x - x0) / (x1 - x0 || 1)) * (right - left);
      const v = (y) => bottom - ((y - y0) / (y1 - y0 || 1)) * (bottom - top);
      const points = c.x.map((x, i) => [u(x).toFixed(1), v(c.y[i]).toFixed(1)]);
      put("path", { class: "axis", d: `M${left} ${top}V${bottom}H${right}` });
      put("polyline", { class: "path", points: points.map((p) => p.join(",")).join(" ") });
      put("text", { x: left, y: 12 }, `${c.y_name} [${c.y_unit}]`);
      put("text", { x: left - 5, y: top + 8, "text-anchor": "end" }, short(y1));
      put("text", { x: left - 5, y: bottom, "text-anchor": "end" }, short(y0));
      put("text", { x: left, y: bottom + 16 }, short(x0));
      put("text", { x: right, y: bottom + 16, "text-anchor": "end" }, short(x1));
      put("text", { x: (left + right) / 2, y: bottom + 16, "text-anchor": "middle" }, c.x_unit ? `${c.x_name} [${c.x_unit}]` : c.x_name);
      this.dot = { circle: put("circle", { class: "dot", r: 5 }), points };
    }
  }

  const short = (x) => String(Number(x.toPrecision(3)));

  for (const section of document.querySelectorAll(".tisim-view:not([data-view])")) {
    section.dataset.view = "";
    new View(section);
  }
})();
