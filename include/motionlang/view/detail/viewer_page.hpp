// SPDX-License-Identifier: MIT
/// The source of the viewer's page: style, elements, program. viewer.hpp puts title and data between them. It is plain
/// HTML and JavaScript without libraries; the page loads nothing from a network.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Colours of a page, for light and dark screens.
inline constexpr std::string_view page_colours = R"page(
:root {
  color-scheme: light dark;
  --back: #f3f5f8; --panel: #ffffff; --text: #1d222b; --faint: #667081; --line: #d9dee6; --accent: #2676ba;
}
@media (prefers-color-scheme: dark) {
  :root {
    --back: #14171c; --panel: #1d2128; --text: #e6e9ef; --faint: #98a2b3; --line: #323945; --accent: #62aef0;
  }
}
)page";

inline constexpr std::string_view viewer_style = R"page(
* { box-sizing: border-box; }
html, body { height: 100%; margin: 0; }
body {
  display: flex; flex-direction: column; background: var(--back); color: var(--text);
  font: 14px/1.4 system-ui, -apple-system, "Segoe UI", sans-serif;
}
header { display: flex; flex-wrap: wrap; gap: 2px 16px; align-items: baseline; padding: 10px 16px 8px; }
h1 { font-size: 17px; margin: 0; }
#info { color: var(--faint); }
#stage { position: relative; flex: 1 1 auto; min-height: 220px; }
#view { position: absolute; inset: 0; width: 100%; height: 100%; touch-action: none; cursor: grab; }
#view:active { cursor: grabbing; }
#hint { position: absolute; right: 14px; bottom: 8px; color: var(--faint); font-size: 12px; pointer-events: none; }
footer { background: var(--panel); border-top: 1px solid var(--line); padding: 8px 16px 12px; }
#controls { display: flex; flex-wrap: wrap; gap: 8px; align-items: center; }
button, select {
  font: inherit; color: inherit; background: var(--back); border: 1px solid var(--line); border-radius: 7px;
  padding: 5px 10px; min-height: 32px;
}
#play { min-width: 84px; background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
@media (prefers-color-scheme: dark) { #play { color: #10141a; } }
button[aria-pressed="true"] { border-color: var(--accent); box-shadow: inset 0 0 0 1px var(--accent); }
button:disabled { opacity: 0.45; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
#clock { font-variant-numeric: tabular-nums; margin-left: auto; }
#scrub { display: block; width: 100%; margin: 10px 0 4px; accent-color: var(--accent); height: 20px; }
#timeline { position: relative; max-height: 34vh; overflow-x: hidden; overflow-y: auto; cursor: pointer; }
#axis { position: relative; height: 16px; color: var(--faint); font-size: 11px; margin: 0 8px; }
#axis span { position: absolute; transform: translateX(-50%); white-space: nowrap; }
#tracks { position: relative; margin: 0 8px; }
.track { position: relative; height: 28px; border-top: 1px solid var(--line); }
.bar {
  position: absolute; top: 2px; height: 23px; min-height: 0; padding: 0 0 0 7px; border: 0; border-radius: 4px;
  border-left: 4px solid var(--hue); text-align: left; white-space: nowrap; cursor: pointer; line-height: 23px;
  background: color-mix(in srgb, var(--hue) 22%, transparent);
}
.bar > span { display: inline-block; overflow: hidden; text-overflow: ellipsis; vertical-align: top; }
.bar.now { background: color-mix(in srgb, var(--hue) 48%, transparent); }
.bar.turned { direction: rtl; }
.bar.turned span { direction: ltr; unicode-bidi: embed; }
.bar small { color: var(--faint); margin: 0 6px; }
#cursor {
  position: absolute; top: 0; bottom: 0; width: 2px; margin-left: -1px; background: var(--accent); pointer-events: none;
}
)page";

inline constexpr std::string_view viewer_header = R"page(
<header><h1 id="title"></h1><span id="info"></span></header>
)page";

/// The figure, and the buttons of the player.
inline constexpr std::string_view viewer_stage = R"page(
<main id="stage">
  <canvas id="view" tabindex="0" role="img" aria-label="Moving figure. Drag or use the arrow keys to turn it, plus and
minus to zoom."></canvas>
  <span id="hint">drag: turn &middot; wheel: zoom &middot; shift+drag: move &middot; space: play</span>
</main>
)page";
inline constexpr std::string_view viewer_controls = R"page(
  <div id="controls">
    <button id="play" type="button" aria-pressed="false">Play</button>
    <label id="choice" hidden>Motion <select id="motion"></select></label>
    <label>Speed <select id="speed">
      <option value="0.25">0.25&times;</option><option value="0.5">0.5&times;</option>
      <option value="1" selected>1&times;</option><option value="2">2&times;</option>
    </select></label>
    <button id="loop" type="button" aria-pressed="true">Loop</button>
    <button id="follow" type="button" aria-pressed="true">Follow</button>
    <button id="reset" type="button">Reset view</button>
    <span id="clock"></span>
  </div>
  <input id="scrub" type="range" min="0" step="any" value="0" aria-label="Time">
)page";

