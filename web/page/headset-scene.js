// Draws boards, hands and a panel for each eye in bare WebGL 2. Everything is a prism with rounded corners, whose front may show
// a part of a picture, or a capsule.

const PRISM_FLOATS = 20;
const CORNER_STEPS = 6;
const RINGS = 5;
const SECTORS = 10;
/** Width and height of the picture with all labels, in pixels, and the pixels along the shorter side of a key. */
const ATLAS_PX = 2048;
const LABEL_PX = 64;
const MAX_LABEL_M = 0.012;
const PANEL_PX = [1024, 320];

const HEAD = "#version 300 es\nprecision highp float;\nuniform mat4 clip;\n";
const PRISM_VERTEX = `${HEAD}
layout(location=0) in vec4 corner; layout(location=1) in vec2 level;
layout(location=2) in vec3 at; layout(location=3) in vec4 turn; layout(location=4) in vec4 size; layout(location=5) in vec4 color; layout(location=6) in vec4 part; layout(location=7) in float light;
out vec3 point; out vec3 normal; out vec4 paint; out vec2 uv; out vec2 flags;
vec3 spin(vec3 v){ vec3 t = 2.*cross(turn.xyz, v); return v + turn.w*t + cross(turn.xyz, t); }
void main(){
  vec2 flat2 = corner.xy*(size.xy - size.z) + corner.zw*size.z;
  point = at + spin(vec3(flat2, -level.x*size.w));
  normal = spin(level.y > .5 ? vec3(0., 0., 1.) : vec3(corner.zw, 0.));
  vec2 inside = flat2/size.xy*.5 + .5;
  uv = part.xy + vec2(inside.x, 1. - inside.y)*part.zw;
  flags = vec2(level.y > .5 && part.z > 0. ? 1. : 0., light);
  paint = color;
  gl_Position = clip*vec4(point, 1.);
}`;
const PRISM_FRAGMENT = `${HEAD}
in vec3 point; in vec3 normal; in vec4 paint; in vec2 uv; in vec2 flags;
uniform sampler2D picture; uniform vec3 eye; uniform vec3 tips[10]; uniform vec3 glow; uniform vec3 ink; uniform bool isPicture;
out vec4 color;
void main(){
  vec3 n = normalize(normal);
  float near = 0.;
  if (paint.a > 0.) for (int i = 0; i < 10; i++) near = max(near, 1. - smoothstep(.004, .045, distance(point, tips[i])));
  vec3 base = mix(paint.rgb, glow, flags.y);
  vec4 texel = texture(picture, uv);
  if (isPicture) { color = vec4(texel.rgb, 1.); return; }
  base = mix(base, flags.y > .5 ? ink*.2 : ink, flags.x*texel.a);
  float shade = .55 + .35*max(dot(n, normalize(vec3(.3, 1., .4))), 0.) + .1*max(dot(n, normalize(eye - point)), 0.);
  color = vec4(base*mix(shade, 1., flags.y) + glow*near*near*.55*paint.a, 1.);
}`;
const BONE_VERTEX = `${HEAD}
layout(location=0) in vec4 ball; layout(location=2) in vec4 from; layout(location=3) in vec4 to; layout(location=4) in vec3 color;
out vec3 point; out vec3 normal; out vec3 paint;
void main(){
  vec3 way = to.xyz - from.xyz;
  vec3 z = length(way) > 1e-5 ? normalize(way) : vec3(0., 0., 1.);
  vec3 x = normalize(cross(abs(z.y) < .9 ? vec3(0., 1., 0.) : vec3(1., 0., 0.), z));
  normal = mat3(x, cross(z, x), z)*ball.xyz;
  point = mix(from.xyz, to.xyz, ball.w) + normal*mix(from.w, to.w, ball.w);
  paint = color;
  gl_Position = clip*vec4(point, 1.);
}`;
const BONE_FRAGMENT = `${HEAD}
in vec3 point; in vec3 normal; in vec3 paint; uniform vec3 eye; out vec4 color;
void main(){
  vec3 n = normalize(normal);
  float rim = max(dot(n, normalize(eye - point)), 0.);
  color = vec4(paint*(.45 + .35*max(n.y, 0.) + .3*rim), 1.);
}`;

