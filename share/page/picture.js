'use strict';
// Draws: points, the shading of their edges (eye-dome lighting, after C. Boucheny), then lines.

const wholeVertex = `
precision highp float;
attribute vec3 position;
varying vec2 at;
void main() {
  at = 0.5 * position.xy + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const shadeFragment = `
precision highp float;
uniform sampler2D colours, depths;
uniform vec2 step, limits;  // a pixel; the nearest and farthest that is drawn
varying vec2 at;

float logDepth(vec2 where) {
  float depth = texture2D(depths, where).r;
  return log2(limits.x * limits.y / (limits.y - depth * (limits.y - limits.x)));
}

void main() {
  vec4 colour = texture2D(colours, at);
  if (texture2D(depths, at).r < 1.0) {
    float here = logDepth(at), behind = 0.0;
    for (int i = -1; i <= 1; ++i)
      for (int k = -1; k <= 1; ++k)
        behind += max(0.0, here - logDepth(at + vec2(float(i), float(k)) * step));
    colour.rgb *= max(0.15, exp(-3.0 * behind));
  }
  gl_FragColor = colour;
}`;

class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true});
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0x14171c);
    this.points = new THREE.Scene();
    this.lines = new THREE.Scene();
    this.clouds = [];
    this.covered = 0;  // pixels at the left
    this.camera = new THREE.PerspectiveCamera(55, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.canShade = this.renderer.extensions.get('WEBGL_depth_texture') !== null;
    this.shaded = this.canShade;
    this.makeShading();
  }

  makeShading() {
    this.target = new THREE.WebGLRenderTarget(1, 1, {minFilter: THREE.NearestFilter,
                                                     magFilter: THREE.NearestFilter});
    if (this.canShade)
      this.target.depthTexture = new THREE.DepthTexture(1, 1, THREE.UnsignedIntType);
    this.shadeUniforms = {colours: {value: this.target.texture},
                          depths: {value: this.target.depthTexture},
                          step: {value: new THREE.Vector2()}, limits: {value: new THREE.Vector2()}};
    const whole = new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), new THREE.RawShaderMaterial({
      vertexShader: wholeVertex, fragmentShader: shadeFragment, uniforms: this.shadeUniforms,
      depthTest: false, depthWrite: false}));
    whole.frustumCulled = false;
    this.shading = new THREE.Scene();
    this.shading.add(whole);
  }

  addCloud(cloud) {
    this.clouds.push(cloud);
    this.points.add(cloud.object);
  }

  addLines(lines) {
    this.lines.add(lines.object);
    return lines;
  }

  fit() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.pixels = new THREE.Vector2(Math.floor(width * ratio), Math.floor(height * ratio));
    this.target.setSize(this.pixels.x, this.pixels.y);
    // What the panel hides is no part of the picture's middle.
    const seen = width - this.covered;
    this.camera.aspect = seen / height;
    this.camera.setViewOffset(seen, height, -this.covered, 0, width, height);
    this.ratio = ratio;
  }

  /** `share`: of the points, while the view moves. */
  draw(share, size_m) {
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const focal = this.pixels.y / 2 / Math.tan(this.camera.fov / 2 * Math.PI / 180);
    for (const cloud of this.clouds) {
      cloud.draw(share);
      cloud.uniforms.focal.value = focal;
      cloud.uniforms.size_m.value = size_m / Math.sqrt(share);
      cloud.uniforms.least.value = 2 * this.ratio;
    }
    const size = this.pixels.clone().divideScalar(this.ratio);
    for (const mesh of this.lines.children) mesh.material.uniforms.picture.value.copy(size);
    const renderer = this.renderer;
    renderer.setRenderTarget(this.shaded ? this.target : null);
    renderer.clear();
    renderer.render(this.points, this.camera);
    if (this.shaded) {
      this.shadeUniforms.step.value.set(this.ratio / this.pixels.x, this.ratio / this.pixels.y);
      this.shadeUniforms.limits.value.set(this.camera.near, this.camera.far);
      renderer.setRenderTarget(null);
      renderer.clear();
      renderer.render(this.shading, this.camera);
    }
    renderer.render(this.lines, this.camera);
  }

  /** Where a place of the map is in the picture, CSS pixels; null behind the eye. */
  seen(place) {
    const at = place.clone().applyMatrix4(this.camera.matrixWorldInverse);
    if (at.z > -this.camera.near) return null;
    at.applyMatrix4(this.camera.projectionMatrix);
    return [(at.x + 1) / 2 * this.canvas.clientWidth, (1 - at.y) / 2 * this.canvas.clientHeight];
  }
}