inline constexpr std::string_view viewer_timeline = R"page(
  <div id="timeline"><div id="axis" aria-hidden="true"></div><div id="tracks"><div id="cursor"></div></div></div>
)page";

/// Poses: decoding, interpolation, forward kinematics. The camera.
inline constexpr std::string_view viewer_script_pose = R"page(
"use strict";
const page = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);

// Vectors are arrays of three numbers, quaternions are [x, y, z, w], matrices are 16 numbers, column by column.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scale(a, 1 / Math.hypot(...a));
const mix = (a, b, t) => a + (b - a) * t;
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const turn = (q, v) => {  // q v q^-1
  const t = scale(cross(q, v), 2);
  return add(add(v, scale(t, q[3])), cross(q, t));
};
const compose = (a, b) => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
  a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
const multiply = (a, b) => {
  const m = new Float32Array(16);
  for (let c = 0; c < 4; ++c) {
    for (let r = 0; r < 4; ++r) {
      for (let k = 0; k < 4; ++k) m[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
  }
  return m;
};

/** One motion: root positions as float32, then local rotations as int16, joint fastest; unit = 32767. */
class Clip {
  constructor(source) {
    Object.assign(this, source);
    const bytes = Uint8Array.from(atob(source.data), (c) => c.charCodeAt(0));
    this.roots = new Float32Array(bytes.buffer, 0, 3 * this.frames);
    this.turns = new Int16Array(bytes.buffer, 12 * this.frames);
    this.seconds = (this.frames - 1) / this.fps;
  }
  rootAt(frame) { return Array.from(this.roots.subarray(3 * frame, 3 * frame + 3)); }
  rotation(frame, joint) {
    const at = 4 * (frame * this.parents.length + joint);
    return this.turns.subarray(at, at + 4);
  }
  /** Positions and rotations of all joints in the world; between two frames interpolated. */
  pose(time) {
    const exact = clamp(time * this.fps, 0, this.frames - 1), a = Math.floor(exact);
    const b = Math.min(a + 1, this.frames - 1), share = exact - a;
    const positions = [], rotations = [];
    this.parents.forEach((parent, joint) => {
      const p = this.rotation(a, joint), q = this.rotation(b, joint);
      const side = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0 ? -1 : 1;
      const raw = [0, 1, 2, 3].map((i) => mix(p[i], side * q[i], share)), size = Math.hypot(...raw) || 1;
      const local = raw.map((x) => x / size);
      if (parent < 0) {
        positions.push([0, 1, 2].map((i) => mix(this.roots[3 * a + i], this.roots[3 * b + i], share)));
        rotations.push(local);
      } else {
        positions.push(add(positions[parent], turn(rotations[parent], this.offsets[joint])));
        rotations.push(compose(rotations[parent], local));
      }
    });
    return { positions, rotations };
  }
  /** The cones of the figure in the world: ends, radii, side of the body. */
  shapes(pose) {
    return this.cones.map(([joint, fx, fy, fz, tx, ty, tz, radiusFrom, radiusTo, side]) => {
      const place = (v) => add(pose.positions[joint], turn(pose.rotations[joint], v));
      return { from: place([fx, fy, fz]), to: place([tx, ty, tz]), radiusFrom, radiusTo, side, joint };
    });
  }
}

/** A body of the reader's own: a surface at rest, of which every vertex follows four joints. */
class Mesh {
  constructor({ positions, joints, weights, triangles, offsets, parents }) {
    const decode = (text, Type) => new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
    this.positions = decode(positions, Float32Array);
    this.joints = decode(joints, Uint16Array);
    this.weights = Float32Array.from(decode(weights, Uint16Array), (w) => w / 65535);
    this.triangles = decode(triangles, Uint32Array);
    this.rest = [];
    parents.forEach((p, joint) => this.rest.push(p < 0 ? offsets[joint] : add(this.rest[p], offsets[joint])));
    this.makeNormals();
    this.skinned = new Float32Array(2 * this.positions.length);  // position and normal of every vertex
  }
  makeNormals() {
    const at = (v) => Array.from(this.positions.subarray(3 * v, 3 * v + 3));
    this.normals = new Float32Array(this.positions.length);
    for (let i = 0; i < this.triangles.length; i += 3) {
      const corners = this.triangles.subarray(i, i + 3), [a, b, c] = Array.from(corners, at);
      const area = cross(sub(b, a), sub(c, a));
      for (const v of corners) for (let k = 0; k < 3; ++k) this.normals[3 * v + k] += area[k];
    }
  }
  /** The surface in a pose of its joints. */
  skin({ positions, rotations }) {
    const turns = rotations.flatMap((q) => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap((axis) => turn(q, axis)));
    const moves = positions.flatMap((p, joint) => sub(p, turn(rotations[joint], this.rest[joint])));
    const m = new Float32Array(12), out = this.skinned;
    for (let v = 0; v < this.positions.length / 3; ++v) {
      m.fill(0);
      for (let k = 4 * v; k < 4 * v + 4; ++k) {
        const joint = this.joints[k], w = this.weights[k];
        if (w === 0) continue;
        for (let i = 0; i < 9; ++i) m[i] += w * turns[9 * joint + i];
        for (let i = 0; i < 3; ++i) m[9 + i] += w * moves[3 * joint + i];
      }
      const [x, y, z] = this.positions.subarray(3 * v, 3 * v + 3), [a, b, c] = this.normals.subarray(3 * v, 3 * v + 3);
      for (let i = 0; i < 3; ++i) {
        out[6 * v + i] = m[i] * x + m[3 + i] * y + m[6 + i] * z + m[9 + i];
        out[6 * v + 3 + i] = m[i] * a + m[3 + i] * b + m[6 + i] * c;
      }
    }
    return out;
  }
}

/** Looks at a point from a distance; angles in radians. */
class Camera {
  static fieldOfView = 0.6;
  reset(clip) {
    const facing = turn(clip.pose(0).rotations[0], [0, 0, 1]);
    this.yaw = Math.atan2(facing[0], facing[2]) + 0.6;
    this.pitch = 0.22;
    this.distance = 2.5 * clip.size;
    this.shift = [0, 0, 0];
    this.goal = [0, 0.5 * clip.size, 0];
  }
  /** Unit vectors: towards the viewer, to the right, upwards. */
  get axes() {
    const c = Math.cos(this.pitch);
    const back = [c * Math.sin(this.yaw), Math.sin(this.pitch), c * Math.cos(this.yaw)];
    const right = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    return { back, right, up: cross(back, right) };
  }
  get target() { return add(this.goal, this.shift); }
  get eye() { return add(this.target, scale(this.axes.back, this.distance)); }
  /** Half heights of the picture per unit at distance 1; a narrow window shows the figure smaller. */
  focus(aspect) { return Math.min(1, 1.2 * aspect) / Math.tan(Camera.fieldOfView / 2); }
  matrix(aspect) {
    const { back, right, up } = this.axes, eye = this.eye;
    const f = this.focus(aspect), near = 0.02 * this.distance, far = 60 * this.distance;
    const view = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
                  -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
                  0, 0, 2 * far * near / (near - far), 0];
    return multiply(lens, view);
  }
  orbit(dx, dy) {
    this.yaw -= 0.008 * dx;
    this.pitch = clamp(this.pitch + 0.006 * dy, -0.1, 1.5);
  }
  zoom(factor) { this.distance = clamp(this.distance * factor, 0.05, 500); }
  move(dx, dy, height) {
    const perPixel = 2 * this.distance * Math.tan(Camera.fieldOfView / 2) / height, { right, up } = this.axes;
    this.shift = add(this.shift, add(scale(right, -dx * perPixel), scale(up, dy * perPixel)));
  }
}

const palettes = {
  light: { back: [0.953, 0.961, 0.973], floor: [0.90, 0.915, 0.935], line: [0.74, 0.77, 0.81], shade: 0.42,
           sides: [[0.52, 0.57, 0.64], [0.92, 0.42, 0.20], [0.17, 0.49, 0.78]] },
  dark: { back: [0.078, 0.090, 0.110], floor: [0.13, 0.148, 0.175], line: [0.25, 0.28, 0.33], shade: 0.62,
          sides: [[0.60, 0.65, 0.73], [0.96, 0.50, 0.27], [0.30, 0.62, 0.92]] } };
)page";

