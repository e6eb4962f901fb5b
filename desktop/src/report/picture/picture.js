// The flexspline in three dimensions, drawn with WebGL from the numbers that the page holds.
//
// displacement(i, j) = tau*twist_j + ellipse_j at b,  b = a_i - t,  t = theta_wg - theta_fs,  a_i = 2*pi*i/N
// strain(i, j)       = six numbers of slice j at s = t - a_i, as in desktop/src/report/picture/shape.rs
//
// SI units and radians. z points from the rim (0) to the flange. Positions are magnified only in `place`.
"use strict";
(() => {
  const TAU = 2 * Math.PI;
  const element = (id) => document.getElementById(id);
  const data = JSON.parse(element("picture-data").textContent);
  const unpack = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const [N, M] = data.nodes;
  const [R, LENGTH, W0] = data.cup;
  const [twist, ellipse] = [unpack(data.twist), unpack(data.ellipse)];
  const kinds = data.kinds.map((kind) => ({ ...kind, series: unpack(kind.series) }));
  const motions = data.motions.map((motion) => ({ ...motion, frames: unpack(motion.frames) }));

  // ---- The model's law ----

  function displacement(a, j, torque, t) {
    const b = 2 * (a - t), [c, s] = [Math.cos(b), Math.sin(b)];
    return [ellipse[3 * j] * c, ellipse[3 * j + 1] * s + torque * R * twist[j], ellipse[3 * j + 2] * c];
  }

  function strain(series, a, j, torque, t, part) {
    const byTorque = series[6 * j + 1] * torque;
    if (part === 1) return byTorque;
    const s = 2 * (t - a), [c, d] = [Math.cos(s), Math.sin(s)];
    return series[6 * j] + byTorque + series[6 * j + 2] * c + series[6 * j + 3] * d
      + series[6 * j + 4] * (c * c - d * d) + series[6 * j + 5] * 2 * c * d;
  }

  // Compares with what the model itself gave for some nodes; the largest differences.
  function check() {
    const rows = unpack(data.checks);
    let [strains, places] = [0, 0];
    for (let k = 0; k < rows.length; k += 9) {
      const [kind, i, j, torque, t, expected, ...place] = rows.subarray(k, k + 9);
      const a = TAU * i / N;
      strains = Math.max(strains, Math.abs(strain(kinds[kind].series, a, j, torque, t, 0) - expected));
      displacement(a, j, torque, t).forEach((x, n) => { places = Math.max(places, Math.abs(x - place[n])); });
    }
    return { count: rows.length / 9, strains, places };
  }
  const checked = check();
  element("checked").textContent = `Checked by this page against the model at ${checked.count} places: strain within `
    + `${(checked.strains * 1e6).toFixed(2)} µm/m, place within ${(checked.places * 1e9).toFixed(2)} nm.`;

  // ---- State ----

  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const value = (id) => Number(element(id).value);
  const view = { yaw: 0.6, pitch: 0.75, distance: 3.5 };
  let [playing, time, last, motion, kind, dirty] = [!still.matches, 0, null, motions[value("motion")], kinds[value("kind")], true];
  const duration = () => motion.interval * (motion.frames.length / 4 - 1);

  // Frame at the time, between two of the frames there are: wave generator, flange, torque, torsion.
  function frame() {
    const at = Math.min(time / motion.interval, motion.frames.length / 4 - 1);
    const before = Math.floor(at), after = Math.min(before + 1, motion.frames.length / 4 - 1), part = at - before;
    return [0, 1, 2, 3].map((n) => motion.frames[4 * before + n] * (1 - part) + motion.frames[4 * after + n] * part);
  }

  // ---- Surfaces: position, normal and colour of each corner, three numbers each ----

  class Surface {
    constructor(corners, triangles) {
      this.vertices = new Float32Array(9 * corners);
      this.triangles = new Uint16Array(triangles);
    }

    put(corner, [x, y, z], [r, g, b]) {
      this.vertices.set([x, y, z, 0, 0, 0, r, g, b], 9 * corner);
    }

    // Normals as the mean of those of the triangles around a corner.
    light() {
      const [v, t] = [this.vertices, this.triangles];
      for (let k = 0; k < t.length; k += 3) {
        const [a, b, c] = [9 * t[k], 9 * t[k + 1], 9 * t[k + 2]];
        const [ux, uy, uz] = [v[b] - v[a], v[b + 1] - v[a + 1], v[b + 2] - v[a + 2]];
        const [wx, wy, wz] = [v[c] - v[a], v[c + 1] - v[a + 1], v[c + 2] - v[a + 2]];
        const [nx, ny, nz] = [uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx];
        for (const at of [a, b, c]) { v[at + 3] += nx; v[at + 4] += ny; v[at + 5] += nz; }
      }
    }
  }

  // Triangles of a closed strip of `rows` rings of `count` corners.
  function strip(count, rows) {
    const triangles = [];
    for (let j = 0; j + 1 < rows; j++) {
      for (let i = 0; i < count; i++) {
        const [a, b] = [j * count + i, j * count + (i + 1) % count];
        triangles.push(a, b, a + count, b, b + count, a + count);
      }
    }
    return triangles;
  }

  const STEEL = [0.62, 0.65, 0.7], DARK = [0.36, 0.39, 0.45], BRASS = [0.8, 0.66, 0.3], MARK = [0.9, 0.1, 0.35];
  const [BLUE, MIDDLE, ORANGE] = [[0, 0.35, 0.75], [0.93, 0.93, 0.93], [0.84, 0.33, 0]];
  const mixed = (a, b, part) => a.map((x, n) => x + (b[n] - x) * part);
  const colour = (x) => x < 0 ? mixed(MIDDLE, BLUE, Math.min(-x, 1)) : mixed(MIDDLE, ORANGE, Math.min(x, 1));

  // Place of a point of the cup at slice j, `out` (m) outside its middle surface: the ellipse magnified, the torsion magnified from
  // the rim on, so that the teeth stay where they are.
  function place(a, j, now, out = 0) {
    const [wave, flange, torque] = now;
    const rim = flange + torque * twist[0];
    const [radial, tangential, axial] = displacement(a, j, 0, wave - flange).map((x) => x * now.magnified);
    const angle = a + rim - now.wound * torque * (twist[0] - twist[j]);
    const [c, s, r] = [Math.cos(angle), Math.sin(angle), R + out + radial];
    return [r * c - tangential * s, r * s + tangential * c, LENGTH * j / (M - 1) + axial];
  }

  const RING = 360, TOOTH = 4;
  const [FLEXSPLINE, CIRCULAR] = data.teeth;
  const HEIGHT = 1.1 * W0, FACE = 0.2 * LENGTH;
  const cup = new Surface(N * M, strip(N, M));
  const floor = new Surface(RING * 2, strip(RING, 2));
  const teeth = new Surface(FLEXSPLINE * TOOTH * 3, strip(FLEXSPLINE * TOOTH, 3));
  const circular = new Surface(CIRCULAR * TOOTH * 4, strip(CIRCULAR * TOOTH, 4));
  const generator = new Surface(RING * 3, strip(RING, 3));
  const solids = [cup, floor, teeth, circular, generator];
  const edges = [];
  for (let j = 0; j < M; j++) {
    for (let i = 0; i < N; i++) {
      edges.push(j * N + i, j * N + (i + 1) % N);
      if (j + 1 < M) edges.push(j * N + i, (j + 1) * N + i);
    }
  }
  const lines = new Uint16Array(edges);

  function shapeCup(now) {
    const part = value("part"), scale = kind.scales[part];
    for (let j = 0; j < M; j++) {
      for (let i = 0; i < N; i++) {
        const a = TAU * i / N;
        const found = strain(kind.series, a, j, now[2], now[0] - now[1], part);
        cup.put(j * N + i, place(a, j, now), colour(found / scale));
      }
    }
  }

  // The flange, with a mark at the zero angle.
  function shapeFloor(now) {
    for (let i = 0; i < RING; i++) {
      const a = TAU * i / RING, [x, y, z] = place(a, M - 1, now), marked = i < 5 || i > RING - 5 ? MARK : DARK;
      floor.put(i, [x, y, z], marked);
      floor.put(RING + i, [0.2 * x, 0.2 * y, z], marked);
    }
  }

  // Four corners a tooth: two at the root, two at the tip. Depth 0 at the root, 1 at the tip.
  const CORNERS = [[-0.42, 0], [-0.14, 1], [0.14, 1], [0.42, 0]];

  function shapeTeeth(now) {
    const count = FLEXSPLINE * TOOTH;
    for (let k = 0; k < count; k++) {
      const [across, depth] = CORNERS[k % TOOTH];
      const a = TAU * (Math.floor(k / TOOTH) + across) / FLEXSPLINE;
      const [x, y, z] = place(a, 0, now, HEIGHT * depth), [u, v] = place(a, 0, now);
      const tint = k < TOOTH ? MARK : STEEL;
      teeth.put(k, [u, v, z], tint);
      teeth.put(count + k, [x, y, z], tint);
      teeth.put(2 * count + k, [x, y, z + FACE], tint);
    }
  }

  // Gaps where the flexspline has teeth: at a wave generator at 0 a tooth of the flexspline stands in gap 0.
  function shapeCircular(now) {
    const count = CIRCULAR * TOOTH, root = R + now.magnified * W0 + 1.15 * HEIGHT, outer = 1.1 * root;
    for (let k = 0; k < count; k++) {
      const [across, depth] = CORNERS[k % TOOTH];
      const a = TAU * (Math.floor(k / TOOTH) + 0.5 + across) / CIRCULAR;
      const [c, s, r] = [Math.cos(a), Math.sin(a), root - HEIGHT * depth];
      circular.put(k, [r * c, r * s, FACE], DARK);
      circular.put(count + k, [r * c, r * s, 0], DARK);
      circular.put(2 * count + k, [outer * c, outer * s, 0], DARK);
      circular.put(3 * count + k, [outer * c, outer * s, FACE], DARK);
    }
  }

  // An elliptic plug within the rim, its major axis marked.
  function shapeGenerator(now) {
    const [wave, flange] = now, untwisted = Object.assign([wave, flange, 0, 0], { magnified: now.magnified, wound: 0 });
    for (let i = 0; i < RING; i++) {
      // Angle from the major axis, so that the mark stays on it.
      const b = TAU * i / RING, [x, y] = place(b + wave - flange, 0, untwisted, -0.03 * R);
      const marked = Math.abs(Math.sin(b)) < 0.06 ? MARK : BRASS;
      generator.put(i, [x, y, 0.5 * FACE], marked);
      generator.put(RING + i, [x, y, 0], marked);
      generator.put(2 * RING + i, [0.3 * x, 0.3 * y, 0], marked);
    }
  }

  // ---- WebGL ----

  const canvas = element("scene");
  const gl = canvas.getContext("webgl", { alpha: false, antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    canvas.hidden = true;
    element("no-webgl").hidden = false;
    return;
  }

  const VERTEX = `attribute vec3 position, normal, tint; uniform mat4 camera; uniform float nearer; varying vec3 n, c;
    void main() { gl_Position = camera * vec4(position, 1.0); gl_Position.z -= nearer * gl_Position.w; n = normal; c = tint; }`;
  const FRAGMENT = `precision mediump float; varying vec3 n, c; uniform vec3 eye; uniform float flat_tint;
    void main() { float lit = 0.45 + 0.55 * abs(dot(normalize(n), eye));
      gl_FragColor = vec4(flat_tint > 0.5 ? vec3(0.1) : c * lit, flat_tint > 0.5 ? 0.35 : 1.0); }`;
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  ["position", "normal", "tint"].forEach((name, at) => gl.bindAttribLocation(program, at, name));
  gl.linkProgram(program);
  gl.useProgram(program);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const [cameraAt, eyeAt, flatAt, nearerAt] = ["camera", "eye", "flat_tint", "nearer"].map(uniform);
  [0, 1, 2].forEach((at) => gl.enableVertexAttribArray(at));
  gl.enable(gl.DEPTH_TEST);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  const indices = (array) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return buffer;
  };
  for (const solid of solids) [solid.buffer, solid.indices] = [gl.createBuffer(), indices(solid.triangles)];
  const lineIndices = indices(lines);

  // Perspective camera around the middle of the cup; the rim is up.
  function camera() {
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    const right = [cy, sy, 0], away = [-sy * cp, cy * cp, sp], up = [-sy * sp, cy * sp, -cp];
    const middle = 0.45 * LENGTH, distance = view.distance * R, focal = 2.2;
    const aspect = canvas.width / canvas.height, near = 0.1 * R, far = 20 * R;
    const row = (axis, shift) => [...axis, -axis[2] * middle + shift];
    const [x, y, w] = [row(right, 0).map((k) => k * focal / aspect), row(up, 0).map((k) => k * focal), row(away, distance)];
    const [scale, offset] = [(far + near) / (far - near), -2 * far * near / (far - near)];
    const z = w.map((k, n) => k * scale + (n === 3 ? offset : 0));
    gl.uniformMatrix4fv(cameraAt, false, [0, 1, 2, 3].flatMap((n) => [x[n], y[n], z[n], w[n]]));
    gl.uniform3fv(eyeAt, away);
  }

  function draw(solid, upload) {
    gl.bindBuffer(gl.ARRAY_BUFFER, solid.buffer);
    if (upload) {
      solid.light();
      gl.bufferData(gl.ARRAY_BUFFER, solid.vertices, gl.DYNAMIC_DRAW);
    }
    [0, 1, 2].forEach((at) => gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 36, 12 * at));
  }

  function paper() {
    const found = getComputedStyle(document.body).backgroundColor.match(/\d+/g) || [255, 255, 255];
    return found.slice(0, 3).map((part) => part / 255);
  }

  const hidden = (solid) => (solid === generator && !element("generator").checked)
    || (solid === circular && !element("spline").checked);

  function render() {
    const width = Math.round(canvas.clientWidth * devicePixelRatio) || 960;
    const height = Math.round(canvas.clientHeight * devicePixelRatio) || 600;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const now = Object.assign(frame(), { magnified: value("ellipse"), wound: value("torsion") });
    [shapeCup, shapeFloor, shapeTeeth, shapeCircular, shapeGenerator].forEach((shape) => shape(now));
    gl.viewport(0, 0, width, height);
    gl.clearColor(...paper(), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    camera();
    gl.disable(gl.BLEND);
    gl.uniform1f(flatAt, 0);
    gl.uniform1f(nearerAt, 0);
    for (const solid of solids) {
      if (hidden(solid)) continue;
      draw(solid, true);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, solid.indices);
      gl.drawElements(gl.TRIANGLES, solid.triangles.length, gl.UNSIGNED_SHORT, 0);
    }
    if (element("links").checked) {
      gl.enable(gl.BLEND);
      gl.uniform1f(flatAt, 1);
      gl.uniform1f(nearerAt, 1e-3);
      draw(cup, false);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, lineIndices);
      gl.drawElements(gl.LINES, lines.length, gl.UNSIGNED_SHORT, 0);
    }
    tell(now);
  }

  // ---- What is read and set ----

  function tell([wave, flange, torque, torsion]) {
    const fixed = (x, digits) => x.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
    element("readout").textContent = `${fixed(time, 4)} s of ${fixed(duration(), 3)} s; torque ${fixed(torque, 2)} N m; torsion `
      + `${fixed(torsion * 1e3, 3)} mrad; wave generator ${fixed(wave / TAU, 3)} rev; output ${fixed(flange * 1e3, 2)} mrad`;
    const end = (kind.scales[value("part")] * 1e6).toFixed(0);
    [element("least").textContent, element("most").textContent] = [`−${end}`, `+${end}`];
    for (const id of ["ellipse", "torsion"]) element(`${id}-times`).textContent = element(id).value;
  }

  function play(on) {
    [playing, last] = [on, null];
    element("play").textContent = on ? "Pause" : "Play";
    if (on && time >= duration()) time = 0;
    dirty = true;
  }

  let visible = true;
  function tick(stamp) {
    if (playing && visible && last !== null) {
      time += Math.min(stamp - last, 100) * 1e-3 * value("speed");
      if (time > duration()) time = 0;
      element("time").value = time / duration();
      dirty = true;
    }
    last = stamp;
    if (dirty && visible) { dirty = false; render(); }
    requestAnimationFrame(tick);
  }

  const redraw = () => { dirty = true; };
  element("play").addEventListener("click", () => play(!playing));
  element("time").addEventListener("input", () => { play(false); time = value("time") * duration(); });
  element("motion").addEventListener("change", () => { motion = motions[value("motion")]; time = 0; element("time").value = 0; redraw(); });
  element("kind").addEventListener("change", () => { kind = kinds[value("kind")]; redraw(); });
  for (const id of ["part", "ellipse", "torsion", "links", "generator", "spline"]) element(id).addEventListener("input", redraw);
  const turn = (yaw, pitch) => {
    view.yaw += yaw;
    view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + pitch));
    redraw();
  };
  const zoom = (factor) => { view.distance = Math.max(1.8, Math.min(12, view.distance * factor)); redraw(); };
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); canvas.focus(); });
  canvas.addEventListener("pointermove", (event) => { if (event.buttons) turn(-0.008 * event.movementX, 0.008 * event.movementY); });
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    zoom(Math.exp(1e-3 * event.deltaY));
  }, { passive: false });
  const KEYS = {
    ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
    "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1.1), " ": () => play(!playing),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!KEYS[event.key]) return;
    event.preventDefault();
    KEYS[event.key]();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  still.addEventListener("change", () => { if (still.matches) play(false); });
  addEventListener("resize", redraw);
  addEventListener("beforeprint", () => render());
  if ("IntersectionObserver" in window) {
    new IntersectionObserver(([entry]) => { visible = entry.isIntersecting; last = null; dirty = true; }).observe(canvas);
  }
  play(playing);
  render();
  requestAnimationFrame(tick);
})();