/** Returns the vertices of a prism: signs and directions of corners, the level (0 the front), and 1 for the front. */
function prismVertices() {
  const corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
  const outline = corners.flatMap(([x, y], corner) => Array.from({ length: CORNER_STEPS + 1 }, (_, step) => {
    const angle = (corner + step / CORNER_STEPS) * (Math.PI / 2);
    return [x, y, Math.cos(angle), Math.sin(angle)];
  }));
  return outline.flatMap((one, index) => {
    const next = outline[(index + 1) % outline.length];
    return [
      [0, 0, 0, 0, 0, 1], [...one, 0, 1], [...next, 0, 1],
      [...one, 0, 0], [...one, 1, 0], [...next, 0, 0], [...next, 0, 0], [...one, 1, 0], [...next, 1, 0],
    ].flat();
  });
}

/** Returns the vertices of a capsule: points of a ball, and the end to which they belong. */
function boneVertices() {
  const rings = [];
  for (let ring = 0; ring <= 2 * RINGS + 1; ring += 1) {
    const end = ring > RINGS ? 1 : 0;
    const angle = ((ring - end) / RINGS - 1) * (Math.PI / 2);
    rings.push(Array.from({ length: SECTORS + 1 }, (_, sector) => {
      const turn = (sector / SECTORS) * 2 * Math.PI;
      return [Math.cos(turn) * Math.cos(angle), Math.sin(turn) * Math.cos(angle), Math.sin(angle), end];
    }));
  }
  return rings.slice(1).flatMap((ring, index) => ring.slice(1).flatMap((point, sector) => {
    const below = rings[index];
    return [below[sector], below[sector + 1], point, below[sector], point, ring[sector]].flat();
  }));
}

export class Scene {
  constructor(gl) {
    this.gl = gl;
    this.prisms = this.#mesh(PRISM_VERTEX, PRISM_FRAGMENT, prismVertices(), [4, 2], [3, 4, 4, 4, 4, 1]);
    this.bones = this.#mesh(BONE_VERTEX, BONE_FRAGMENT, boneVertices(), [4], [4, 4, 3]);
    [this.labels, this.panel] = [gl.createTexture(), gl.createTexture()];
    this.panelCanvas = Object.assign(document.createElement("canvas"), { width: PANEL_PX[0], height: PANEL_PX[1] });
    this.parts = new Map();
    gl.enable(gl.DEPTH_TEST);
  }