/// Drawing with WebGL 2, and with a 2D canvas where that is missing.
inline constexpr std::string_view viewer_script_draw = R"page(
/** The surface of a round cone, spanned by the shader between two spheres; `Ring` runs from pole to pole. */
const coneShader = `#version 300 es
layout(location = 0) in vec2 surface;   // 0..1: first half, 1..2: second half; angle about the axis
layout(location = 1) in vec4 from;      // centre, radius
layout(location = 2) in vec4 to;
layout(location = 3) in vec3 colour;
uniform mat4 camera;
uniform vec4 shadow;  // x, z, half width of the shadow map, height of the floor; width 0: no shadow pass
uniform vec3 light;
out vec3 normal, world, tint;
void main() {
  vec3 bone = to.xyz - from.xyz;
  float size = length(bone);
  vec3 axis = size > 1e-6 ? bone / size : vec3(0, 1, 0);
  vec3 u = normalize(cross(axis, abs(axis.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0))), v = cross(axis, u);
  float seam = asin(clamp((from.w - to.w) / max(size, 1e-6), -1.0, 1.0)), pole = 1.5707963;
  bool start = surface.x <= 1.0;
  float latitude = start ? mix(-pole, seam, surface.x) : mix(seam, pole, surface.x - 1.0);
  normal = cos(latitude) * (cos(surface.y) * u + sin(surface.y) * v) + sin(latitude) * axis;
  world = start ? from.xyz + from.w * normal : to.xyz + to.w * normal;
  tint = colour;
  gl_Position = camera * vec4(world, 1);
  if (shadow.z > 0.0) {                 // along the light onto the floor
    vec2 at = world.xz - light.xz / light.y * (world.y - shadow.w);
    gl_Position = vec4((at - shadow.xy) / shadow.z, 0, 1);
  }
}`;
/** Vertices that are in their places already. */
const meshShader = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 direction;
uniform mat4 camera;
uniform vec4 shadow;                    // as above
uniform vec3 light, colour;
out vec3 normal, world, tint;
void main() {
  world = position;
  normal = direction;
  tint = colour;
  gl_Position = camera * vec4(world, 1);
  if (shadow.z > 0.0) {
    vec2 at = world.xz - light.xz / light.y * (world.y - shadow.w);
    gl_Position = vec4((at - shadow.xy) / shadow.z, 0, 1);
  }
}`;
const bodyShader = `#version 300 es
precision highp float;
in vec3 normal, world, tint;
uniform vec3 light, eye;
uniform vec4 shadow;
out vec4 result;
void main() {
  if (shadow.z > 0.0) {                 // dark where the body is near the floor, faint where it is high
    result = vec4(mix(0.45, 1.0, exp(-2.5 * max(world.y - shadow.w, 0.0))));
    return;
  }
  vec3 n = normalize(normal), view = normalize(eye - world);
  float key = max((dot(n, light) + 0.25) / 1.25, 0.0), sky = 0.5 + 0.5 * n.y;
  float rim = pow(1.0 - max(dot(n, view), 0.0), 3.0);
  float shine = pow(max(dot(n, normalize(light + view)), 0.0), 24.0);
  float head = max(dot(n, view), 0.0);
  vec3 c = tint * (mix(0.26, 0.44, sky) + 0.54 * key + 0.20 * head) + 0.10 * rim + 0.07 * shine;
  result = vec4(c, 1);
}`;
const floorShader = `#version 300 es
layout(location = 0) in vec2 corner;
uniform mat4 camera;
uniform vec4 place;                     // centre x, z, half width, height
out vec2 at;
void main() {
  at = place.xy + corner * place.z;
  gl_Position = camera * vec4(at.x, place.w, at.y, 1);
}`;
const gridShader = `#version 300 es
precision highp float;
in vec2 at;
uniform sampler2D shadowMap;
uniform vec4 place, shadow;
uniform vec3 back, ground, line;
uniform float shade;
out vec4 result;
float grid(float step) {
  vec2 g = at / step, d = abs(fract(g - 0.5) - 0.5) / fwidth(g);
  return 1.0 - min(min(d.x, d.y), 1.0);
}
void main() {
  vec3 c = mix(ground, line, max(grid(1.0), 0.28 * grid(0.25)));
  vec2 uv = (at - shadow.xy) / shadow.z * 0.5 + 0.5;
  float dark = 0.0;
  if (clamp(uv, 0.0, 1.0) == uv) {
    for (int i = 0; i < 8; ++i) {       // eight taps on two rings of a mipmap
      float a = 0.785398 * float(i), r = i % 2 == 0 ? 0.006 : 0.014;
      dark += textureLod(shadowMap, uv + r * vec2(cos(a), sin(a)), 2.0).r / 8.0;
    }
    float here = textureLod(shadowMap, uv, 1.0).r;  // sharp where the body touches the floor
    dark = mix(dark, max(dark, here), smoothstep(0.72, 0.95, here));
  }
  c *= 1.0 - shade * dark;
  float far = smoothstep(0.15, 1.0, length(at - place.xy) / place.z);
  result = vec4(mix(c, back, far), 1);
}`;

class GlRenderer {
  kind = "webgl2";
  constructor(canvas) {
    const gl = this.gl = canvas.getContext("webgl2", { antialias: true });
    if (!gl) throw new Error("no WebGL 2");
    this.cone = this.program(coneShader, bodyShader);
    this.floor = this.program(floorShader, gridShader);
    this.makeCone(20, 7);
    if (page.body) this.makeMesh(new Mesh(page.body));
    this.makeFloor();
    this.makeShadowMap(512);
  }
  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const at = new Map();
    return { program, at: (name) => at.has(name) ? at.get(name)
      : at.set(name, gl.getUniformLocation(program, name)).get(name) };
  }
  makeCone(around, rings) {
    const gl = this.gl, vertices = [], triangles = [];
    for (let ring = 0; ring <= 2 * rings + 1; ++ring) {
      const s = ring <= rings ? ring / rings : 1 + Math.max((ring - rings - 1) / rings, 1e-5);
      for (let k = 0; k <= around; ++k) {
        vertices.push(s, 2 * Math.PI * k / around);
        if (k === around || ring === 2 * rings + 1) continue;
        const a = ring * (around + 1) + k, b = a + around + 1;
        triangles.push(a, a + 1, b, a + 1, b + 1, b);
      }
    }
    this.coneCount = triangles.length;
    this.coneArray = gl.createVertexArray();
    gl.bindVertexArray(this.coneArray);
    this.fill(gl.ARRAY_BUFFER, new Float32Array(vertices));
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    this.fill(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles));
    this.instances = this.fill(gl.ARRAY_BUFFER, new Float32Array(0));
    [[1, 4, 0], [2, 4, 16], [3, 3, 32]].forEach(([location, size, offset]) => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, gl.FLOAT, false, 44, offset);
      gl.vertexAttribDivisor(location, 1);
    });
  }
  makeMesh(mesh) {
    const gl = this.gl;
    this.mesh = mesh;
    this.meshProgram = this.program(meshShader, bodyShader);
    this.meshArray = gl.createVertexArray();
    gl.bindVertexArray(this.meshArray);
    this.fill(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
    this.meshVertices = this.fill(gl.ARRAY_BUFFER, mesh.skinned);
    for (const location of [0, 1]) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 24, 12 * location);
    }
  }
  makeFloor() {
    const gl = this.gl;
    this.floorArray = gl.createVertexArray();
    gl.bindVertexArray(this.floorArray);
    this.fill(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  }
  makeShadowMap(size) {
    const gl = this.gl;
    this.shadowSize = size;
    this.shadowMap = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    gl.texStorage2D(gl.TEXTURE_2D, 6, gl.RGBA8, size, size);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    this.shadowBuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.shadowMap, 0);
  }
  fill(target, data) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(target, buffer);
    gl.bufferData(target, data, gl.STATIC_DRAW);
    return buffer;
  }
  /** The mesh, or else this many cones. */
  drawFigure(count, uniforms) {
    const gl = this.gl, { program, at } = this.mesh ? this.meshProgram : this.cone;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("camera"), false, uniforms.camera);
    gl.uniform4fv(at("shadow"), uniforms.shadow);
    gl.uniform3fv(at("light"), uniforms.light);
    gl.uniform3fv(at("eye"), uniforms.eye);
    if (this.mesh) {
      gl.uniform3fv(at("colour"), uniforms.colour);
      gl.bindVertexArray(this.meshArray);
      gl.drawElements(gl.TRIANGLES, this.mesh.triangles.length, gl.UNSIGNED_INT, 0);
    } else {
      gl.bindVertexArray(this.coneArray);
      gl.drawElementsInstanced(gl.TRIANGLES, this.coneCount, gl.UNSIGNED_SHORT, 0, count);
    }
  }
  /** Brings the surface, or the cones, of this moment to the graphics card. */
  place({ shapes, pose, palette }) {
    const gl = this.gl;
    const data = this.mesh ? this.mesh.skin(pose) : new Float32Array(shapes.flatMap((s) =>
      [...s.from, s.radiusFrom, ...s.to, s.radiusTo, ...(s.colour || palette.sides[s.side])]));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.mesh ? this.meshVertices : this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  }
  draw(scene) {
    const gl = this.gl, { shapes, camera, palette, clip, root, width, height } = scene;
    const light = unit([0.45, 1, 0.35]), reach = 1.3 * clip.size;
    const shadow = [root[0], root[2], reach, clip.floor], matrix = camera.matrix(width / height), eye = camera.eye;
    const colour = palette.sides[0];
    this.place(scene);

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.viewport(0, 0, this.shadowSize, this.shadowSize);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.MAX);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.drawFigure(shapes.length, { camera: matrix, shadow, light, eye, colour });
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    gl.generateMipmap(gl.TEXTURE_2D);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(...palette.back, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { program, at } = this.floor, target = camera.target;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("camera"), false, matrix);
    gl.uniform4f(at("place"), target[0], target[2], 5 * camera.distance, clip.floor);
    gl.uniform4fv(at("shadow"), shadow);
    gl.uniform3fv(at("back"), palette.back);
    gl.uniform3fv(at("ground"), palette.floor);
    gl.uniform3fv(at("line"), palette.line);
    gl.uniform1f(at("shade"), palette.shade);
    gl.bindVertexArray(this.floorArray);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    this.drawFigure(shapes.length, { camera: matrix, shadow: [0, 0, 0, 0], light, eye, colour });
  }
}

/** The same picture without shading: cones as flat outlines, far ones first. */
class FlatRenderer {
  kind = "canvas";
  constructor(canvas) { this.context = canvas.getContext("2d"); }
  draw({ shapes, camera, palette, clip, root, width, height }) {
    const context = this.context, matrix = camera.matrix(width / height);
    const colour = (c) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`;
    const project = (p) => {
      const row = (r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r];
      const x = row(0), y = row(1), w = row(3);
      return { x: width * (0.5 + 0.5 * x / w), y: height * (0.5 - 0.5 * y / w), depth: w,
               scale: 0.5 * height * camera.focus(width / height) / w };
    };
    context.fillStyle = colour(palette.back);
    context.fillRect(0, 0, width, height);
    context.strokeStyle = colour(palette.line);
    context.lineWidth = 1;
    const middle = [Math.round(root[0]), Math.round(root[2])];
    for (let i = -6; i <= 6; ++i) {
      for (const [from, to] of [[[i, -6], [i, 6]], [[-6, i], [6, i]]]) {
        const a = project([middle[0] + from[0], clip.floor, middle[1] + from[1]]);
        const b = project([middle[0] + to[0], clip.floor, middle[1] + to[1]]);
        if (a.depth < 0.1 || b.depth < 0.1) continue;
        context.beginPath();
        context.moveTo(a.x, a.y);
        context.lineTo(b.x, b.y);
        context.stroke();
      }
    }
    const foot = project([root[0], clip.floor, root[2]]), spread = 0.24 * clip.size * foot.scale;
    context.fillStyle = "rgb(0 0 0 / 0.18)";
    context.beginPath();
    context.ellipse(foot.x, foot.y, spread, spread * Math.max(0.12, Math.sin(camera.pitch)), 0, 0, 2 * Math.PI);
    context.fill();

    const flat = shapes.map((s) => ({ a: project(s.from), b: project(s.to), s }))
      .filter(({ a, b }) => Math.min(a.depth, b.depth) > 0.05);
    flat.sort((f, g) => g.a.depth + g.b.depth - f.a.depth - f.b.depth);
    context.strokeStyle = colour(palette.back);
    for (const { a, b, s } of flat) {
      const ra = s.radiusFrom * a.scale, rb = s.radiusTo * b.scale;
      const axis = Math.atan2(b.y - a.y, b.x - a.x), distance = Math.hypot(b.x - a.x, b.y - a.y);
      const tangent = Math.acos(clamp((ra - rb) / Math.max(distance, 1e-9), -1, 1));
      context.fillStyle = colour(s.colour || palette.sides[s.side]);
      context.beginPath();
      context.arc(a.x, a.y, ra, axis + tangent, axis - tangent);
      context.arc(b.x, b.y, rb, axis - tangent, axis + tangent);
      context.closePath();
      context.fill();
      context.stroke();
    }
  }
}
)page";

