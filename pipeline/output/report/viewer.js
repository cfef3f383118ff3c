// The view of a mesh: reads the arrays in the page (see report_scene.h) and draws them when something
// has changed. The data- attributes of <body> contain data for tests.
"use strict";
(function () {
  const $ = (id) => document.getElementById(id);
  const state = document.body.dataset;
  // Milliseconds since the page was requested.
  const marks = {};
  const mark = (name) => {
    marks[name] = Math.round(performance.now());
    state.marks = JSON.stringify(marks);
  };
  mark("script");
  const info = JSON.parse($("scene").textContent);
  const ranges = info.ranges;

  function bytes(name) {
    const text = atob($("block-" + name).textContent);
    const b = new Uint8Array(text.length);
    for (let i = 0; i < b.length; ++i) b[i] = text.charCodeAt(i);
    return b;
  }
  const has = (name) => $("block-" + name) !== null;
  // Decodes data at the first use, so that the surface appears before it can be cut.
  const once = (make) => {
    let made;
    return () => made === undefined ? (made = make()) : made;
  };
  const indices = (name) => {
    const b = bytes(name);
    return info.index_bytes === 2 ? new Uint16Array(b.buffer) : new Uint32Array(b.buffer);
  };
  // Returns positions relative to the middle of the box, for which single precision suffices.
  function places(name) {
    const steps = new Uint16Array(bytes(name).buffer);
    const x = new Float32Array(steps.length);
    for (let i = 0; i < x.length; ++i) x[i] = (steps[i] / 65535 - 0.5) * info.box_size[i % 3];
    return x;
  }

  // Viridis: perceptually uniform, also in grey and for colour-blind readers.
  const kStops = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];
  const kPatches = ["0072b2", "e69f00", "009e73", "cc79a7", "56b4e9", "d55e00", "f0e442", "999999"];
  const kAlarm = [235, 110, 20];  // visible on light and dark backgrounds, and next to grey
  const rgb = (hex) => [0, 2, 4].map((k) => parseInt(hex.substr(k, 2), 16));
  const ramp = [];
  for (let v = 0; v < 256; ++v) {
    const at = (v / 255) * (kStops.length - 1), k = Math.min(Math.floor(at), kStops.length - 2);
    const a = rgb(kStops[k]), b = rgb(kStops[k + 1]);
    ramp.push(a.map((c, i) => Math.round(c + (at - k) * (b[i] - c))));
  }
  const reversed = ramp.slice().reverse();
  // Grey near samples, and yellow to dark red where no sample supports the surface.
  const kGuess = [[254, 196, 79], [236, 112, 20], [140, 20, 4]], kBacked = [[206, 214, 222], [120, 138, 156]];
  const blend = (a, b, s) => a.map((c, i) => Math.round(c + s * (b[i] - c)));
  const support = [];
  const guessFrom = ranges.support ? Math.min(1, info.support_radius / Math.max(ranges.support[1], 1e-300)) : 1;
  for (let v = 0; v < 256; ++v) {
    const at = v / 255, s = 2 * (at - guessFrom) / Math.max(1 - guessFrom, 1e-9);
    support.push(at <= guessFrom ? blend(kBacked[0], kBacked[1], at / guessFrom)
                 : s < 1 ? blend(kGuess[0], kGuess[1], s) : blend(kGuess[1], kGuess[2], s - 1));
  }
  const patchColours = [];
  for (let v = 0; v < 256; ++v) patchColours.push(rgb(kPatches[v % kPatches.length]));
  const plain = new Array(256).fill([226, 196, 128]);

  // Data of the samples: viridis up to 254, and grey where they are unknown.
  const kNoValue = 255, kUnknown = [150, 155, 165];
  const known = ramp.map((c, v) => v === kNoValue ? kUnknown : ramp[Math.round(v * 255 / 254)]);
  const fields = info.fields.map((f, k) => ({
    id: "field_" + k, name: f.name, legend: f.name, field: f, vertex: "vertex_field_" + k, ramp: f.of_colours ? null : known,
  }));

  // Bright is good: small distances are at the bright end.
  const kinds = [
    {id: "quality", name: "quality (mean ratio)", key: "quality", face: "face_quality", ramp: ramp},
    {id: "deviation", name: "deviation of face centres", legend: "deviation of face centres", key: "deviation", face: "face_deviation", ramp: reversed},
    {id: "support", name: "support (nearest sample)", legend: "distance to the nearest sample", key: "support", vertex: "vertex_support", ramp: support},
    {id: "size", name: "edge length", legend: "mean edge length", key: "edge_length", vertex: "vertex_edge_length", ramp: ramp},
    {id: "patch", name: "patch", face: "face_patch", ramp: patchColours},
    ...fields,
    {id: "none", name: "none", ramp: plain},
  ].filter((k) => !(k.face || k.vertex) || has(k.face || k.vertex));
  for (const kind of kinds) {
    kind.texture = once(() => {
      const texels = new Uint8Array(kind.ramp.flatMap((c) => [...c, 255]));
      const texture = new THREE.DataTexture(texels, 256, 1, THREE.RGBAFormat);
      texture.needsUpdate = true;
      return texture;
    });
    kind.bytes = kind.face || kind.vertex ? once(() => bytes(kind.face || kind.vertex)) : () => null;
    $("colour").add(new Option(kind.name, kind.id));
  }

  const X = places("positions"), F = indices("faces"), nFaces = F.length / 4;
  const tets = once(() => indices("tets")), tetQuality = once(() => bytes("tet_quality"));
  const centroid = (list, k, axis) =>
    (X[3 * list[4 * k] + axis] + X[3 * list[4 * k + 1] + axis] + X[3 * list[4 * k + 2] + axis] +
     X[3 * list[4 * k + 3] + axis]) / 4;
  const kTetFaces = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

  // Triangles that share no corners: each has its own colours, and weights that measure the distance to an edge.
  function Soup(capacity) {
    const position = new Float32Array(9 * capacity), colour = new Uint8Array(9 * capacity);
    let n = 0;
    const put = (at, corner, tint) => {
      for (let i = 0; i < 3; ++i) {
        position[at + i] = X[3 * corner + i];
        colour[at + i] = tint[i];
      }
    };
    this.add = (a, b, c, tintA, tintB, tintC) => {
      put(9 * n, a, tintA);
      put(9 * n + 3, b, tintB);
      put(9 * n + 6, c, tintC);
      ++n;
    };
    this.geometry = () => {
      const weights = new Uint8Array(9 * n);
      for (let v = 0; v < 3 * n; ++v) weights[3 * v + (v % 3)] = 1;
      const g = new THREE.BufferGeometry();
      g.setAttribute("position", new THREE.BufferAttribute(position.subarray(0, 9 * n), 3));
      g.setAttribute("tint", new THREE.BufferAttribute(colour.subarray(0, 9 * n), 3, true));
      g.setAttribute("weight", new THREE.BufferAttribute(weights, 3));
      return g;
    };
  }

  function material(options) {
    return new THREE.ShaderMaterial(Object.assign({
      uniforms: {edges: {value: 1}, opacity: {value: 1}, ramped: {value: 0}, ramp: {value: null}},
      side: THREE.DoubleSide,
      extensions: {derivatives: true},
      vertexShader: `
        attribute vec3 tint; attribute vec3 weight;
        varying vec3 at, colour, corner;
        void main() {
          vec4 p = modelViewMatrix * vec4(position, 1.0);
          at = p.xyz; colour = tint; corner = weight;
          gl_Position = projectionMatrix * p;
        }`,
      fragmentShader: `
        uniform float edges, opacity, ramped;
        uniform sampler2D ramp;
        varying vec3 at, colour, corner;
        void main() {
          vec3 tint = ramped > 0.5 ? texture2D(ramp, vec2((colour.r * 255.0 + 0.5) / 256.0, 0.5)).rgb : colour;
          vec3 n = normalize(cross(dFdx(at), dFdy(at)));
          float light = 0.42 + 0.63 * abs(dot(n, normalize(vec3(0.25, 0.45, 1.0))));
          vec3 d = corner / max(fwidth(corner), 1e-9);
          float line = 1.0 - smoothstep(0.3, 1.3, min(min(d.x, d.y), d.z));
          // Where triangles are only a few pixels wide, their edges would hide everything else.
          float size = 1.0 / max(max(fwidth(corner.x), fwidth(corner.y)), fwidth(corner.z));
          line *= edges * 0.55 * smoothstep(2.0, 9.0, size);
          gl_FragColor = vec4(mix(tint * light, vec3(0.05), line), opacity);
        }`,
    }, options));
  }

  mark("decoded");
  let renderer = null;
  try {
    renderer = new THREE.WebGLRenderer({canvas: $("canvas"), antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch (e) {
    state.webgl = "missing";
    $("no-webgl").hidden = false;
    $("legend").hidden = true;
    state.ready = Math.round(performance.now());
    return;
  }
  mark("webgl");
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.setClearColor(0, 0);
  const world = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(28, 1, 0.01, 100);
  // The surface lies on the faces of tets behind it, so it is drawn slightly in front.
  const surface = new THREE.Mesh(new THREE.BufferGeometry(),
                                 material({polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1}));
  const inside = new THREE.Mesh(new THREE.BufferGeometry(), material({}));
  const radius = Math.max(Math.hypot(...info.box_size) / 2, 1e-300);
  // Half of the samples are behind the flat faces made from them, so they are drawn slightly closer.
  const cloud = new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial({
    vertexShader: `
      void main() {
        vec4 p = modelViewMatrix * vec4(position, 1.0);
        p.xyz *= 0.994;
        gl_Position = projectionMatrix * p;
        gl_PointSize = 3.0;
      }`,
    fragmentShader: "void main() { gl_FragColor = vec4(0.85, 0.11, 0.38, 1.0); }",
  }));
  const samples = once(() => cloud.geometry.setAttribute("position", new THREE.BufferAttribute(places("points"), 3)));
  if (info.n_points_shown === 0) $("cloud-row").hidden = true;
  // Sharp edges of the body, as pairs of ends, slightly in front of the surface.
  const ends = has("curves") ? places("curves") : new Float32Array(0);
  const curves = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.ShaderMaterial({
    vertexShader: `
      void main() {
        vec4 p = modelViewMatrix * vec4(position, 1.0);
        p.xyz *= 0.998;
        gl_Position = projectionMatrix * p;
      }`,
    fragmentShader: "void main() { gl_FragColor = vec4(0.75, 0.05, 0.1, 1.0); }",
  }));
  for (const part of [surface, inside, cloud, curves]) {
    part.frustumCulled = false;
    world.add(part);
  }
  surface.renderOrder = 1;
  cloud.renderOrder = curves.renderOrder = 2;

  const setGeometry = (part, soup) => {
    part.geometry.dispose();
    part.geometry = soup.geometry();
  };

  function plane() {
    const axis = $("axis").value;
    if (axis === "") return null;
    const a = Number(axis), sign = $("flip").checked ? -1 : 1;
    return {axis: a, sign: sign, at: sign * (Number($("place").value) - 0.5) * info.box_size[a]};
  }

  function build() {
    const kind = kinds.find((k) => k.id === $("colour").value), cut = plane(), worst = $("worst").checked;
    const behind = (list, k) => !cut || cut.sign * centroid(list, k, cut.axis) <= cut.at;
    const shell = new Soup(nFaces), values = kind.bytes(), grey = [150, 155, 165];
    const tint = (v) => worst || !kind.ramp ? grey : kind.ramp[v];
    // Values at vertices, not colours, are linear on a face, so that boundaries between colours are at the correct values.
    const ramped = Boolean(kind.vertex && kind.ramp) && !worst;
    // A face with a corner without a value has no value.
    const unknown = (corners) => kind.field && corners.some((v) => values[v * (kind.ramp ? 1 : 3)] === kNoValue);
    const coloured = (v) => [0, 1, 2].map((k) => Math.round(values[3 * v + k] * 255 / 254));
    surface.material.uniforms.ramped.value = ramped ? 1 : 0;
    if (ramped) surface.material.uniforms.ramp.value = kind.texture();
    for (let f = 0; f < nFaces; ++f) {
      if (!behind(F, f)) continue;
      const a = F[4 * f], b = F[4 * f + 1], c = F[4 * f + 2];
      if (ramped) {
        const none = unknown([a, b, c]);
        shell.add(a, b, c, ...[a, b, c].map((v) => [none ? kNoValue : values[v], 0, 0]));
      } else if (kind.field && !worst) {
        const none = unknown([a, b, c]);
        shell.add(a, b, c, ...[a, b, c].map((v) => none ? kUnknown : coloured(v)));
      } else {
        const one = tint(values ? values[f] : 0);
        shell.add(a, b, c, one, one, one);
      }
    }
    setGeometry(surface, shell);
    const nWorst = Math.min(Number($("worst-number").value), info.n_worst);
    setGeometry(inside, worst || cut ? tetsInside(cut, worst ? nWorst : 0, behind) : new Soup(0));
    const glass = worst ? 0.13 : 1;
    surface.material.transparent = worst;
    surface.material.depthWrite = !worst;
    surface.material.uniforms.opacity.value = glass;
    surface.material.uniforms.edges.value = $("edges").checked && !worst ? 1 : 0;
    inside.material.uniforms.edges.value = $("edges").checked ? 1 : 0;
    const shown = [];
    for (let i = 0; i < ends.length; i += 6) {
      const middle = cut && (ends[i + cut.axis] + ends[i + 3 + cut.axis]) / 2;
      if (!cut || cut.sign * middle <= cut.at) shown.push(...ends.subarray(i, i + 6));
    }
    curves.geometry.dispose();
    curves.geometry = new THREE.BufferGeometry();
    curves.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(shown), 3));
    curves.visible = shown.length > 0;
    state.curves = shown.length / 6;
    cloud.visible = $("cloud").checked && info.n_points_shown > 0;
    if (cloud.visible) samples();
    $("worst-count").value = nWorst;
    legend(cut && kind.id === "none" ? kinds[0] : kind);
    if (worst) {
      const [least, most] = ranges.quality, q = least + (tetQuality()[nWorst - 1] / 255) * (most - least);
      $("legend").textContent = `the ${nWorst} worst tets: mean ratio ${number(least)} to ${q.toFixed(3)}`;
    }
  }

  // The worst tets alone, or the tets at the cut.
  function tetsInside(cut, nWorst, behind) {
    const T = tets(), Q = tetQuality(), taken = [];
    const drawn = (t) => {
      const c = cut.sign * centroid(T, t, cut.axis);
      return c <= cut.at && c > cut.at - info.layer;
    };
    for (let t = 0; t < (nWorst || T.length / 4); ++t) if (nWorst ? behind(T, t) : drawn(t)) taken.push(t);
    const solid = new Soup(4 * taken.length);
    for (const t of taken) {
      const c = nWorst ? kAlarm : ramp[Q[t]];
      for (const face of kTetFaces) solid.add(T[4 * t + face[0]], T[4 * t + face[1]], T[4 * t + face[2]], c, c, c);
    }
    return solid;
  }

  const number = (v) => String(Number(v.toPrecision(4)));
  function legend(kind) {
    $("legend").textContent = "";
    const add = (cls, parent) => {
      const e = document.createElement("div");
      e.className = cls;
      return parent.appendChild(e);
    };
    if (kind.face === "face_patch") return patchLegend(add);
    if (!kind.key && !kind.field) return;
    add("name", $("legend")).textContent =
      kind.key === "quality" ? "mean ratio Q" : kind.legend + (kind.field ? "; grey: no value" : ", model units");
    if (!kind.ramp) return;
    add("bar", $("legend")).style.background =
      "linear-gradient(90deg," + Array.from({length: 52}, (_, k) => 5 * k).map((v) => `rgb(${kind.ramp[Math.min(v, kNoValue - 1)].join()})`).join() + ")";
    const ends = add("ends", $("legend"));
    for (const v of kind.field ? kind.field.range : ranges[kind.key]) ends.appendChild(document.createElement("span")).textContent = number(v);
    if (kind.id === "support") supportLegend(add);
  }

  // States where on the bar the guess begins.
  function supportLegend(add) {
    const far = number(info.support_radius), note = add("name", $("legend"));
    if (guessFrom === 1) {
      note.textContent = `no point is farther than ${far} (3 spacings) from the nearest sample`;
      return;
    }
    note.textContent = `yellow to red: a guess, farther than ${far} (3 spacings) from the nearest sample`;
  }

  // Lists the largest patches by name, with their shares of the area.
  function patchLegend(add) {
    const whole = info.patches.reduce((sum, p) => sum + p.area, 0), kMost = 16;
    const order = info.patches.map((p, k) => k).sort((a, b) => info.patches[b].area - info.patches[a].area || a - b);
    for (const k of order.slice(0, kMost)) {
      const row = add("patch", $("legend")), p = info.patches[k];
      row.dataset.number = p.number;
      row.appendChild(document.createElement("i")).style.background = `rgb(${patchColours[k % 256].join()})`;
      row.appendChild(document.createElement("span")).textContent = p.name;
      row.appendChild(document.createElement("span")).textContent = (100 * p.area / whole).toFixed(1) + " %";
    }
    if (order.length > kMost) add("name", $("legend")).textContent = `and ${order.length - kMost} smaller patches`;
  }

  // A turntable around a target: angles, distance relative to the home position, target.
  const kHome = {turn: 0.6, lift: 0.35, away: 1};
  let eye = Object.assign({x: 0, y: 0, z: 0}, kHome);
  function axes() {
    const up = Number($("up").value), e = (k) => new THREE.Vector3().setComponent(k % 3, 1);
    return {up: e(up), right: e(up + 1), front: e(up + 2)};
  }
  /** The direction towards the camera. */
  function back(a, {turn, lift}) {
    const cos = Math.cos(lift);
    return new THREE.Vector3().addScaledVector(a.front, cos * Math.cos(turn)).addScaledVector(a.right, cos * Math.sin(turn))
      .addScaledVector(a.up, Math.sin(lift));
  }
  const kSlope = Math.tan(camera.fov * Math.PI / 360);
  /** The minimum distance from which the whole body is visible, with a margin of a twentieth. */
  function homeDistance(a) {
    const of = `${$("up").value} ${camera.aspect}`;
    if (homeDistance.of === of) return homeDistance.is;
    const w = back(a, kHome), u = new THREE.Vector3().crossVectors(a.up, w).normalize();
    const v = new THREE.Vector3().crossVectors(w, u), high = 0.95 * kSlope, wide = high * camera.aspect;
    const p = new THREE.Vector3();
    let far = 0.01 * radius;
    for (let i = 0; i < X.length; i += 3) {
      p.fromArray(X, i);
      far = Math.max(far, p.dot(w) + Math.max(Math.abs(p.dot(v)) / high, Math.abs(p.dot(u)) / wide));
    }
    Object.assign(homeDistance, {of, is: far});
    return far;
  }
  function draw() {
    if (draw.asked) return;
    draw.asked = true;
    requestAnimationFrame(render);
  }
  function render() {
    draw.asked = false;
    const box = $("canvas").parentElement.getBoundingClientRect();
    renderer.setSize(box.width, box.height, false);
    camera.aspect = box.width / Math.max(box.height, 1);
    const a = axes(), far = eye.away * homeDistance(a);
    const target = new THREE.Vector3(eye.x, eye.y, eye.z);
    camera.position.copy(target).addScaledVector(back(a, eye), far);
    camera.up.copy(a.up);
    camera.lookAt(target);
    camera.near = Math.max(far - 4 * radius, far * 0.02);
    camera.far = far + 4 * radius;
    camera.updateProjectionMatrix();
    renderer.render(world, camera);
  }

  // Counts the pixels that are not background, once, so that a test can check whether there is a picture.
  function ready() {
    const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
    const pixels = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let n = 0;
    for (let i = 3; i < pixels.length; i += 4) n += pixels[i] > 0;
    state.pixels = n;
    state.webgl = "drawn";
    state.ready = Math.round(performance.now());
  }

  const canvas = $("canvas");
  let grip = null;
  canvas.addEventListener("pointerdown", (e) => {
    grip = {x: e.clientX, y: e.clientY, move: e.shiftKey || e.button === 2};
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointerup", () => { grip = null; });
  canvas.addEventListener("pointercancel", () => { grip = null; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("pointermove", (e) => {
    if (!grip) return;
    const dx = (e.clientX - grip.x) / canvas.clientHeight, dy = (e.clientY - grip.y) / canvas.clientHeight;
    grip.x = e.clientX;
    grip.y = e.clientY;
    if (grip.move) {
      const m = camera.matrixWorld.elements, s = 2 * kSlope * eye.away * homeDistance(axes());
      eye.x += s * (dy * m[4] - dx * m[0]);
      eye.y += s * (dy * m[5] - dx * m[1]);
      eye.z += s * (dy * m[6] - dx * m[2]);
    } else {
      eye.turn -= 4 * dx;
      eye.lift = Math.max(-1.55, Math.min(1.55, eye.lift + 4 * dy));
    }
    draw();
  });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    eye.away = Math.max(0.02, Math.min(5, eye.away * Math.exp(0.001 * e.deltaY)));
    draw();
  }, {passive: false});
  // Shows a region of the surface: the camera looks at it from outside, so close that it fills a third of the view. Its
  // faces are the faces without an omitted corner.
  function lookAt(where, wide, isLeftOut) {
    $("axis").value = "";
    $("worst").checked = false;
    build();
    const middle = new THREE.Vector3(...where.map((c, i) => c - info.box_min[i] - info.box_size[i] / 2));
    const normal = new THREE.Vector3();
    const [p, q, r] = [0, 1, 2].map(() => new THREE.Vector3());
    for (let f = 0; f < nFaces; ++f) {
      const corners = [F[4 * f], F[4 * f + 1], F[4 * f + 2]];
      if (corners.some(isLeftOut)) continue;
      p.fromArray(X, 3 * corners[0]);
      q.fromArray(X, 3 * corners[1]).sub(p);
      r.fromArray(X, 3 * corners[2]).sub(p);
      if (p.distanceTo(middle) <= wide) normal.add(q.cross(r));
    }
    if (normal.lengthSq() === 0) normal.copy(middle);
    normal.normalize();
    const a = axes();
    eye = {x: middle.x, y: middle.y, z: middle.z, turn: Math.atan2(normal.dot(a.right), normal.dot(a.front)) + 0.3,
           lift: Math.max(-1.2, Math.min(1.2, Math.asin(normal.dot(a.up)))), away: 1};
    eye.away = Math.max(0.02, Math.min(1, 3 * wide / (2 * kSlope) / homeDistance(a)));
    draw();
  }
  const certificate = JSON.parse($("certificate").textContent);
  const holes = certificate.domain.closed_holes || [], spots = certificate.places.listed;
  function showHole(hole) {
    const values = bytes("vertex_support");
    $("colour").value = "support";
    lookAt(hole.centre, Math.max(hole.rim.diameter, Math.sqrt(hole.area)), (v) => values[v] / 255 <= guessFrom);
  }
  function showPlace(place) {
    lookAt(place.where, (4 + place.size_over_h) * certificate.h, () => false);
  }
  for (const [kind, list, show] of [["hole", holes, showHole], ["place", spots, showPlace]]) {
    for (const button of document.querySelectorAll(`button[data-${kind}]`)) {
      button.addEventListener("click", () => {
        show(list[Number(button.dataset[kind])]);
        canvas.scrollIntoView({block: "center"});
      });
    }
  }
  $("home").addEventListener("click", () => {
    eye = Object.assign({x: 0, y: 0, z: 0}, kHome);
    draw();
  });
  window.addEventListener("resize", draw);

  // The page contains only tets at the middle planes of a large mesh.
  if (info.planes !== null) {
    for (const option of Array.from($("axis").options)) {
      if (option.value !== "" && !info.planes.includes(Number(option.value))) option.remove();
    }
    $("place").disabled = true;
  }
  $("worst-number").max = info.n_worst;
  // #colour=patch&axis=0&worst=1: the initial view; #hole=1: the first hole that was closed; #spot=1: the first defect.
  const asked = new URLSearchParams(location.hash.slice(1));
  const hole = holes[Number(asked.get("hole")) - 1], spot = spots[Number(asked.get("spot")) - 1];
  if (hole) showHole(hole);
  if (spot) showPlace(spot);
  for (const [id, value] of asked) {
    const control = $(id);
    if (!control || !control.form) continue;
    if (control.type === "checkbox") control.checked = value === "1";
    else control.value = value;
  }
  for (const control of $("controls").elements) {
    if (control.type !== "button" && control.tagName !== "FIELDSET") control.addEventListener("input", () => {
      build();
      draw();
    });
  }
  build();
  mark("built");
  render();
  ready();
})();
