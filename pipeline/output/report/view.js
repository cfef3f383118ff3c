// A view of one stage: turns a scene and the state of the controls into geometry of three.js.
"use strict";
const umtetView = (function () {
  const {ramp, kNoValue, kUnknown, layers, certificate, origin, radius, once} = umtetScenes;
  const kAlarm = [235, 110, 20];  // visible on light and dark backgrounds, and next to grey
  const kChosen = [200, 20, 60];
  const kTetFaces = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

  // Triangles that share no corners: each has its own colours, and weights that measure the distance to an edge.
  function Soup(X, capacity) {
    const position = new Float32Array(9 * capacity), colour = new Uint8Array(9 * capacity);
    let n = 0;
    this.addAt = (points, tints) => {
      for (let k = 0; k < 3; ++k) {
        position.set(points[k], 9 * n + 3 * k);
        colour.set(tints[k], 9 * n + 3 * k);
      }
      ++n;
    };
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

  // Points and lines are drawn closer by a small part of their distance, so that the faces made from them do not hide half.
  const tintedMaterial = (closer, size, options) => new THREE.ShaderMaterial(Object.assign({
    vertexShader: `
      attribute vec3 tint;
      varying vec3 colour;
      void main() {
        vec4 p = modelViewMatrix * vec4(position, 1.0);
        p.xyz *= ${closer};
        colour = tint;
        gl_Position = projectionMatrix * p;
        gl_PointSize = ${size.toFixed(1)};
      }`,
    fragmentShader: "varying vec3 colour; void main() { gl_FragColor = vec4(colour, 1.0); }",
  }, options));

  // Rings face the camera. They have the size of what they mark, but at least nine pixels, and are visible through the body.
  const ringMaterial = () => new THREE.ShaderMaterial({
    uniforms: {pixel: {value: 0}},
    depthTest: false, transparent: true, side: THREE.DoubleSide,
    vertexShader: `
      attribute vec3 tint; attribute vec4 ring;
      uniform float pixel;
      varying vec3 colour;
      void main() {
        vec4 p = modelViewMatrix * vec4(position, 1.0);
        float one = -p.z * pixel;
        float r = max(ring.x, 9.0 * one) + ring.w * 2.5 * one;
        p.xy += r * ring.yz;
        colour = tint;
        gl_Position = projectionMatrix * p;
      }`,
    fragmentShader: "varying vec3 colour; void main() { gl_FragColor = vec4(colour, 1.0); }",
  });

  const attribute = (values, size, normalised) => new THREE.BufferAttribute(values, size, Boolean(normalised));
  function geometryOf(attributes) {
    const g = new THREE.BufferGeometry();
    for (const [name, value] of Object.entries(attributes)) g.setAttribute(name, value);
    return g;
  }
  function repeated(colour, n) {
    const tints = new Uint8Array(3 * n);
    for (let i = 0; i < n; ++i) tints.set(colour, 3 * i);
    return tints;
  }

  // Everything of the certificate that has a place: where it is, how large, and what it is called.
  const h = certificate ? certificate.h : 0;
  const marks = certificate ? [
    ...certificate.places.listed.map((p, k) => ({
      kind: "place", k, where: p.where, size: Math.max(1, p.size_over_h / 2) * h, wide: (4 + p.size_over_h) * h, isSmall: p.small,
      text: `defect ${k + 1}: ${p.kind}, ${umtetScenes.number(p.off_over_h)} h off, ${umtetScenes.number(p.size_over_h)} h wide`})),
    ...((certificate.cloud && certificate.cloud.missed_places) || []).map((p, k) => ({
      kind: "missed", k, where: p.farthest, size: p.distance, wide: 4 * p.distance + 4 * h,
      text: `samples missed ${k + 1}: ${p.n_samples} samples, up to ${umtetScenes.number(p.distance)} from the mesh`})),
    ...(certificate.domain.closed_holes || []).map((p, k) => ({
      kind: "hole", k, where: p.centre, size: Math.max(p.rim.diameter, Math.sqrt(p.area)) / 2,
      wide: Math.max(p.rim.diameter, Math.sqrt(p.area)), text: `hole ${k + 1}: area ${umtetScenes.number(p.area)}`})),
  ] : [];
  const kMarkColours = {place: [230, 30, 30], missed: [217, 28, 97], hole: [236, 112, 20]};

  function ringGeometry(chosen) {
    const kParts = 48, position = [], ring = [], tint = [];
    for (const mark of marks) {
      const at = mark.where.map((c, i) => c - origin[i]), colour = mark.isSmall ? [160, 120, 120] : kMarkColours[mark.kind];
      const wide = mark === chosen ? 2 : 1;
      for (let k = 0; k < kParts; ++k) {
        const corner = (j, side) => {
          const a = 2 * Math.PI * j / kParts;
          position.push(...at);
          ring.push(mark.size, Math.cos(a), Math.sin(a), side * wide);
          tint.push(...colour);
        };
        for (const [j, side] of [[k, 0], [k + 1, 0], [k + 1, 1], [k, 0], [k + 1, 1], [k, 1]]) corner(j, side);
      }
    }
    return geometryOf({position: attribute(new Float32Array(position), 3), ring: attribute(new Float32Array(ring), 4),
                       tint: attribute(new Uint8Array(tint), 3, true)});
  }

  const textures = new Map();
  function textureOf(colours) {
    if (!textures.has(colours)) {
      const texture = new THREE.DataTexture(new Uint8Array(colours.flatMap((c) => [...c, 255])), 256, 1, THREE.RGBAFormat);
      texture.needsUpdate = true;
      textures.set(colours, texture);
    }
    return textures.get(colours);
  }

  /** Draws one stage. `settings`: the state of the controls; see viewer.js. */
  function View() {
    const world = this.world = new THREE.Scene();
    // The surface lies on the faces of tets behind it, so it is drawn slightly in front.
    const parts = {
      surface: new THREE.Mesh(new THREE.BufferGeometry(), material({polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1})),
      inside: new THREE.Mesh(new THREE.BufferGeometry(), material({})),
      curves: new THREE.LineSegments(new THREE.BufferGeometry(), tintedMaterial(0.998, 1)),
      samples: new THREE.Points(new THREE.BufferGeometry(), tintedMaterial(0.994, 3)),
      marked: new THREE.Points(new THREE.BufferGeometry(), tintedMaterial(0.99, 5)),
      normals: new THREE.LineSegments(new THREE.BufferGeometry(), tintedMaterial(0.994, 1)),
      rings: new THREE.Mesh(new THREE.BufferGeometry(), ringMaterial()),
      picked: new THREE.LineSegments(new THREE.BufferGeometry(), tintedMaterial(0.99, 1, {depthTest: false})),
    };
    let order = 0;
    for (const part of Object.values(parts)) {
      part.frustumCulled = false;
      part.renderOrder = ++order;
      world.add(part);
    }
    const set = (part, geometry) => {
      part.geometry.dispose();
      part.geometry = geometry;
    };
    let S = null, taken = [], isBehind = () => true;

    const centroid = (list, k, axis) => {
      const {X} = S;
      return (X[3 * list[4 * k] + axis] + X[3 * list[4 * k + 1] + axis] + X[3 * list[4 * k + 2] + axis] + X[3 * list[4 * k + 3] + axis]) / 4;
    };

    function shell(kind, cut, settings, values) {
      const {X, F, nFaces} = S, soup = new Soup(X, nFaces), worst = settings.worst, chosen = settings.mark;
      const tint = (v) => worst || !kind.ramp ? kUnknown : kind.ramp[v];
      // Values at vertices, not colours, are linear on a face, so that boundaries between colours are at the correct values.
      const ramped = Boolean(kind.vertex && kind.ramp) && !worst;
      // A face with a corner without a value has no value.
      const unknown = (corners) => kind.field && corners.some((v) => values[v * (kind.ramp ? 1 : 3)] === kNoValue);
      const coloured = (v) => [0, 1, 2].map((k) => Math.round(values[3 * v + k] * 255 / 254));
      parts.surface.material.uniforms.ramped.value = ramped ? 1 : 0;
      if (ramped) parts.surface.material.uniforms.ramp.value = textureOf(kind.ramp);
      // The faces of the defect that was chosen.
      const at = chosen && chosen.kind !== "hole" && !ramped ? chosen.where.map((c, i) => c - origin[i]) : null;
      const near2 = at ? (chosen.size + h) ** 2 : 0;
      const isMarked = (a, b, c) => [a, b, c].some((v) => {
        let d2 = 0;
        for (let i = 0; i < 3; ++i) d2 += (X[3 * v + i] - at[i]) ** 2;
        return d2 <= near2;
      });
      let nMarked = 0;
      for (let f = 0; f < nFaces; ++f) {
        if (!isBehind(F, f)) continue;
        const a = F[4 * f], b = F[4 * f + 1], c = F[4 * f + 2];
        if (ramped) {
          const none = unknown([a, b, c]);
          soup.add(a, b, c, ...[a, b, c].map((v) => [none ? kNoValue : values[v], 0, 0]));
        } else if (at && isMarked(a, b, c)) {
          soup.add(a, b, c, kChosen, kChosen, kChosen);
          ++nMarked;
        } else if (kind.field && !worst) {
          const none = unknown([a, b, c]);
          soup.add(a, b, c, ...[a, b, c].map((v) => none ? kUnknown : coloured(v)));
        } else {
          const one = tint(values ? values[f] : 0);
          soup.add(a, b, c, one, one, one);
        }
      }
      this.nMarked = nMarked;
      return soup;
    }

    // The worst tets alone, or the tets at the cut.
    function tetsInside(cut, nWorst) {
      const T = S.tets(), Q = S.tetQuality();
      taken = [];
      const drawn = (t) => {
        const c = cut.sign * centroid(T, t, cut.axis);
        return c <= cut.at && c > cut.at - S.info.layer;
      };
      for (let t = 0; t < (nWorst || T.length / 4); ++t) if (nWorst ? isBehind(T, t) : drawn(t)) taken.push(t);
      const solid = new Soup(S.X, 4 * taken.length);
      for (const t of taken) {
        const c = nWorst ? kAlarm : ramp[Q[t]];
        for (const face of kTetFaces) solid.add(T[4 * t + face[0]], T[4 * t + face[1]], T[4 * t + face[2]], c, c, c);
      }
      return solid;
    }

    // The squares of the cells that the plane meets, in place of tets that the page does not contain.
    function cellsInside(cut) {
      const cells = S.cells(), n = S.info.cells, [u, v] = [0, 1, 2].filter((k) => k !== cut.axis);
      const low = S.info.box_min.map((m, i) => m - origin[i]), step = S.info.box_size.map((s, i) => s / n[i]);
      const place = cut.sign * cut.at, layer = Math.max(0, Math.min(n[cut.axis] - 1, Math.floor((place - low[cut.axis]) / step[cut.axis])));
      const squares = new Soup(null, 2 * n[u] * n[v]);
      taken = [];
      for (let j = 0; j < n[v]; ++j) {
        for (let i = 0; i < n[u]; ++i) {
          const at = [0, 0, 0];
          at[cut.axis] = layer;
          at[u] = i;
          at[v] = j;
          const value = cells[(at[2] * n[1] + at[1]) * n[0] + at[0]];
          if (value === 0) continue;
          const corner = (di, dj) => {
            const x = [0, 0, 0];
            x[cut.axis] = place;
            x[u] = low[u] + (i + di) * step[u];
            x[v] = low[v] + (j + dj) * step[v];
            return x;
          };
          const c = ramp[Math.round((value - 1) * 255 / 254)];
          squares.addAt([corner(0, 0), corner(1, 0), corner(1, 1)], [c, c, c]);
          squares.addAt([corner(0, 0), corner(1, 1), corner(0, 1)], [c, c, c]);
        }
      }
      return squares;
    }

    function drawLayers(stage, kind, cut, settings) {
      const isAlone = S.nFaces === 0;
      const shown = (x, i) => !cut || cut.sign * x[3 * i + cut.axis] <= cut.at;
      const samples = layers.find((l) => l.id === "samples");
      let ticks = new THREE.BufferGeometry(), points = new THREE.BufferGeometry();
      this.nSamples = 0;
      if (samples && (stage.shows.has("samples") || stage.shows.has("normals"))) {
        const X = samples.X(), n = X.length / 3, kept = [];
        for (let i = 0; i < n; ++i) if (shown(X, i)) kept.push(i);
        const values = kind.sample ? kind.bytes() : null, base = isAlone ? [110, 125, 145] : samples.colour;
        if (stage.shows.has("samples")) {
          const at = new Float32Array(3 * kept.length), tint = new Uint8Array(3 * kept.length);
          kept.forEach((i, k) => {
            at.set(X.subarray(3 * i, 3 * i + 3), 3 * k);
            tint.set(values ? kind.ramp[values[i]] : base, 3 * k);
          });
          points = geometryOf({position: attribute(at, 3), tint: attribute(tint, 3, true)});
          this.nSamples = kept.length;
        }
        if (stage.shows.has("normals") && samples.normals) {
          const N = samples.N(), long = radius * Math.min(0.06, 3 / Math.sqrt(n + 1)), at = new Float32Array(6 * kept.length);
          const tint = new Uint8Array(6 * kept.length);
          kept.forEach((i, k) => {
            for (let j = 0; j < 3; ++j) {
              at[6 * k + j] = X[3 * i + j];
              at[6 * k + 3 + j] = X[3 * i + j] + long * N[3 * i + j];
            }
            tint.set([110, 125, 145, 0, 140, 110], 6 * k);
          });
          ticks = geometryOf({position: attribute(at, 3), tint: attribute(tint, 3, true)});
        }
      }
      set(parts.samples, points);
      set(parts.normals, ticks);
      parts.samples.visible = Boolean(points.attributes.position);
      parts.normals.visible = Boolean(ticks.attributes.position);
      const at = [], tint = [];
      this.nMarkedSamples = 0;
      for (const layer of layers) {
        if (layer.id === "samples" || !stage.shows.has(layer.id)) continue;
        const X = layer.X();
        for (let i = 0; i < X.length / 3; ++i) {
          if (!shown(X, i)) continue;
          at.push(X[3 * i], X[3 * i + 1], X[3 * i + 2]);
          tint.push(...layer.colour);
        }
      }
      this.nMarkedSamples = at.length / 3;
      set(parts.marked, at.length ? geometryOf({position: attribute(new Float32Array(at), 3), tint: attribute(new Uint8Array(tint), 3, true)})
                                  : new THREE.BufferGeometry());
      parts.marked.visible = at.length > 0;
    }
    const drawSamples = drawLayers.bind(this), drawShell = shell.bind(this);

    this.build = (stage, settings) => {
      S = this.scene = stage.scene();
      this.stage = stage;
      const kind = this.kind = S.kinds.find((k) => k.id === settings.colour) || S.kinds[0];
      const cut = settings.cut, worst = settings.worst && S.info !== null && S.info.n_worst > 0;
      isBehind = (list, k) => !cut || cut.sign * centroid(list, k, cut.axis) <= cut.at;
      this.isBehind = isBehind;
      set(parts.surface, drawShell(kind, cut, Object.assign({}, settings, {worst}), kind.bytes()).geometry());
      const hasTets = S.info !== null && S.info.n_tets_shown > 0;
      this.nWorst = worst ? Math.min(settings.nWorst, S.info.n_worst) : 0;
      const byCells = cut && hasTets && S.info.cells && !(S.info.planes.includes(cut.axis) && cut.isMiddle) && !worst;
      this.cutBy = !cut || !hasTets || worst ? "" : byCells ? "cells" : "tets";
      taken = [];
      set(parts.inside, (!hasTets || !(worst || cut) ? new Soup(S.X, 0) : byCells ? cellsInside(cut) : tetsInside(cut, this.nWorst)).geometry());
      this.taken = taken;
      parts.surface.material.transparent = worst;
      parts.surface.material.depthWrite = !worst;
      parts.surface.material.uniforms.opacity.value = worst ? 0.13 : 1;
      parts.surface.material.uniforms.edges.value = settings.edges && !worst ? 1 : 0;
      parts.inside.material.uniforms.edges.value = settings.edges && !byCells ? 1 : 0;
      const {ends} = S, lines = [];
      for (let i = 0; i < ends.length; i += 6) {
        const middle = cut && (ends[i + cut.axis] + ends[i + 3 + cut.axis]) / 2;
        if (!cut || cut.sign * middle <= cut.at) lines.push(...ends.subarray(i, i + 6));
      }
      set(parts.curves, geometryOf({position: attribute(new Float32Array(lines), 3), tint: attribute(repeated([191, 13, 26], lines.length / 3), 3, true)}));
      parts.curves.visible = lines.length > 0;
      this.nCurves = lines.length / 6;
      drawSamples(stage, kind, cut, settings);
      parts.rings.visible = settings.marks && marks.length > 0 && stage.id !== "input";
      if (parts.rings.visible) set(parts.rings, ringGeometry(settings.mark));
      this.pick(null);
    };
    /** Outlines the corners of a face or a tet, or nothing. */
    this.pick = (corners) => {
      parts.picked.visible = corners !== null;
      if (!corners) return;
      const at = [];
      for (let i = 0; i < corners.length; ++i)
        for (let j = 0; j < i; ++j) at.push(...corners[i], ...corners[j]);
      set(parts.picked, geometryOf({position: attribute(new Float32Array(at), 3), tint: attribute(repeated(kChosen, at.length / 3), 3, true)}));
    };
    this.setPixel = (pixel) => { parts.rings.material.uniforms.pixel.value = pixel; };
  }
  return {View, marks, kTetFaces, Soup, once};
})();