/// One renderer for many canvases, for pages with several figures: it draws on a canvas of its own and copies.
inline constexpr std::string_view viewer_script_shared = R"page(
const dark = matchMedia("(prefers-color-scheme: dark)");

class SharedRenderer {
  constructor() {
    this.canvas = document.createElement("canvas");
    try {
      this.renderer = new GlRenderer(this.canvas);
    } catch (reason) {
      console.info("drawing without WebGL:", reason.message);
      this.canvas = document.createElement("canvas");  // a canvas that was asked for WebGL has no 2D context
      this.renderer = new FlatRenderer(this.canvas);
    }
  }
  get kind() { return this.renderer.kind; }
  /** Draws a moment of a clip on a canvas. The camera follows the figure. */
  draw(target, clip, camera, time) {
    const ratio = Math.min(devicePixelRatio || 1, 2), width = Math.round(target.clientWidth * ratio);
    const height = Math.round(target.clientHeight * ratio), pose = clip.pose(time), root = pose.positions[0];
    if (!width || !height) return;
    for (const canvas of [target, this.canvas]) {
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    }
    camera.goal = [root[0], clip.floor + 0.52 * clip.size, root[2]];
    const palette = palettes[dark.matches ? "dark" : "light"];
    this.renderer.draw({ shapes: clip.shapes(pose), pose, camera, palette, clip, root, width, height });
    target.getContext("2d").drawImage(this.canvas, 0, 0);
  }
}
/** Dragging on a canvas turns its camera, and calls `moved`. */
function turnByDragging(canvas, camera, moved) {
  let from = null;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    from = event;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    camera.orbit(event.clientX - from.clientX, event.clientY - from.clientY);
    from = event;
    moved();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { from = null; });
}
const sharedClips = () => page.motions.map((m) => new Clip({ ...page.figures[m.figure], ...m }));
)page";

