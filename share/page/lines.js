'use strict';
// Lines some pixels wide, which WebGL itself does not have: two triangles a segment.

const lineVertex = `
precision highp float;
attribute vec3 position, other;  // this end of the segment and the other one
attribute float side;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec2 picture;  // its size in pixels
uniform float width;
const float near = 0.02;

void main() {
  vec4 a = modelViewMatrix * vec4(position, 1.0);
  vec4 b = modelViewMatrix * vec4(other, 1.0);
  // An end behind the eye is brought before it.
  if (a.z > -near && b.z < -near) a = mix(a, b, (a.z + near) / (a.z - b.z));
  if (b.z > -near && a.z < -near) b = mix(b, a, (b.z + near) / (b.z - a.z));
  a = projectionMatrix * a;
  b = projectionMatrix * b;
  vec2 along = (b.xy / b.w - a.xy / a.w) * picture;
  vec2 across = length(along) > 1e-6 ? normalize(vec2(-along.y, along.x)) : vec2(0.0, 1.0);
  a.xy += side * width * across / picture * a.w;
  gl_Position = vec4(a.xy, 0.0, a.w);  // always before the points
}`;

const lineFragment = `
precision mediump float;
uniform vec3 colour;
void main() { gl_FragColor = vec4(colour, 1.0); }`;

/** Segments between pairs of places; the places lie about `origin`. */
class Lines {
  constructor(pairs, colour, width) {
    const origin = pairs.length ? pairs[0][0] : [0, 0, 0];
    const count = pairs.length;
    const position = new Float32Array(12 * count), other = new Float32Array(12 * count);
    const side = new Float32Array(4 * count), index = new Uint32Array(6 * count);
    pairs.forEach((pair, i) => {
      for (let k = 0; k < 4; ++k) {
        const vertex = 4 * i + k, end = k >> 1;
        for (let axis = 0; axis < 3; ++axis) {
          position[3 * vertex + axis] = pair[end][axis] - origin[axis];
          other[3 * vertex + axis] = pair[1 - end][axis] - origin[axis];
        }
        // Seen from its other end, left is right.
        side[vertex] = (k & 1) === end ? 1 : -1;
      }
      const first = 4 * i;
      index.set([first, first + 1, first + 2, first + 2, first + 1, first + 3], 6 * i);
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
    geometry.setAttribute('other', new THREE.BufferAttribute(other, 3));
    geometry.setAttribute('side', new THREE.BufferAttribute(side, 1));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.uniforms = {colour: {value: new THREE.Color(colour)}, width: {value: width},
                     picture: {value: new THREE.Vector2(1, 1)}};
    this.object = new THREE.Mesh(geometry, new THREE.RawShaderMaterial({
      vertexShader: lineVertex, fragmentShader: lineFragment, uniforms: this.uniforms,
      depthTest: false, depthWrite: false, side: THREE.DoubleSide}));
    this.object.frustumCulled = false;
    this.object.position.fromArray(origin);
  }

  static along(places, colour, width) {
    return new Lines(places.slice(1).map((place, i) => [places[i], place]), colour, width);
  }
}
