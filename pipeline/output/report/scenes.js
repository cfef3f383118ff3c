// The data of the page: reads the arrays of report_scene.h and stage_layers.h into scenes, which views draw.
"use strict";
const umtetScenes = (function () {
  const $ = (id) => document.getElementById(id);
  const read = (id) => JSON.parse($(id).textContent);
  const strip = read("strip-data"), certificate = read("certificate"), finalScene = read("scene");

  function bytes(name) {
    const text = atob($("block-" + name).textContent);
    const b = new Uint8Array(text.length);
    for (let i = 0; i < b.length; ++i) b[i] = text.charCodeAt(i);
    return b;
  }
  const has = (name) => $("block-" + name) !== null;
  // Decodes data at the first use, so that the first picture appears before all stages are decoded.
  const once = (make) => {
    let made;
    return () => made === undefined ? (made = make()) : made;
  };

  // Viridis: perceptually uniform, also in grey and for colour-blind readers.
  const kStops = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];
  const kPatches = ["0072b2", "e69f00", "009e73", "cc79a7", "56b4e9", "d55e00", "f0e442", "999999"];
  const rgb = (hex) => [0, 2, 4].map((k) => parseInt(hex.substr(k, 2), 16));
  const blend = (a, b, s) => a.map((c, i) => Math.round(c + s * (b[i] - c)));
  const ramp = [];
  for (let v = 0; v < 256; ++v) {
    const at = (v / 255) * (kStops.length - 1), k = Math.min(Math.floor(at), kStops.length - 2);
    ramp.push(blend(rgb(kStops[k]), rgb(kStops[k + 1]), at - k));
  }
  const reversed = ramp.slice().reverse();
  const patchColours = [];
  for (let v = 0; v < 256; ++v) patchColours.push(rgb(kPatches[v % kPatches.length]));
  const plain = new Array(256).fill([226, 196, 128]);
  // Data of the samples: viridis up to 254, and grey where they are unknown.
  const kNoValue = 255, kUnknown = [150, 155, 165];
  const known = ramp.map((c, v) => v === kNoValue ? kUnknown : ramp[Math.round(v * 255 / 254)]);
  const knownReversed = known.map((c, v) => v === kNoValue ? kUnknown : ramp[255 - Math.round(v * 255 / 254)]);

  // Grey near samples, and yellow to dark red where no sample supports the surface.
  function supportRamp(guessFrom) {
    const kGuess = [[254, 196, 79], [236, 112, 20], [140, 20, 4]], kBacked = [[206, 214, 222], [120, 138, 156]];
    const colours = [];
    for (let v = 0; v < 256; ++v) {
      const at = v / 255, s = 2 * (at - guessFrom) / Math.max(1 - guessFrom, 1e-9);
      colours.push(at <= guessFrom ? blend(kBacked[0], kBacked[1], at / guessFrom)
                   : s < 1 ? blend(kGuess[0], kGuess[1], s) : blend(kGuess[1], kGuess[2], s - 1));
    }
    return colours;
  }

  // All positions are relative to the middle of the body, for which single precision suffices.
  const boxes = [finalScene, ...strip.stages.map((s) => s.scene), ...strip.layers].filter((b) => b);
  const whole = boxes[0] || {box_min: [0, 0, 0], box_size: [1, 1, 1]};
  const origin = whole.box_min.map((m, i) => m + whole.box_size[i] / 2);
  const radius = Math.max(Math.hypot(...whole.box_size) / 2, 1e-300);
  function places(name, box) {
    const steps = new Uint16Array(bytes(name).buffer);
    const x = new Float32Array(steps.length);
    for (let i = 0; i < x.length; ++i) x[i] = box.box_min[i % 3] - origin[i % 3] + (steps[i] / 65535) * box.box_size[i % 3];
    return x;
  }

  /** The colours of a stage. `face`: a byte per face, `vertex`: a byte per vertex, `sample`: a byte per sample. */
  function kindsOf(prefix, info) {
    const ranges = info.ranges;
    const guessFrom = ranges.support ? Math.min(1, info.support_radius / Math.max(ranges.support[1], 1e-300)) : 1;
    const list = [
      {id: "quality", name: "quality (mean ratio)", legend: "mean ratio Q", key: "quality", face: "face_quality", ramp: ramp},
      {id: "deviation", name: "deviation of face centres", legend: "deviation of face centres, model units", key: "deviation",
       face: "face_deviation", ramp: reversed},
      {id: "support", name: "support (nearest sample)", legend: "distance to the nearest sample, model units", key: "support",
       vertex: "vertex_support", ramp: supportRamp(guessFrom), guessFrom: guessFrom},
      {id: "size", name: "edge length", legend: "mean edge length, model units", key: "edge_length", vertex: "vertex_edge_length", ramp: ramp},
      {id: "patch", name: "patch", face: "face_patch", ramp: patchColours},
      ...info.fields.map((f, k) => ({
        id: "field_" + k, name: f.name, legend: f.name + "; grey: no value", field: f, vertex: "vertex_field_" + k,
        ramp: f.of_colours ? null : f.name.startsWith("residual") ? knownReversed : known,
      })),
      {id: "none", name: "none", ramp: plain},
    ].filter((k) => !(k.face || k.vertex) || has(prefix + (k.face || k.vertex)));
    for (const kind of list) {
      kind.range = kind.field ? kind.field.range : ranges[kind.key];
      kind.bytes = kind.face || kind.vertex ? once(() => bytes(prefix + (kind.face || kind.vertex))) : () => null;
    }
    return list;
  }

  /** A stage with faces, and tets if it has any. */
  function surfaceScene(prefix, info) {
    const scene = {info: info, kinds: kindsOf(prefix, info)};
    const indices = (name) => {
      const b = bytes(prefix + name);
      return info.index_bytes === 2 ? new Uint16Array(b.buffer) : new Uint32Array(b.buffer);
    };
    scene.X = places(prefix + "positions", info);
    scene.F = indices("faces");
    scene.nFaces = scene.F.length / 4;
    scene.tets = once(() => has(prefix + "tets") ? indices("tets") : new Uint16Array(0));
    scene.tetQuality = once(() => has(prefix + "tet_quality") ? bytes(prefix + "tet_quality") : new Uint8Array(0));
    scene.cells = once(() => info.cells ? bytes(prefix + "cells") : null);
    scene.ends = has(prefix + "curves") ? places(prefix + "curves", info) : new Float32Array(0);
    const ids = (name) => has(prefix + name) ? new Uint32Array(bytes(prefix + name).buffer) : null;
    scene.faceTets = once(() => ids("face_ids"));
    // The ids of all tets of the page: after the worst ones, the others ascend.
    scene.tetIds = once(() => {
      const stored = ids("tet_ids"), n = scene.tets().length / 4;
      if (!stored || stored.length === n) return stored;
      const isWorst = new Set(stored), all = Array.from(stored);
      for (let t = 0; all.length < n; ++t) if (!isWorst.has(t)) all.push(t);
      return all;
    });
    return scene;
  }

  /** A stage of samples alone: their values are its colours. */
  function sampleScene() {
    const samples = layers.find((l) => l.id === "samples");
    const kinds = samples ? samples.values.map((v, k) => ({
      id: "sample_" + k, name: v.name + " of the samples", legend: "distance of a sample from ψ = 0, model units", range: v.range,
      isAtLeast: true, ramp: knownReversed, bytes: once(() => bytes(`layer_samples_value_${k}`)), sample: true})) : [];
    return {
      info: null, X: new Float32Array(0), F: new Uint16Array(0), nFaces: 0, ends: new Float32Array(0), tets: () => new Uint16Array(0),
      tetQuality: () => new Uint8Array(0), cells: () => null, faceTets: () => null, tetIds: () => null,
      kinds: [{id: "none", name: "none", ramp: plain, bytes: () => null}, ...kinds],
    };
  }

  const kLayerColours = {samples: [217, 28, 97], outliers: [213, 94, 0], small_components: [230, 159, 0], no_normal: [120, 60, 160],
                         turned: [0, 114, 178], doubtful: [204, 121, 167]};
  const layers = strip.layers.map((l) => Object.assign({}, l, {
    colour: kLayerColours[l.id],
    X: once(() => places("layer_" + l.id, l)),
    N: once(() => {
      const b = bytes(`layer_${l.id}_normals`), n = new Float32Array(b.length);
      for (let i = 0; i < n.length; ++i) n[i] = b[i] / 127 - 1;
      return n;
    }),
  }));

  const stages = strip.stages.map((stage) => {
    const prefix = stage.id === "mesh" ? "" : stage.id + "_", info = stage.id === "mesh" ? finalScene : stage.scene;
    return Object.assign({}, stage, {
      shows: new Set(stage.layers),
      scene: once(() => info ? surfaceScene(prefix, info) : sampleScene()),
    });
  });
  const number = (v) => String(Number(v.toPrecision(4)));
  return {strip, certificate, stages, layers, origin, radius, whole, ramp, kNoValue, kUnknown, patchColours, once, number};
})();