/// The player: one clip, its time, the camera, and their buttons, keys, mouse and fingers. The page calls showClip. It
/// has a function showMoment, which the player calls with every picture.
inline constexpr std::string_view viewer_script_player = R"page(
const camera = new Camera(), canvas = element("view");
const hues = ["#2b78c5", "#d0621c", "#2f9157", "#8a58c2", "#c0436d", "#97801b"];
const dark = matchMedia("(prefers-color-scheme: dark)");
let clip = null, time = 0, playing = false, looping = true, following = true, speed = 1;
let scheduled = false, before = 0;
let decorate = () => {};  // changes the cones of the figure, or adds to them, before they are drawn
let pace = 16, quality = 1;  // milliseconds between frames, pixels drawn per pixel of the screen
let steady = false;          // the picture keeps its size, as while it is recorded

let renderer;
try {
  renderer = new GlRenderer(canvas);
} catch (reason) {
  console.info("drawing without WebGL:", reason.message);
  const fresh = canvas.cloneNode();  // a canvas that was asked for WebGL has no 2D context
  if (!canvas.getContext("2d")) canvas.replaceWith(fresh);
  renderer = new FlatRenderer(element("view"));
}
const view = element("view");

const text = (tag, content, parent) => {
  const e = document.createElement(tag);
  e.textContent = content;
  parent.append(e);
  return e;
};
const shown = (seconds) => seconds.toFixed(2) + " s";

