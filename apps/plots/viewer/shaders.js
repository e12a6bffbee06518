// One program for all pieces of members: it places the mesh of a section at the samples, which it reads from textures.

const VERTEX_SHADER = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
in vec4 along2, along3;   // of a corner, as factors of width, height, wall, web
in vec3 normal;           // along axes 2, 3, 1
in float end;
in uvec2 piece;           // samples at its ends
uniform sampler2D reference, dimensions, displacement, triad, restTriad, mode;
uniform mat4 toClip;
uniform mat3 toEye;
uniform float scale, amplitude, thickness, thinnest;
uniform bool ghost, aligned; // aligned: whatever the directions are
uniform ivec2 marked;     // samples of the member under the pointer
out vec3 eyeNormal;
out float value, highlight;

ivec2 cell(int sampleNumber) { int width = textureSize(reference, 0).x; return ivec2(sampleNumber % width, sampleNumber / width); }
vec3 turned(vec4 q, vec3 v) { vec3 t = 2.0 * cross(q.yzw, v); return v + q.x * t + cross(q.yzw, t); }
vec3 place(int i) {
  ivec2 at = cell(i);
  vec3 p = texelFetch(reference, at, 0).xyz;
  if (ghost) return p;
  return p + scale * texelFetch(displacement, at, 0).xyz + amplitude * texelFetch(mode, at, 0).xyz;
}
// q = w, x, y, z
vec4 product(vec4 a, vec4 b) { return vec4(a.x * b.x - dot(a.yzw, b.yzw), a.x * b.yzw + b.x * a.yzw + cross(a.yzw, b.yzw)); }
// The share of a rotation that belongs to scaled displacements.
vec4 scaled(vec4 q) {
  if (q.x < 0.0) q = -q;
  float sine = length(q.yzw);
  if (sine < 1e-6) return vec4(1, 0, 0, 0);
  float half_ = clamp(scale * atan(sine, q.x), -1.5, 1.5);
  return vec4(cos(half_), sin(half_) / sine * q.yzw);
}
vec4 triadAt(int i) {
  ivec2 at = cell(i);
  vec4 rest = texelFetch(restTriad, at, 0);
  if (ghost) return rest;
  vec4 now = texelFetch(triad, at, 0);
  if (scale == 1.0) return now;
  return product(scaled(product(now, vec4(rest.x, -rest.yzw))), rest);
}
// Turns a section square to the line that is drawn, where that is not the computed one.
void align(int i, float tag, inout vec3 g1, inout vec3 g2, inout vec3 g3) {
  vec3 along = place(tag == 2.0 ? i : i + 1) - place(tag == 1.0 ? i : i - 1);
  if (!(dot(along, along) > 0.0)) return;
  along = normalize(along);
  vec3 axis = cross(g1, along);
  float cosine = dot(g1, along);
  if (cosine < (aligned ? -0.9999 : -0.9)) return;
  vec4 q = normalize(vec4(1.0 + cosine, axis));
  g1 = along; g2 = turned(q, g2); g3 = turned(q, g3);
}
void main() {
  int i = int(end > 0.5 ? piece.y : piece.x);
  ivec2 at = cell(i);
  float tag = texelFetch(reference, at, 0).w;
  vec4 q = triadAt(i);
  vec3 g1 = turned(q, vec3(1, 0, 0)), g2 = turned(q, vec3(0, 1, 0)), g3 = turned(q, vec3(0, 0, 1));
  if (!ghost && (aligned || scale != 1.0 || amplitude != 0.0)) align(i, tag, g1, g2, g3);
  // A member never gets thinner than what can be seen.
  vec4 d = max(thickness * texelFetch(dimensions, at, 0), thinnest * vec4(1, 1, 0.3, 0.3));
  d.zw = min(d.zw, 0.5 * d.xx);
  vec3 p = place(i) + dot(along2, d) * g2 + dot(along3, d) * g3;
  float sign1 = tag == 1.0 ? -1.0 : 1.0;
  vec2 n = normalize(vec2(normal.x * d.y, normal.y * d.x) + vec2(1e-20, 0));
  vec3 n3 = normal.z > 0.5 ? sign1 * g1 : n.x * g2 + n.y * g3;
  eyeNormal = toEye * n3;
  value = texelFetch(displacement, at, 0).w;
  highlight = i >= marked.x && i <= marked.y ? 1.0 : 0.0;
  gl_Position = toClip * vec4(p, 1);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 eyeNormal;
in float value, highlight;
uniform sampler2D colors;
uniform vec2 range;       // values at the ends of the scale of colours
uniform vec4 plain;       // colour of ghosts; alpha 0: by value
uniform vec3 unknown;
out vec4 color;
void main() {
  vec3 n = normalize(eyeNormal);
  if (n.z < 0.0) n = -n;
  float light = 0.62 + 0.42 * max(dot(n, normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
  float shine = 0.10 * pow(max(dot(n, normalize(vec3(-0.18, 0.30, 0.94))), 0.0), 40.0);
  if (plain.a > 0.0) { color = vec4(plain.rgb * light, plain.a); return; }
  float share = clamp((value - range.x) / max(range.y - range.x, 1e-35), 0.0, 1.0);
  vec3 own = abs(value) > 1e29 ? unknown : texture(colors, vec2(share * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  color = vec4(mix(own * light + shine, vec3(1.0), 0.28 * highlight), 1);
}`;
