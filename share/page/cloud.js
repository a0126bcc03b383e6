'use strict';
// The points: an object a tile, which lies at the tile's origin; its vertices are whole numbers.

const cloudVertex = `
precision highp float;
attribute vec4 position;  // millimetres from the tile's origin; height above the ground
attribute vec4 known;     // intensity, observations, time (low byte, high byte)
uniform mat4 modelViewMatrix, projectionMatrix;
uniform sampler2D ramp;
uniform int mode;
uniform float tileHeight;
uniform vec2 range, section;
uniform vec3 plain;
uniform float focal, size_m, least;
varying vec3 colour;

float valueOf(float ground) {
  if (mode == 0) return tileHeight + ${quantum_m} * position.z;
  if (mode == 1) return ground;
  if (mode == 2) return known.x / 255.0;
  if (mode == 3) return (known.z + 256.0 * known.w) / 65535.0;
  return known.y;
}

void main() {
  float ground = ${groundQuantum_m} * position.w + float(${lowestGround_m});
  if (ground < section.x || ground > section.y) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside the picture
    gl_PointSize = 0.0;
    return;
  }
  gl_Position = projectionMatrix * modelViewMatrix * vec4(${quantum_m} * position.xyz, 1.0);
  gl_PointSize = clamp(size_m * focal / max(gl_Position.w, 0.01), least, 60.0);
  float share = clamp((valueOf(ground) - range.x) / (range.y - range.x), 0.0, 1.0);
  colour = mode < 0 ? plain : texture2D(ramp, vec2((share * 63.0 + 0.5) / 64.0, 0.5)).rgb;
}`;

const cloudFragment = `
precision mediump float;
varying vec3 colour;
void main() {
  vec2 fromMiddle = gl_PointCoord - 0.5;
  if (dot(fromMiddle, fromMiddle) > 0.25) discard;
  gl_FragColor = vec4(colour, 1.0);
}`;

/** The bytes r g b of a colour map, 64 of them. */
function rampOf(name) {
  return Uint8Array.from(about.colours[name].match(/../g), pair => parseInt(pair, 16));
}

/** One cloud of the page. `uniforms` are shared by all its tiles but for the tile's own height. */
class Cloud {
  constructor(what, placesId, knownId, mode) {
    const count = what.shown;
    this.what = what;
    this.places = new Uint16Array(bytesOf(placesId, 8 * count).buffer);
    this.known = bytesOf(knownId, 4 * count);
    const texture = new THREE.DataTexture(rampOf('turbo'), 64, 1, THREE.RGBFormat);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.unpackAlignment = 1;
    texture.needsUpdate = true;
    this.uniforms = {
      ramp: {value: texture}, mode: {value: mode}, range: {value: new THREE.Vector2(0, 1)},
      section: {value: new THREE.Vector2(-1e6, 1e6)}, plain: {value: new THREE.Color(0xff3b30)},
      focal: {value: 1}, size_m: {value: 0.1}, least: {value: 2}, tileHeight: {value: 0},
    };
    this.object = new THREE.Group();
    const material = new THREE.RawShaderMaterial(
        {vertexShader: cloudVertex, fragmentShader: cloudFragment, uniforms: this.uniforms});
    for (const [x, y, z, begin, tileCount] of what.tiles) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(
          this.places.subarray(4 * begin, 4 * (begin + tileCount)), 4));
      geometry.setAttribute('known', new THREE.BufferAttribute(
          this.known.subarray(4 * begin, 4 * (begin + tileCount)), 4));
      const half = tile_m / 2;
      geometry.boundingSphere =  // of the vertices: three.js turns it with the object
          new THREE.Sphere(new THREE.Vector3(half, half, half), half * Math.sqrt(3));
      const points = new THREE.Points(geometry, material);
      points.position.set(x, y, z);
      points.onBeforeRender = () => {
        this.uniforms.tileHeight.value = z;
        material.uniformsNeedUpdate = true;
      };
      points.userData.count = tileCount;
      this.object.add(points);
    }
  }

  /** The first points of a tile are an even choice of them. */
  draw(share) {
    for (const tile of this.object.children)
      tile.geometry.setDrawRange(0, Math.ceil(share * tile.userData.count));
  }

  setRamp(name) {
    this.uniforms.ramp.value.image.data = rampOf(name);
    this.uniforms.ramp.value.needsUpdate = true;
  }

  /** The point that a click at (x, y) means, in pixels of a picture of width and height: near the
   *  ray, and of those in front; null where there is none. */
  pointAt(x, y, matrix, width, height) {
    const reach = 10;  // pixels
    const section = this.uniforms.section.value;
    let best = null, bestScore = Infinity;
    for (const [ox, oy, oz, begin, count] of this.what.tiles) {
      // Rows of the matrix with the tile's origin and the quantum taken in.
      const m = matrix.elements;
      const row = k => [m[k] * quantum_m, m[k + 4] * quantum_m, m[k + 8] * quantum_m,
                        m[k] * ox + m[k + 4] * oy + m[k + 8] * oz + m[k + 12]];
      const [ax, ay, az, aw] = row(0), [bx, by, bz, bw] = row(1), [cx, cy, cz, cw] = row(3);
      for (let i = 4 * begin; i < 4 * (begin + count); i += 4) {
        const px = this.places[i], py = this.places[i + 1], pz = this.places[i + 2];
        const w = cx * px + cy * py + cz * pz + cw;
        if (w < 0.05) continue;
        const u = ((ax * px + ay * py + az * pz + aw) / w + 1) / 2 * width - x;
        const v = (1 - (bx * px + by * py + bz * pz + bw) / w) / 2 * height - y;
        const off = u * u + v * v;
        if (off > reach * reach) continue;
        const score = w * (1 + off / (reach * reach));
        const ground = groundQuantum_m * this.places[i + 3] + lowestGround_m;
        if (score >= bestScore || ground < section.x || ground > section.y) continue;
        bestScore = score;
        best = new THREE.Vector3(ox + quantum_m * px, oy + quantum_m * py, oz + quantum_m * pz);
      }
    }
    return best;
  }
}