function seek(seconds) {
  time = clamp(seconds, 0, clip.seconds);
  refresh();
}
function play(on) {
  playing = on && clip.seconds > 0;
  if (playing && !looping && time >= clip.seconds) seek(0);
  element("play").textContent = playing ? "Pause" : "Play";
  element("play").setAttribute("aria-pressed", playing);
  before = performance.now();
  refresh();
}
function showClip(next) {
  clip = next;
  element("scrub").max = clip.seconds || 1;
  element("play").disabled = element("scrub").disabled = clip.seconds === 0;
}
function drawAxis(axis, length, limit = 12) {
  const most = clamp(axis.clientWidth / 50, 3, limit);  // marks
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 300].find((s) => length / s <= most) || length / 10;
  axis.replaceChildren();
  for (let t = 0; t <= length + 1e-9; t += step) {
    text("span", +t.toFixed(1) + " s", axis).style.left = 100 * t / length + "%";
  }
}

function render() {
  const ratio = quality * Math.min(devicePixelRatio || 1, 2), pose = clip.pose(time), root = pose.positions[0];
  const width = steady ? view.width : Math.round(view.clientWidth * ratio);
  const height = steady ? view.height : Math.round(view.clientHeight * ratio);
  if (!width || !height) return;
  if (view.width !== width || view.height !== height) Object.assign(view, { width, height });
  if (following) camera.goal = [root[0], clip.floor + 0.52 * clip.size, root[2]];
  const palette = palettes[dark.matches ? "dark" : "light"], shapes = clip.shapes(pose);
  decorate(shapes, palette);
  renderer.draw({ shapes, pose, camera, palette, clip, root, width, height });

  element("scrub").value = time;
  element("clock").textContent = `${shown(time)} / ${shown(clip.seconds)} \u00b7 frame ${Math.round(time * clip.fps)}`;
  element("scrub").setAttribute("aria-valuetext", shown(time));
  showMoment();
}
/** Asks for one more frame; while the motion plays, every frame asks for the next. */
function refresh() {
  if (!scheduled) requestAnimationFrame(frame);
  scheduled = true;
}
function frame(now) {
  scheduled = false;
  if (playing) {
    time += speed * Math.max(0, now - before) / 1000;
    pace = mix(pace, now - before, 0.15);
    before = now;
    if (pace > 60 && quality > 0.5 && !steady) [pace, quality] = [30, 0.8 * quality];  // slow to draw: coarser
    if (time > clip.seconds && looping) time %= clip.seconds;
    if (time > clip.seconds) seek(clip.seconds), play(false);
    refresh();
  }
  render();
}