  #mesh(vertex, fragment, vertices, own, each) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`the picture cannot be drawn: ${gl.getProgramInfoLog(program)}`);
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attributes = (sizes, first, divisor) => {
      const stride = 4 * sizes.reduce((sum, size) => sum + size, 0);
      let offset = 0;
      sizes.forEach((size, index) => {
        gl.enableVertexAttribArray(first + index);
        gl.vertexAttribPointer(first + index, size, gl.FLOAT, false, stride, offset);
        gl.vertexAttribDivisor(first + index, divisor);
        offset += 4 * size;
      });
      return stride / 4;
    };
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
    const count = vertices.length / attributes(own, 0, 0);
    const instances = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    attributes(each, 2, 1);
    gl.bindVertexArray(null);
    return { program, array, count, instances, uniform: (name) => gl.getUniformLocation(program, name) };
  }

  /** Writes the labels of the targets of a layout into a picture. */
  setLabels(boards) {
    const canvas = Object.assign(document.createElement("canvas"), { width: ATLAS_PX, height: ATLAS_PX });
    const context = canvas.getContext("2d");
    Object.assign(context, { textAlign: "center", textBaseline: "middle", fillStyle: "#fff" });
    let [left, top, row] = [0, 0, 0];
    this.parts.clear();
    for (const target of boards.flatMap((board) => board.targets)) {
      if (!target.label) continue;
      const [halfX, halfY] = target.half_m;
      const pixels = LABEL_PX / Math.min(halfX, halfY) / 2;
      const [width, height] = [halfX, halfY].map((half) => Math.min(Math.ceil(2 * half * pixels), 4 * LABEL_PX));
      if (left + width > ATLAS_PX) [left, top, row] = [0, top + row, 0];
      if (top + height > ATLAS_PX) break;
      context.font = "600 100px system-ui, sans-serif";
      const wide = context.measureText(target.label).width / 100;
      const size = Math.min(halfY * 0.95, (1.7 * halfX) / Math.max(wide, 0.4), MAX_LABEL_M);
      context.save();
      context.translate(left + width / 2, top + height / 2);
      context.scale(width / (2 * halfX) / 1000, height / (2 * halfY) / 1000);
      context.font = `600 ${size * 1000}px system-ui, sans-serif`;
      context.fillText(target.label, 0, size * 40);
      context.restore();
      this.parts.set(target.id, [left, top, width, height].map((it) => it / ATLAS_PX));
      left += width;
      row = Math.max(row, height);
    }
    this.#upload(this.labels, canvas);
  }

  /** Draws on the panel: `paint` receives its context, width and height. */
  setPanel(paint) {
    paint(this.panelCanvas.getContext("2d"), ...PANEL_PX);
    this.#upload(this.panel, this.panelCanvas);
  }

  #upload(texture, canvas) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  }

  /**
   * Draws a picture for each view. A prism is { pose, half, radius, height, color, part, light, isLit }, whose front is at its
   * pose; a bone is { from, to, radii, color }; tips are points that light what is near them.
   */
  draw(views, { prisms, panel, bones, tips, glow, ink }) {
    const { gl } = this;
    const lights = new Float32Array(30).fill(1e3);
    tips.slice(0, 10).forEach((tip, index) => lights.set(tip, 3 * index));
    const data = [...prisms, panel].flatMap((it) => [
      ...it.pose, ...it.half, it.radius, it.height, ...it.color, it.isLit ? 1 : 0, ...(it.part ?? [0, 0, 0, 0]), it.light ?? 0,
    ]);
    this.#fill(this.prisms, data);
    this.#fill(this.bones, bones.flatMap((it) => [...it.from, it.radii[0], ...it.to, it.radii[1], ...it.color]));
    const { prisms: boxes, bones: capsules } = this;
    for (const { viewport, clip, eye } of views) {
      gl.viewport(viewport.x, viewport.y, viewport.width, viewport.height);
      const use = (mesh) => {
        gl.useProgram(mesh.program);
        gl.bindVertexArray(mesh.array);
        gl.uniformMatrix4fv(mesh.uniform("clip"), false, clip);
        gl.uniform3fv(mesh.uniform("eye"), eye);
      };
      use(boxes);
      gl.uniform3fv(boxes.uniform("tips"), lights);
      gl.uniform3fv(boxes.uniform("glow"), glow);
      gl.uniform3fv(boxes.uniform("ink"), ink);
      gl.uniform1i(boxes.uniform("isPicture"), 0);
      gl.bindTexture(gl.TEXTURE_2D, this.labels);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, boxes.count, prisms.length);
      // The panel is the last instance.
      this.#offset(boxes, prisms.length);
      gl.uniform1i(boxes.uniform("isPicture"), 1);
      gl.bindTexture(gl.TEXTURE_2D, this.panel);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, boxes.count, 1);
      this.#offset(boxes, 0);
      use(capsules);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, capsules.count, bones.length);
    }
    gl.bindVertexArray(null);
  }

  #fill(mesh, numbers) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.instances);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STREAM_DRAW);
  }

  /** Makes an instance the first one of the next call. */
  #offset(mesh, first) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.instances);
    let offset = 0;
    [3, 4, 4, 4, 4, 1].forEach((size, index) => {
      gl.vertexAttribPointer(2 + index, size, gl.FLOAT, false, 4 * PRISM_FLOATS, 4 * (first * PRISM_FLOATS + offset));
      offset += size;
    });
  }
}

/** Returns the product of two matrices of WebGL, by columns. */
export function product(m, n) {
  return Float32Array.from({ length: 16 }, (_, at) => {
    let sum = 0;
    for (let k = 0; k < 4; k += 1) sum += m[k * 4 + (at & 3)] * n[(at & ~3) + k];
    return sum;
  });
}
