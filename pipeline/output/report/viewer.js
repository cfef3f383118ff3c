// The controls of the page: stages, camera, colours, cut, marks. The data- attributes of <body> contain data for tests.
"use strict";
(function () {
  const {strip, certificate, stages, layers, origin, radius, ramp, patchColours, kNoValue, number} = umtetScenes;
  const {View, marks, kTetFaces} = umtetView;
  const $ = (id) => document.getElementById(id);
  const state = document.body.dataset;
  const element = (tag, text, parent, cls) => {
    const e = document.createElement(tag);
    if (text) e.textContent = text;
    if (cls) e.className = cls;
    return parent ? parent.appendChild(e) : e;
  };
  // Milliseconds since the page was requested.
  const times = {};
  const mark = (name) => {
    times[name] = Math.round(performance.now());
    state.marks = JSON.stringify(times);
  };
  mark("script");

  // ---- the strip of stages
  let at = Math.max(0, stages.findIndex((s) => s.id === strip.shown));
  const isCause = (stage) => strip.blame !== null && strip.blame.stage === stage.id;
  stages.forEach((stage, k) => {
    const button = element("button", "", $("strip"));
    button.type = "button";
    button.id = "stage-" + stage.id;
    const isBlamed = isCause(stage);
    if (isBlamed) button.classList.add("blamed");
    stage.thumb = element("canvas", "", button);
    stage.thumb.width = 200;
    stage.thumb.height = 136;
    element("b", stage.name, button);
    element("span", isBlamed ? "cause of the failure" : stage.facts.some(([what]) => what === "no result") ? "no result" : stage.seconds !== null ? number(stage.seconds) + " s" : "", button);
    button.addEventListener("click", () => showStage(k));
    stage.button = button;
    $("beside").add(new Option(stage.name, stage.id));
  });
  function stageInfo(stage) {
    const box = $("stage-info");
    box.textContent = "";
    if (isCause(stage)) element("p", `Cause: ${strip.blame.number}.` + (strip.blame.remedy ? ` Try ${strip.blame.remedy}.` : ""), box, "blame");
    const list = element("dl", "", box);
    const pair = (what) => {
      const both = element("div", "", list);
      element("dt", what, both);
      return element("dd", "", both);
    };
    for (const [what, value] of stage.facts) pair(what).textContent = value;
    if (stage.seconds !== null) pair("time").textContent = number(stage.seconds) + " s";
    if (stage.file) element("code", stage.file, pair("file"));
    if (stage.command) {
      const place = pair("repeat it with another parameter");
      element("code", stage.command, place).id = "command";
      const copy = element("button", "copy", place);
      copy.type = "button";
      copy.addEventListener("click", () => {
        getSelection().selectAllChildren($("command"));
        copy.textContent = document.execCommand("copy") ? "copied" : "press Ctrl+C";
      });
    }
  }

  // ---- no picture
  let renderer = null;
  mark("decoded");
  try {
    renderer = new THREE.WebGLRenderer({canvas: $("canvas"), antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch (e) {
    state.webgl = "missing";
    $("no-webgl").hidden = false;
    $("legend").hidden = true;
    if (stages.length > 0) stageInfo(stages[at]);
    state.ready = Math.round(performance.now());
    return;
  }
  mark("webgl");
  if (stages.length === 0) {
    state.webgl = "empty";
    state.ready = Math.round(performance.now());
    return;
  }
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.setClearColor(0, 0);
  renderer.autoClear = false;
  const camera = new THREE.PerspectiveCamera(28, 1, 0.01, 100);
  const main = new View(), second = new View();
  let chosen = null;  // the mark that was clicked

  // ---- the state of the controls
  const isOn = (id) => $(id).checked;
  function settings(stage) {
    const axis = $("axis").value, scene = stage.scene(), box = scene.info || umtetScenes.whole;
    const sign = isOn("flip") ? -1 : 1, a = Number(axis);
    const place = Number($("place").value);
    const cut = axis === "" ? null : {
      axis: a, sign: sign, isMiddle: Math.abs(place - 0.5) < 0.004,
      at: sign * (box.box_min[a] - origin[a] + place * box.box_size[a]),
    };
    return {colour: stage.colourId, cut, worst: isOn("worst"), nWorst: Number($("worst-number").value), edges: isOn("edges") && stage.id !== "level-set",
            marks: isOn("marks"), mark: chosen};
  }
  for (const stage of stages) stage.colourId = stage.colour;
  function fillColours(stage) {
    const kinds = stage.scene().kinds;
    $("colour").textContent = "";
    for (const kind of kinds) $("colour").add(new Option(kind.name, kind.id));
    if (!kinds.some((k) => k.id === stage.colourId)) stage.colourId = kinds[0].id;
    $("colour").value = stage.colourId;
  }
  function fillLayers(stage) {
    $("layers").textContent = "";
    const add = (id, name, colour) => {
      const label = element("label", "", $("layers")), box = element("input", "", label);
      box.type = "checkbox";
      box.id = id === "samples" ? "cloud" : "layer-" + id;
      box.checked = stage.shows.has(id);
      if (colour) element("i", "", label).style.background = `rgb(${colour.join()})`;
      label.append(" " + name);
      box.addEventListener("input", () => {
        box.checked ? stage.shows.add(id) : stage.shows.delete(id);
        build();
        draw();
      });
    };
    for (const layer of layers) {
      add(layer.id, layer.id === "samples" ? "samples of the cloud" : `${layer.name}: ${layer.n}`, layer.id === "samples" ? null : layer.colour);
      if (layer.id === "samples" && layer.normals) add("normals", "normals");
    }
    $("layers-box").hidden = layers.length === 0;
  }
  function fillControls(stage) {
    fillColours(stage);
    fillLayers(stage);
    const info = stage.scene().info, hasTets = info !== null && info.n_tets_shown > 0;
    $("worst").disabled = $("worst-number").disabled = !hasTets;
    if (hasTets) $("worst-number").max = info.n_worst;
    $("colour").disabled = stage.scene().kinds.length < 2;
    $("marks-row").hidden = marks.length === 0;
    const note = info && info.cells
      ? "Away from the middle planes, the cut shows the least Q in cells of about twelve tets." : "";
    $("cut-note").textContent = note;
  }
  function showStage(k) {
    at = (k + stages.length) % stages.length;
    const stage = stages[at];
    for (const other of stages) other.button.setAttribute("aria-pressed", other === stage);
    state.stage = stage.id;
    stageInfo(stage);
    fillControls(stage);
    build();
    draw();
  }

  function build() {
    const stage = stages[at];
    main.build(stage, settings(stage));
    const beside = stages.find((s) => s.id === $("beside").value);
    if (beside) {
      const kinds = beside.scene().kinds;
      const same = kinds.some((k) => k.id === stage.colourId) ? stage.colourId : beside.colourId;
      second.build(beside, Object.assign(settings(beside), {colour: same}));
    }
    state.curves = main.nCurves;
    state.samples = main.nSamples;
    state.marked = main.nMarkedSamples;
    state.faces = main.scene.nFaces;
    state.cut = main.cutBy;
    state.markedFaces = main.nMarked;
    $("worst-count").value = main.nWorst || "";
    $("names").textContent = "";
    if (beside) for (const s of [stage, beside]) element("span", s.name, $("names"));
    legend();
    $("picked").hidden = true;
  }

  // ---- the legend, and the same for a saved picture
  let legends = [];
  function legend() {
    const {kind, scene, nWorst, cutBy} = main;
    legends = [];
    const bar = (name, colours, ends) => legends.push({name, colours: Array.from({length: 52}, (_, k) => colours[Math.min(5 * k, kNoValue - 1)]), ends});
    const ofQuality = (name) => bar(name, ramp, scene.info.ranges.quality.map(number));
    if (nWorst) {
      const [least, most] = scene.info.ranges.quality, q = least + (scene.tetQuality()[nWorst - 1] / 255) * (most - least);
      legends.push({name: `the ${nWorst} worst tets: mean ratio ${number(least)} to ${q.toFixed(3)}`});
    } else if (kind.id === "patch") {
      legends.push({name: "", rows: patchRows(scene.info)});
    } else if (kind.legend && !kind.ramp) {
      legends.push({name: kind.legend});
    } else if (kind.legend) {
      const ends = kind.range.map(number);
      if (kind.isAtLeast) ends[1] = "≥ " + ends[1];
      bar(kind.legend, kind.ramp, ends);
      if (kind.id === "support") legends.push({name: supportText(scene.info, kind)});
    }
    if (cutBy === "tets" && kind.id !== "quality") ofQuality("tets at the cut: mean ratio Q");
    if (cutBy === "cells") ofQuality("cells at the cut: least mean ratio Q");
    if (main.nMarkedSamples > 0) {
      legends.push({name: "", rows: layers.filter((l) => l.id !== "samples" && stages[at].shows.has(l.id)).map((l) => ({colour: l.colour, name: l.name, value: String(l.n)}))});
    }
    $("legend").textContent = "";
    $("legend").hidden = legends.length === 0;
    for (const part of legends) {
      if (part.name) element("div", part.name, $("legend"), "name");
      if (part.colours) element("div", "", $("legend"), "bar").style.background = "linear-gradient(90deg," + part.colours.map((c) => `rgb(${c.join()})`).join() + ")";
      const ends = part.ends && element("div", "", $("legend"), "ends");
      for (const end of part.ends || []) element("span", end, ends);
      for (const row of part.rows || []) {
        const line = element("div", "", $("legend"), row.number === undefined ? "row" : "patch");
        if (row.number !== undefined) line.dataset.number = row.number;
        element("i", "", line).style.background = `rgb(${row.colour.join()})`;
        element("span", row.name, line);
        element("span", row.value, line);
      }
    }
  }
  // States where on the bar the guess begins.
  function supportText(info, kind) {
    const far = number(info.support_radius);
    return kind.guessFrom === 1 ? `no point is farther than ${far} (3 spacings) from the nearest sample`
                                : `yellow to red: a guess, farther than ${far} (3 spacings) from the nearest sample`;
  }
  // The largest patches by name, with their shares of the area.
  function patchRows(info) {
    const all = info.patches.reduce((sum, p) => sum + p.area, 0), kMost = 16;
    const order = info.patches.map((p, k) => k).sort((a, b) => info.patches[b].area - info.patches[a].area || a - b);
    const rows = order.slice(0, kMost).map((k) => {
      const p = info.patches[k];
      return {number: p.number, colour: patchColours[k % 256], name: p.name, value: (100 * p.area / all).toFixed(1) + " %"};
    });
    if (order.length > kMost) rows.push({colour: [128, 128, 128], name: `and ${order.length - kMost} smaller patches`, value: ""});
    return rows;
  }

  // ---- a turntable around a target: angles, distance relative to the home position, target
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
  // All stages have the same camera: its distance depends on the last stage, or on the samples if nothing else is drawn.
  const bodyPoints = umtetScenes.once(() => {
    for (let k = stages.length - 1; k >= 0; --k) if (stages[k].scene().X.length > 0) return stages[k].scene().X;
    return layers.length > 0 ? layers[0].X() : new Float32Array(3);
  });
  /** The minimum distance from which the whole body is visible, with a margin of a twentieth. */
  function homeDistance(a) {
    const of = `${$("up").value} ${camera.aspect}`;
    if (homeDistance.of === of) return homeDistance.is;
    const w = back(a, kHome), u = new THREE.Vector3().crossVectors(a.up, w).normalize();
    const v = new THREE.Vector3().crossVectors(w, u), high = 0.95 * kSlope, wide = high * camera.aspect;
    const p = new THREE.Vector3(), X = bodyPoints();
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
  function aim(wide, high) {
    camera.aspect = wide / Math.max(high, 1);
    const a = axes(), far = eye.away * homeDistance(a);
    const target = new THREE.Vector3(eye.x, eye.y, eye.z);
    camera.position.copy(target).addScaledVector(back(a, eye), far);
    camera.up.copy(a.up);
    camera.lookAt(target);
    camera.near = Math.max(far - 4 * radius, far * 0.02);
    camera.far = far + 4 * radius;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    for (const view of [main, second]) view.setPixel(2 * kSlope / Math.max(high, 1));
  }
  function render() {
    draw.asked = false;
    const box = $("canvas").parentElement.getBoundingClientRect();
    renderer.setSize(box.width, box.height, false);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, box.width, box.height);
    renderer.clear();
    if (!$("beside").value) {
      aim(box.width, box.height);
      renderer.render(main.world, camera);
      return;
    }
    const half = Math.floor(box.width / 2);
    renderer.setScissorTest(true);
    aim(half, box.height);
    [main, second].forEach((view, k) => {
      renderer.setViewport(k * half, 0, half, box.height);
      renderer.setScissor(k * half, 0, half, box.height);
      renderer.render(view.world, camera);
    });
  }

  // ---- small pictures of all stages, when the browser is idle
  function drawThumbs() {
    const wide = 200, high = 136, target = new THREE.WebGLRenderTarget(wide, high), view = new View();
    const queue = stages.slice(), later = window.requestIdleCallback || ((f) => setTimeout(f, 50));
    const next = () => {
      const stage = queue.shift();
      if (!stage) {
        state.thumbs = stages.length;
        return target.dispose();
      }
      view.build(stage, Object.assign(settings(stage), {colour: stage.colourId, cut: null, worst: false, edges: false, marks: false, mark: null}));
      const before = eye;
      eye = Object.assign({x: 0, y: 0, z: 0}, kHome);
      aim(wide, high);
      eye = before;
      renderer.setScissorTest(false);
      renderer.setRenderTarget(target);
      renderer.clear();
      renderer.render(view.world, camera);
      const pixels = new Uint8Array(4 * wide * high);
      renderer.readRenderTargetPixels(target, 0, 0, wide, high, pixels);
      renderer.setRenderTarget(null);
      const context = stage.thumb.getContext("2d"), image = context.createImageData(wide, high);
      for (let y = 0; y < high; ++y) image.data.set(pixels.subarray(4 * wide * (high - 1 - y), 4 * wide * (high - y)), 4 * wide * y);
      context.putImageData(image, 0, 0);
      later(next);
    };
    later(next);
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

  // ---- a click: the nearest face, tet or sample on the ray
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  /** The distance along the ray to a triangle; infinite if it misses. */
  function hit(from, along, a, b, c) {
    const u = minus(b, a), v = minus(c, a), p = cross(along, v), det = dot(u, p);
    if (Math.abs(det) < 1e-300) return Infinity;
    const t = minus(from, a), x = dot(t, p) / det;
    if (x < 0 || x > 1) return Infinity;
    const q = cross(t, u), y = dot(along, q) / det;
    const away = dot(v, q) / det;
    return y < 0 || x + y > 1 || away <= 0 ? Infinity : away;
  }
  function rayAt(x, y) {
    const box = $("canvas").getBoundingClientRect(), isSplit = Boolean($("beside").value);
    const wide = isSplit ? box.width / 2 : box.width, isSecond = isSplit && x - box.left > wide;
    aim(wide, box.height);
    const ndc = new THREE.Vector3(2 * ((x - box.left) - (isSecond ? wide : 0)) / wide - 1, 1 - 2 * (y - box.top) / box.height, 0.5);
    const along = ndc.unproject(camera).sub(camera.position).normalize();
    return {view: isSecond ? second : main, from: camera.position.toArray(), along: along.toArray(), pixel: 2 * kSlope / box.height};
  }
  const placeText = (p) => "(" + p.map((c, i) => number(c + origin[i])).join(", ") + ")";
  function picked(view, from, along, pixel) {
    const {scene, stage, kind} = view, {X, F} = scene, corner = (v) => [X[3 * v], X[3 * v + 1], X[3 * v + 2]];
    let best = {away: Infinity};
    for (let f = 0; f < scene.nFaces; ++f) {
      if (!view.isBehind(F, f)) continue;
      const away = view.nWorst ? Infinity : hit(from, along, corner(F[4 * f]), corner(F[4 * f + 1]), corner(F[4 * f + 2]));
      if (away < best.away) best = {away, face: f, corners: [0, 1, 2].map((k) => corner(F[4 * f + k]))};
    }
    const T = scene.tets();
    for (const t of view.taken) {
      for (const face of kTetFaces) {
        const away = hit(from, along, ...face.map((k) => corner(T[4 * t + k])));
        if (away < best.away) best = {away, tet: t, corners: [0, 1, 2, 3].map((k) => corner(T[4 * t + k]))};
      }
    }
    // A sample within five pixels of the ray is in front of a face that is a hundredth of the body nearer.
    for (const layer of layers) {
      if (!stage.shows.has(layer.id)) continue;
      const P = layer.X();
      for (let i = 0; i < P.length / 3; ++i) {
        const p = [P[3 * i], P[3 * i + 1], P[3 * i + 2]], d = minus(p, from), away = dot(d, along);
        if (away <= 0 || away - 0.02 * radius > best.away) continue;
        const off2 = dot(d, d) - away * away;
        if (off2 < (5 * pixel * away) ** 2 && away - 0.02 * radius < best.away) best = {away: away - 0.02 * radius, layer, sample: i, at: p, corners: null};
      }
    }
    if (best.away === Infinity) return null;
    const value = (range, byte, steps) => number(range[0] + (byte / steps) * (range[1] - range[0]));
    const lines = [], info = scene.info;
    if (best.sample !== undefined) {
      lines.push(`${best.layer.name} at ${placeText(best.at)}`);
      best.layer.values.forEach((v, k) => {
        const kindOf = scene.kinds.find((x) => x.sample && x.id === "sample_" + k);
        if (kindOf) lines.push(`${v.name} ${value(v.range, kindOf.bytes()[best.sample], 254)}`);
      });
      if (best.layer.normals) lines.push("normal (" + Array.from(best.layer.N().subarray(3 * best.sample, 3 * best.sample + 3), number).join(", ") + ")");
      return {lines, corners: null};
    }
    const middle = [0, 1, 2].map((k) => best.corners.reduce((s, c) => s + c[k], 0) / best.corners.length);
    const edges = best.corners.flatMap((c, i) => best.corners.slice(0, i).map((d) => Math.hypot(...minus(c, d))));
    if (best.tet !== undefined) {
      lines.push(`tet ${scene.tetIds()[best.tet]}`, `mean ratio Q ${value(info.ranges.quality, scene.tetQuality()[best.tet], 255)}`);
    } else {
      const ids = scene.faceTets();
      lines.push(ids ? `boundary face of tet ${ids[best.face]}` : `triangle ${best.face}`);
      for (const k of scene.kinds) {
        if (k.id === "patch") lines.push(`patch ${info.patches[k.bytes()[best.face]].name}`);
        else if (k.face && k.id === "quality") lines.push(`mean ratio Q ${value(k.range, k.bytes()[best.face], 255)}`);
        else if (k.face) lines.push(`${k.name} ${value(k.range, k.bytes()[best.face], 255)}`);
        else if (k.vertex && k.ramp) {
          const b = [0, 1, 2].map((i) => k.bytes()[F[4 * best.face + i]]);
          const steps = k.field ? 254 : 255;
          lines.push(`${k.name} ${k.field && b.includes(kNoValue) ? "–" : value(k.range, Math.max(...b), steps)}`);
        }
      }
    }
    lines.push(`edges ${number(Math.min(...edges))} to ${number(Math.max(...edges))}`, `at ${placeText(middle)}`);
    return {lines, corners: best.corners};
  }
  function pickAt(x, y) {
    const {view, from, along, pixel} = rayAt(x, y);
    // A ring is chosen where the click is near its middle.
    const box = $("canvas").getBoundingClientRect(), isSplit = Boolean($("beside").value), wide = isSplit ? box.width / 2 : box.width;
    for (const m of isOn("marks") ? marks : []) {
      const p = new THREE.Vector3(...m.where.map((c, i) => c - origin[i])).project(camera);
      const px = box.left + (p.x + 1) / 2 * wide + (view === second ? wide : 0), py = box.top + (1 - p.y) / 2 * box.height;
      if (Math.hypot(px - x, py - y) > 9) continue;
      chosen = m;
      build();
      tell([m.text]);
      return draw();
    }
    const found = picked(view, from, along, pixel);
    main.pick(null);
    second.pick(null);
    if (found) view.pick(found.corners);
    tell(found ? found.lines : []);
    draw();
  }
  function tell(lines) {
    $("picked").textContent = "";
    $("picked").hidden = lines.length === 0;
    for (const line of lines) element("div", line, $("picked"));
  }

  // ---- mouse and keyboard
  const canvas = $("canvas");
  let grip = null;
  canvas.addEventListener("pointerdown", (e) => {
    grip = {x: e.clientX, y: e.clientY, move: e.shiftKey || e.button === 2, far: 0, isFirst: e.button === 0};
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointerup", (e) => {
    if (grip && grip.far < 4 && grip.isFirst) pickAt(e.clientX, e.clientY);
    grip = null;
  });
  canvas.addEventListener("pointercancel", () => { grip = null; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("pointermove", (e) => {
    if (!grip) return;
    const dx = (e.clientX - grip.x) / canvas.clientHeight, dy = (e.clientY - grip.y) / canvas.clientHeight;
    grip.far += Math.abs(e.clientX - grip.x) + Math.abs(e.clientY - grip.y);
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
  window.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.altKey || e.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName)) return;
    const step = {ArrowLeft: -1, ArrowRight: 1}[e.key];
    if (!step) return;
    e.preventDefault();
    showStage(at + step);
  });

  // ---- places: the camera looks at a region from outside, so close that it fills a third of the view
  function lookAt(where, wide, isLeftOut) {
    $("axis").value = "";
    $("worst").checked = false;
    build();
    const {X, F, nFaces} = main.scene;
    const middle = new THREE.Vector3(...where.map((c, i) => c - origin[i]));
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
  function showMark(m) {
    if (!m) return;
    chosen = m;
    const k = stages.findIndex((s) => s.id === "mesh"), stage = stages[k];
    if (m.kind === "hole") stage.colourId = "support";
    if (m.kind === "missed") stage.shows.add("samples");
    showStage(k);
    const support = m.kind === "hole" && stage.scene().kinds.find((kind) => kind.id === "support");
    const values = support && support.bytes();
    lookAt(m.where, m.wide, values ? (v) => values[v] / 255 <= support.guessFrom : () => false);
    tell([m.text]);
  }
  const markOf = (kind, k) => marks.find((m) => m.kind === kind && m.k === k);
  for (const kind of ["hole", "place", "missed"]) {
    for (const button of document.querySelectorAll(`button[data-${kind}]`)) {
      button.addEventListener("click", () => {
        showMark(markOf(kind, Number(button.dataset[kind])));
        canvas.scrollIntoView({block: "center"});
      });
    }
  }
  $("home").addEventListener("click", () => {
    eye = Object.assign({x: 0, y: 0, z: 0}, kHome);
    draw();
  });
  // The picture, with its legend, at the resolution of the screen.
  function pictureWithLegend() {
    render();
    const scale = renderer.getPixelRatio(), out = document.createElement("canvas"), g = out.getContext("2d");
    out.width = canvas.width;
    out.height = canvas.height;
    const style = getComputedStyle(document.body);
    g.fillStyle = getComputedStyle(canvas.parentElement).backgroundColor;
    g.fillRect(0, 0, out.width, out.height);
    g.drawImage(canvas, 0, 0);
    g.scale(scale, scale);
    g.font = "12px " + style.fontFamily;
    g.textBaseline = "top";
    const high = legends.reduce((sum, l) => sum + (l.name ? 16 : 0) + (l.colours ? 32 : 0) + 16 * (l.rows || []).length, 0);
    let y = out.height / scale - 14 - high;
    const text = (s, x, align) => {
      g.fillStyle = style.color;
      g.textAlign = align || "left";
      g.fillText(s, x, y);
    };
    for (const l of legends) {
      if (l.name) text(l.name, 16), y += 16;
      if (l.colours) {
        l.colours.forEach((c, k) => {
          g.fillStyle = `rgb(${c.join()})`;
          g.fillRect(16 + k * 190 / l.colours.length, y, 190 / l.colours.length + 0.5, 11);
        });
        y += 14;
        text(l.ends[0], 16);
        text(l.ends[1], 206, "right");
        y += 18;
      }
      for (const row of l.rows || []) {
        g.fillStyle = `rgb(${row.colour.join()})`;
        g.fillRect(16, y + 1, 14, 11);
        text(`${row.name}  ${row.value}`, 38);
        y += 16;
      }
    }
    return out;
  }
  $("save").addEventListener("click", () => {
    const link = document.createElement("a");
    link.download = `${document.title}-${stages[at].id}.png`;
    link.href = pictureWithLegend().toDataURL("image/png");
    link.click();
    state.saved = link.href.length;
  });
  window.addEventListener("resize", draw);

  // #stage=cloud&colour=patch&axis=0&worst=1: the initial view; #hole=1, #spot=1, #missed=1: the first hole that was closed,
  // defect, place where samples are missed.
  const asked = new URLSearchParams(location.hash.slice(1));
  const first = stages.findIndex((s) => s.id === asked.get("stage"));
  if (first >= 0) at = first;
  if (asked.has("colour")) stages[at].colourId = asked.get("colour");
  showStage(at);
  showMark(markOf("hole", Number(asked.get("hole")) - 1));
  showMark(markOf("place", Number(asked.get("spot")) - 1));
  showMark(markOf("missed", Number(asked.get("missed")) - 1));
  for (const [id, value] of asked) {
    const control = $(id);
    if (id === "stage" || !control || !control.form) continue;
    if (control.type === "checkbox") control.checked = value === "1";
    else control.value = value;
    control.dispatchEvent(new Event("input"));
  }
  $("colour").addEventListener("input", () => { stages[at].colourId = $("colour").value; });
  if (asked.has("colour") && $("colour").value) stages[at].colourId = $("colour").value;
  for (const control of $("controls").elements) {
    if (control.type !== "button" && control.tagName !== "FIELDSET" && !control.closest("#layers")) control.addEventListener("input", () => {
      build();
      draw();
    });
  }
  build();
  if (asked.has("hole") || asked.has("spot") || asked.has("missed")) tell(chosen ? [chosen.text] : []);
  mark("built");
  render();
  ready();
  if (asked.has("pick")) {
    const box = canvas.getBoundingClientRect(), [x, y] = asked.get("pick").split(",").map(Number);
    pickAt(box.left + x * box.width, box.top + y * box.height);
  }
  drawThumbs();
})();