// Buttons and keys.
const toggle = (id, change) => element(id).addEventListener("click", () => {
  const on = element(id).getAttribute("aria-pressed") !== "true";
  element(id).setAttribute("aria-pressed", on);
  change(on);
  refresh();
});
element("play").addEventListener("click", () => play(!playing));
toggle("loop", (on) => { looping = on; });
toggle("follow", (on) => { following = on; });
element("reset").addEventListener("click", () => { camera.reset(clip); refresh(); });
element("speed").addEventListener("change", (event) => { speed = +event.target.value; });
element("scrub").addEventListener("input", (event) => { seek(+event.target.value); });
/** Pressing or dragging on a surface seeks. The width of `area` stands for length() seconds. */
function seekByDragging(surface, area, length) {
  surface.addEventListener("pointerdown", (event) => {
    const place = area.getBoundingClientRect();
    const go = (e) => { seek(length() * (e.clientX - place.left) / place.width); };
    const stop = () => { removeEventListener("pointermove", go); removeEventListener("pointerup", stop); };
    go(event);
    addEventListener("pointermove", go);
    addEventListener("pointerup", stop);
  });
}
const step = (frames) => { play(false); seek((Math.round(time * clip.fps) + frames) / clip.fps); };
const keys = {
  " ": () => play(!playing), ",": () => step(-1), ".": () => step(1),
  Home: () => seek(0), End: () => seek(clip.seconds),
  f: () => element("follow").click(), l: () => element("loop").click(), r: () => element("reset").click() };
const viewKeys = {
  ArrowLeft: () => camera.orbit(-20, 0), ArrowRight: () => camera.orbit(20, 0), ArrowUp: () => camera.orbit(0, 20),
  ArrowDown: () => camera.orbit(0, -20), "+": () => camera.zoom(0.9), "-": () => camera.zoom(1.1) };
const frameKeys = { ArrowLeft: () => step(-1), ArrowRight: () => step(1) };
/** True for fields in which a person writes. */
const takesText = (e) => e.matches("textarea, input:not([type=range]):not([type=checkbox])");
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || takesText(event.target)) return;
  const tag = event.target.tagName;
  if (tag === "SELECT" || (tag === "BUTTON" && (event.key === " " || event.key === "Enter"))) return;
  if (tag === "INPUT" && /^( |Arrow|Home|End)/.test(event.key)) return;
  const action = (event.target === view ? viewKeys : frameKeys)[event.key] || keys[event.key];
  if (!action) return;
  event.preventDefault();
  action();
  refresh();
});

// Mouse and fingers: one turns, two zoom.
const pointers = new Map();
const spread = () => {
  const [a, b] = [...pointers.values()];
  return Math.hypot(a.x - b.x, a.y - b.y);
};
view.addEventListener("pointerdown", (event) => {
  view.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
});
view.addEventListener("pointermove", (event) => {
  const last = pointers.get(event.pointerId);
  if (!last) return;
  const dx = event.clientX - last.x, dy = event.clientY - last.y, apart = pointers.size === 2 ? spread() : 0;
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  if (pointers.size === 2) camera.zoom(apart / Math.max(spread(), 1));
  else if (event.shiftKey || event.buttons > 1) camera.move(dx, dy, view.clientHeight);
  else camera.orbit(dx, dy);
  refresh();
});
for (const end of ["pointerup", "pointercancel"]) {
  view.addEventListener(end, (event) => pointers.delete(event.pointerId));
}
view.addEventListener("contextmenu", (event) => event.preventDefault());
view.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.zoom(Math.exp(0.001 * event.deltaY));
  refresh();
}, { passive: false });
dark.addEventListener("change", refresh);

/** What is shown now, as a copy, for scripts that look at the page. */
const playerState = () => ({
  playing, time, seconds: clip.seconds, frame: Math.round(time * clip.fps), frames: clip.frames, fps: clip.fps, speed,
  following, renderer: renderer.kind, joints: clip.pose(time).positions,
  camera: { yaw: camera.yaw, pitch: camera.pitch, distance: camera.distance } });
)page";

/// The viewer's motions and their timelines.
inline constexpr std::string_view viewer_script_control = R"page(
const clips = page.motions.map((m) => new Clip(m));

function choose(number) {
  showClip(clips[number]);
  camera.reset(clip);
  element("info").textContent = [page.info, clip.note, `${clip.parents.length} joints`, `${clip.frames} frames`,
    `${+clip.fps.toFixed(3)} fps`].filter(Boolean).join(" \u00b7 ");
  buildTimeline();
  seek(0);
  if (playing) play(true);
}

function buildTimeline() {
  const tracks = element("tracks"), length = clip.seconds || 1;
  tracks.replaceChildren(element("cursor"));
  element("timeline").hidden = clip.tracks.length === 0;
  drawAxis(element("axis"), length);
  clip.tracks.forEach((track, i) => {
    const row = text("div", "", tracks), bar = text("button", "", row), label = text("span", track.text, bar);
    row.className = "track";
    bar.className = "bar";
    bar.type = "button";
    const from = clamp(track.start, 0, length), to = clamp(track.end, from, length);
    Object.assign(bar.style, { left: 100 * from / length + "%", width: 100 * (to - from) / length + "%" });
    bar.style.setProperty("--hue", hues[i % hues.length]);
    bar.title = [`${track.text}: ${shown(track.start)} to ${shown(track.end)}`, ...track.parts].join(", ");
    bar.setAttribute("aria-label", bar.title);
    if (track.parts.length) text("small", track.parts.join(" \u00b7 "), label);
    bar.addEventListener("click", (event) => { if (event.detail === 0) seek(track.start); });  // by keyboard
  });
  placeLabels();
}
/** A text that would run out of the picture ends at the right end of its bar instead, or is cut. */
function placeLabels() {
  const { left, right } = element("tracks").getBoundingClientRect();
  for (const bar of document.querySelectorAll(".bar")) {
    const label = bar.firstChild;
    bar.classList.remove("turned");
    label.style.maxWidth = "";
    const place = label.getBoundingClientRect(), overflows = place.right > right;
    if (overflows && bar.getBoundingClientRect().right - place.width > left) bar.classList.add("turned");
    else if (overflows) label.style.maxWidth = right - place.left + "px";
  }
}
function showMoment() {
  element("cursor").style.left = 100 * time / (clip.seconds || 1) + "%";
  document.querySelectorAll(".bar").forEach((bar, i) =>
    bar.classList.toggle("now", clip.tracks[i].start <= time && time < clip.tracks[i].end));
}
element("motion").addEventListener("change", (event) => { choose(+event.target.value); });
seekByDragging(element("timeline"), element("tracks"), () => clip.seconds);
new ResizeObserver(() => { placeLabels(); refresh(); }).observe(element("stage"));

window.motionlang = Object.freeze({ state: () => ({
  name: clip.name, motion: clips.indexOf(clip), motions: clips.length, ...playerState() }) });

element("title").textContent = page.title;
clips.forEach((c, i) => { text("option", c.name || `motion ${i + 1}`, element("motion")).value = i; });
element("choice").hidden = clips.length < 2;
choose(0);
play(page.autoplay && !matchMedia("(prefers-reduced-motion: reduce)").matches);
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
