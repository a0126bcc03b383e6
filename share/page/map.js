'use strict';
// Draws the map. OrbitControls and wide lines are from three.js.

const byId = id => document.getElementById(id);
const vector = numbers => new THREE.Vector3().fromArray(numbers);
const about = JSON.parse(byId('about').textContent);

// As libdelio's page_cloud.h has them.
const quantum_m = 0.001, tile_m = 65, groundQuantum_m = 0.01, lowestGround_m = -10;

function complain(text) {
  byId('fault').textContent = text;
  byId('fault').hidden = false;
  document.body.dataset.state = 'error: ' + text;
}
window.addEventListener('error', event => complain('The map cannot be shown: ' + event.message));

// What points are coloured by, in the order of the shader's modes: the limits, the unit, and
// whether a point stores the value itself or its fraction of the limits.
const values = {
  height: {range: about.z_most, unit: 'm', isFraction: false},
  ground: {range: about.ground_most, unit: 'm above the ground', isFraction: false},
  intensity: {range: about.intensity, unit: 'in sensor units', isFraction: true},
  time: {range: about.time, unit: 's', isFraction: true},
  observations: {range: about.observations, unit: 'scans', isFraction: false},
};

const pointVertex = `
precision highp float;
attribute vec4 position;  // millimetres from the tile's origin; height above the ground
attribute vec4 known;     // intensity, observations, time (low byte, high byte)
uniform mat4 modelViewMatrix, projectionMatrix;
uniform sampler2D ramp;
uniform int mode;
uniform vec3 tile, boxLow, boxHigh;
uniform vec2 range, section;
uniform vec3 plain;
uniform float focal, size_m, least;
varying vec3 colour;

float valueOf(float ground) {
  if (mode == 0) return tile.z + ${quantum_m} * position.z;
  if (mode == 1) return ground;
  if (mode == 2) return known.x / 255.0;
  if (mode == 3) return (known.z + 256.0 * known.w) / 65535.0;
  return known.y;
}

void main() {
  float ground = ${groundQuantum_m} * position.w + float(${lowestGround_m});
  vec3 place = tile + ${quantum_m} * position.xyz;
  if (ground < section.x || ground > section.y || any(lessThan(place, boxLow)) ||
      any(greaterThan(place, boxHigh))) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside the picture
    gl_PointSize = 0.0;
    return;
  }
  gl_Position = projectionMatrix * modelViewMatrix * vec4(${quantum_m} * position.xyz, 1.0);
  gl_PointSize = clamp(size_m * focal / max(gl_Position.w, 0.01), least, 60.0);
  float t = clamp((valueOf(ground) - range.x) / (range.y - range.x), 0.0, 1.0);
  colour = mode < 0 ? plain : texture2D(ramp, vec2((t * 63.0 + 0.5) / 64.0, 0.5)).rgb;
}`;

const pointFragment = `
precision mediump float;
varying vec3 colour;
void main() {
  vec2 fromMiddle = gl_PointCoord - 0.5;
  if (dot(fromMiddle, fromMiddle) > 0.25) discard;
  gl_FragColor = vec4(colour, 1.0);
}`;

/** The bytes of an element, line by line: never a second copy of all of them as text. */
function bytesOf(id, count) {
  const element = byId(id), bytes = new Uint8Array(count);
  let at = 0;
  for (const line of element.textContent.split('\n')) {
    const text = atob(line);
    for (let i = 0; i < text.length; ++i) bytes[at++] = text.charCodeAt(i);
  }
  element.remove();
  if (at !== count) throw new Error('the points are cut off');
  return bytes;
}

/** The bytes r g b of a colour map, 64 of them. */
function rampOf(name) {
  return Uint8Array.from(about.colours[name].match(/../g), pair => parseInt(pair, 16));
}

/** Points, an object a tile. `uniforms` are shared by all tiles but for the tile's own height. */
class Cloud {
  constructor(what, id, mode) {
    const places = new Uint16Array(bytesOf(id + 'places', 8 * what.shown).buffer);
    const known = bytesOf(id + 'known', 4 * what.shown);
    const texture = new THREE.DataTexture(rampOf('turbo'), 64, 1, THREE.RGBFormat);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.unpackAlignment = 1;
    this.uniforms = {
      ramp: {value: texture}, mode: {value: mode}, range: {value: new THREE.Vector2(0, 1)},
      section: {value: new THREE.Vector2(-1e6, 1e6)}, plain: {value: new THREE.Color(0xff3b30)},
      boxLow: {value: new THREE.Vector3()}, boxHigh: {value: new THREE.Vector3()},
      focal: {value: 1}, size_m: {value: 0.1}, least: {value: 2}, tile: {value: new THREE.Vector3()},
    };
    this.material = new THREE.RawShaderMaterial(
        {vertexShader: pointVertex, fragmentShader: pointFragment, uniforms: this.uniforms});
    this.object = new THREE.Group();
    for (const [x, y, z, begin, count] of what.tiles) {
      const part = numbers => numbers.subarray(4 * begin, 4 * (begin + count));
      this.add([x, y, z], part(places), part(known), count);
    }
  }

  /** One more tile: `count` points, for which the arrays may have more room. */
  add(origin, places, known, count) {
    const geometry = new THREE.BufferGeometry(), half = tile_m / 2;
    geometry.setAttribute('position', new THREE.BufferAttribute(places, 4));
    geometry.setAttribute('known', new THREE.BufferAttribute(known, 4));
    geometry.boundingSphere = new THREE.Sphere(vector([half, half, half]), half * Math.sqrt(3));
    const points = new THREE.Points(geometry, this.material);
    points.position.fromArray(origin);
    points.userData.count = count;
    points.onBeforeRender = () => {
      this.uniforms.tile.value.copy(points.position);
      this.material.uniformsNeedUpdate = true;
    };
    this.object.add(points);
    return points;
  }

  /** The first points of a tile are an even choice of them. */
  setFraction(fraction) {
    for (const tile of this.object.children)
      tile.geometry.setDrawRange(0, Math.ceil(fraction * tile.userData.count));
  }

  /** The point nearest to the camera of those within 10 pixels of (x, y), or null. */
  pointAt(x, y) {
    const reach_px = 10, section = this.uniforms.section.value;
    const shown = new THREE.Box3(this.uniforms.boxLow.value, this.uniforms.boxHigh.value);
    const place = new THREE.Vector3();
    const width = canvas.clientWidth, height = canvas.clientHeight;
    const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix,
                                                   camera.matrixWorldInverse).elements;
    let best = null, bestScore = Infinity;
    for (const tile of this.object.children) {
      const [ox, oy, oz] = tile.position.toArray();
      const places = tile.geometry.getAttribute('position').array;
      // Rows of the matrix for the tile's millimetres.
      const [[ax, ay, az, aw], [bx, by, bz, bw], [cx, cy, cz, cw]] = [0, 1, 3].map(k =>
          [m[k] * quantum_m, m[k + 4] * quantum_m, m[k + 8] * quantum_m,
           m[k] * ox + m[k + 4] * oy + m[k + 8] * oz + m[k + 12]]);
      for (let i = 0; i < 4 * tile.userData.count; i += 4) {
        const px = places[i], py = places[i + 1], pz = places[i + 2];
        const w = cx * px + cy * py + cz * pz + cw;
        if (w < 0.05) continue;
        const u = ((ax * px + ay * py + az * pz + aw) / w + 1) / 2 * width - x;
        const v = (1 - (bx * px + by * py + bz * pz + bw) / w) / 2 * height - y;
        const off = (u * u + v * v) / (reach_px * reach_px);
        const ground = groundQuantum_m * places[i + 3] + lowestGround_m;
        if (off > 1 || w * (1 + off) >= bestScore || ground < section.x || ground > section.y)
          continue;
        place.set(ox + quantum_m * px, oy + quantum_m * py, oz + quantum_m * pz);
        if (!shown.containsPoint(place)) continue;
        bestScore = w * (1 + off);
        best = place.clone();
      }
    }
    return best;
  }
}

/** Segments between pairs of places, always before the points. */
function linesOf(pairs, colour, width_px) {
  const origin = pairs[0][0], geometry = new THREE.LineSegmentsGeometry();
  geometry.setPositions(pairs.flat().map(place => place.map((v, k) => v - origin[k])).flat());
  const lines = new THREE.LineSegments2(geometry, new THREE.LineMaterial(
      {color: new THREE.Color(colour), linewidth: width_px, depthTest: false, depthWrite: false}));
  lines.position.fromArray(origin);
  lines.renderOrder = 1;
  lines.frustumCulled = false;
  scene.add(lines);
  return lines;
}

function pathOf(places, colour) {
  return linesOf(places.slice(1).map((place, i) => [places[i], place]), colour, 3);
}

const canvas = byId('view');
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(55, 1, 0.1, 1000);
camera.up.set(0, 0, 1);
const box = new THREE.Box3(...[0, 1].map(k => vector(['x', 'y', 'z'].map(
    axis => about[axis + '_most'][k]))));
for (const place of about.trajectory) box.expandByPoint(vector(place));
let renderer, controls, clouds = [], lines = {}, picked = [], pickedLines = null;
let standard = null, asked = false, moving = false, fraction = 1, drawnAt = 0;

/** The section, a slider for each end; `limits` are what they reach from and to. */
const cuts = [
  {name: 'Height above ground', ends: ['low', 'high'], limits: () => cutLimits('ground')},
  ...['x', 'y', 'z'].map(axis => ({name: axis, ends: [axis + '-min', axis + '-max'],
                                   limits: () => cutLimits(axis)})),
];

/** What most points lie between and as much again, but no more than all of them. */
function cutLimits(name) {
  const [low, high] = about[name + '_most'], more = Math.max((high - low) / 2, 0.5);
  return [Math.floor(10 * Math.max(about[name][0], low - more)) / 10,
          Math.ceil(10 * Math.min(about[name][1], high + more)) / 10];
}

const isAtEnd = (slider, end) => slider.value === (end ? slider.max : slider.min);

/** Gives the sliders their limits; those at an end stay there. */
function limitCuts(reset) {
  for (const {ends, limits} of cuts) {
    const [min, max] = limits(), sliders = ends.map(byId);
    const stays = sliders.map((slider, end) => reset || isAtEnd(slider, end));
    for (const [end, slider] of sliders.entries()) {
      Object.assign(slider, {min, max});
      if (stays[end]) slider.value = end ? max : min;
    }
  }
}

/** Lower and upper end of a cut, metres; at its end a slider hides nothing. */
function cutOf({ends}) {
  return ends.map((id, end) => isAtEnd(byId(id), end) ? (end ? 1e6 : -1e6) : Number(byId(id).value));
}

function makeCuts() {
  for (const {name, ends} of cuts) {
    const row = document.createElement('div');
    row.className = 'cut';
    row.innerHTML = `<span>${name}</span><output></output><div>` + ends.map((id, end) =>
        `<label><span class="unseen">${name}, ${end ? 'maximum' : 'minimum'}, metres</span>` +
        `<input id="${id}" type="range" step="0.1"></label>`).join('') + '</div>';
    byId('cuts').append(row);
    // One end does not pass the other.
    const [low, high] = ends.map(byId);
    low.addEventListener('input', () => { if (+low.value > +high.value) high.value = low.value; });
    high.addEventListener('input', () => { if (+high.value < +low.value) low.value = high.value; });
  }
}

/** The box of the map, or of the section that is shown. */
function shownBox() {
  const [x, y, z] = cuts.slice(1).map(cutOf);
  const shown = box.clone().intersect(new THREE.Box3(...[0, 1].map(end =>
      new THREE.Vector3(x[end], y[end], z[end]))));
  return shown.isEmpty() ? box : shown;
}

/** From so far that every corner of what is shown is in the picture. */
function lookAtAll(forward) {
  const box = shownBox(), centre = box.getCenter(new THREE.Vector3());
  const right = forward.clone().cross(camera.up).normalize(), upward = right.clone().cross(forward);
  const upright = Math.tan(camera.fov / 2 * Math.PI / 180), across = upright * camera.aspect;
  let distance = 1;
  for (let i = 0; i < 8; ++i) {
    const corner = vector(['x', 'y', 'z'].map(
        (axis, k) => box[i >> k & 1 ? 'max' : 'min'][axis])).sub(centre);
    distance = Math.max(distance, 1.05 * (Math.max(Math.abs(right.dot(corner)) / across,
        Math.abs(upward.dot(corner)) / upright) - forward.dot(corner)));
  }
  controls.target.copy(centre);
  camera.position.copy(centre).addScaledVector(forward, -distance);
  controls.update();
  redraw();
}

/** The two standard views; `standard` is the current one, until the view is moved. */
const looks = {
  /** From above and aside, the long side of the map along the picture's. */
  reset() {
    const size = shownBox().getSize(new THREE.Vector3());
    const along = (size.x > size.y) === (camera.aspect > 1) ? [0, 0.8, -0.6] : [0.8, 0, -0.6];
    lookAtAll(vector(along));
    standard = looks.reset;
  },
  /** From above, north up; without a georeference y. */
  top() {
    const [x, y] = about.north || [0, 1];
    lookAtAll(vector([1e-4 * x, 1e-4 * y, -1]).normalize());
    standard = looks.top;
  },
};

function redraw() {
  if (!asked) requestAnimationFrame(draw);
  asked = true;
}

function draw(now = performance.now()) {
  asked = false;
  // While the view moves, as many points as are drawn fluently.
  if (moving && now - drawnAt > 45) fraction = Math.max(0.05, 0.8 * fraction);
  if (moving && now - drawnAt < 24) fraction = Math.min(1, 1.1 * fraction);
  drawnAt = now;
  const shown = moving ? fraction : 1;
  for (const cloud of clouds) {
    cloud.setFraction(shown);
    cloud.uniforms.size_m.value = byId('size').value / 100 / Math.sqrt(shown);
  }
  const radius = box.getSize(new THREE.Vector3()).length() / 2;
  camera.far = camera.position.distanceTo(box.getCenter(new THREE.Vector3())) + 4 * radius + 100;
  camera.near = Math.min(Math.max(camera.position.distanceTo(controls.target) / 100, 0.1),
                         camera.far / 100);
  camera.updateProjectionMatrix();
  renderer.render(scene, camera);
  showScale();
  showNorth();
}

/** A bar of a round length, in metres at the middle of the view. */
function showScale() {
  const longest_px = 140;
  const metresPerPixel = 2 * camera.position.distanceTo(controls.target) *
      Math.tan(camera.fov / 2 * Math.PI / 180) / canvas.clientHeight;
  const most = longest_px * metresPerPixel, power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find(factor => factor * power <= most);
  const text = length >= 1000 ? `${length / 1000} km` : `${Number(length.toPrecision(1))} m`;
  byId('scale-bar').style.width = `${(length / metresPerPixel).toFixed(1)}px`;
  byId('scale-text').textContent = text;
  byId('scale').setAttribute('aria-label', `Scale bar: ${text} at the middle of the view`);
}

/** The arrow to north, as it lies in the picture. */
function showNorth() {
  const [x, y] = about.north || [0, 1], reach = 24;
  const seen = vector([x, y, 0]).transformDirection(camera.matrixWorldInverse);
  const turn = Math.atan2(seen.x, seen.y);
  byId('needle').setAttribute('transform', `rotate(${(turn * 180 / Math.PI).toFixed(1)})`);
  byId('north-letter').setAttribute('x', (reach * Math.sin(turn)).toFixed(1));
  byId('north-letter').setAttribute('y', (-reach * Math.cos(turn)).toFixed(1));
}

/** Keys beyond the arrows, which OrbitControls takes: + and - zoom, Shift and arrows turn. */
function pressKey(event) {
  const step = Math.PI / 36, turns = {ArrowLeft: [-step, 0], ArrowRight: [step, 0],
                                      ArrowUp: [0, -step], ArrowDown: [0, step]};
  const zoom = {'+': 0.9, '=': 0.9, '-': 1 / 0.9}[event.key];
  const turn = event.shiftKey && turns[event.key];
  if (event.ctrlKey || event.metaKey || !zoom && !turn) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  standard = null;
  const offset = camera.position.clone().sub(controls.target);
  const upright = new THREE.Quaternion().setFromUnitVectors(camera.up, new THREE.Vector3(0, 1, 0));
  const at = new THREE.Spherical().setFromVector3(offset.applyQuaternion(upright));
  at.radius *= zoom || 1;
  if (turn) {
    at.theta += turn[0];
    at.phi = Math.min(Math.max(at.phi + turn[1], 1e-4), Math.PI - 1e-4);
  }
  offset.setFromSpherical(at).applyQuaternion(upright.inverse());
  camera.position.copy(controls.target).add(offset);
  controls.update();
  redraw();
}

function fit() {
  const width = window.innerWidth, height = window.innerHeight;
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  renderer.setPixelRatio(ratio);
  renderer.setSize(width, height, false);
  // On a wide screen the panel stands beside the map, on a narrow one over it.
  const covered = width > 640 && !byId('panel').classList.contains('folded') ?
      byId('panel').getBoundingClientRect().right : 0;
  camera.aspect = (width - covered) / height;
  camera.setViewOffset(width - covered, height, -covered, 0, width, height);
  for (const cloud of clouds) {
    cloud.uniforms.focal.value = ratio * height / 2 / Math.tan(camera.fov / 2 * Math.PI / 180);
    cloud.uniforms.least.value = 2 * ratio;
  }
  scene.traverse(object => {
    if (object.material && object.material.resolution) object.material.resolution.set(width, height);
  });
  redraw();
}

function fold(folded) {
  byId('panel').classList.toggle('folded', folded);
  byId('fold').setAttribute('aria-expanded', String(!folded));
  fit();
}

/** Shows the coordinates of a clicked point, and its distance from the previous one. */
function pick(x, y) {
  const found = clouds.filter(cloud => cloud.object.visible).map(cloud => cloud.pointAt(x, y))
      .filter(point => point).sort((a, b) => a.distanceTo(camera.position) -
                                             b.distanceTo(camera.position))[0];
  if (pickedLines) scene.remove(pickedLines);
  pickedLines = null;
  picked = found ? [...picked.slice(-1), found] : [];
  byId('result').hidden = !found;
  if (found) {
    byId('result').textContent = found.toArray().map((v, k) => `xyz`[k] + ' ' + v.toFixed(2))
        .join(', ') + ' m';
    if (picked.length === 2) {
      const d = picked[1].clone().sub(picked[0]);
      byId('result').textContent += `; ${d.length().toFixed(2)} m from the previous point (horizontal ` +
          `${Math.hypot(d.x, d.y).toFixed(2)} m, height ${d.z.toFixed(2)} m)`;
      pickedLines = linesOf([picked.map(point => point.toArray())], 0xffd24a, 3);
      fit();
    }
  }
  redraw();
}

/** Disables settings for data that the map lacks. */
function prepare() {
  Object.keys(values).forEach((name, i) => {
    const option = byId('color').options[i];
    option.disabled = !values[name].range;
    if (option.disabled) option.textContent += ' (not available)';
  });
  for (const name of ['trajectory', 'odometry', 'truth', 'loops'])
    byId(name).parentElement.hidden = !lines[name];
  byId('dynamic').parentElement.hidden = about.dynamic.shown === 0;
  limitCuts(true);
  byId('north-letter').textContent = about.north ? 'N' : 'y';
  byId('north').setAttribute('aria-label', about.north ? 'Arrow to north' :
      'Arrow along the y axis of the map, which is not georeferenced');
  const grouped = count => String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');
  const {shown, total} = about.points;
  const size = ['x', 'y', 'z'].map(axis => Math.round(about[axis][1] - about[axis][0]));
  byId('footer').textContent =
      (shown < total ? `${grouped(shown)} of ${grouped(total)}` : grouped(total)) +
      ` points \u00b7 ${size.join(' \u00d7 ')} m`;
}

/** Applies the controls to the picture. */
function update() {
  const [ground, x, y, z] = cuts.map(cutOf), slack = 0.001;
  for (const [i, cut] of cuts.entries()) {
    const [from, to] = cut.ends.map((id, end) =>
        isAtEnd(byId(id), end) ? null : Number(byId(id).value).toFixed(1));
    byId('cuts').children[i].querySelector('output').textContent =
        from && to ? `${from} to ${to} m` : from ? `from ${from} m` : to ? `to ${to} m` : 'all';
  }
  byId('size-text').textContent = `${byId('size').value} cm`;
  const name = byId('color').value, {range, unit, isFraction} = values[name];
  const ramp = rampOf(byId('colours').value);
  for (const cloud of clouds) {
    cloud.uniforms.section.value.set(ground[0] - slack, ground[1] + slack);
    cloud.uniforms.boxLow.value.set(x[0], y[0], z[0]).addScalar(-slack);
    cloud.uniforms.boxHigh.value.set(x[1], y[1], z[1]).addScalar(slack);
  }
  const uniforms = clouds[0].uniforms, limits = isFraction ? [0, 1] : range;
  uniforms.ramp.value.image.data = ramp;
  uniforms.ramp.value.needsUpdate = true;
  uniforms.mode.value = Object.keys(values).indexOf(name);
  uniforms.range.value.set(limits[0], Math.max(limits[1], limits[0] + 1e-3));
  if (clouds[1]) clouds[1].object.visible = byId('dynamic').checked;
  for (const line in lines) lines[line].visible = byId(line).checked;
  const context = byId('ramp').getContext('2d');
  for (let i = 0; i < 64; ++i) {
    context.fillStyle = `rgb(${ramp.slice(3 * i, 3 * i + 3).join()})`;
    context.fillRect(4 * i, 0, 4, 1);
  }
  const digits = range[1] - range[0] < 20 && !Number.isInteger(range[1]) ? 1 : 0;
  byId('ramp-low').textContent = range[0].toFixed(digits);
  byId('ramp-unit').textContent = unit;
  byId('ramp-high').textContent = range[1].toFixed(digits);
  redraw();
}

/** Sets the controls as the address says: map.html#view=top&color=time&dynamic=1 */
function readAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  for (const [name, text] of wanted) {
    const input = byId(name);
    if (!input || !input.matches('#panel input, #panel select')) continue;
    if (input.type === 'checkbox') input.checked = text === '1';
    else if (input.tagName === 'INPUT' || [...input.options].some(
        option => option.value === text && !option.disabled)) input.value = text;
  }
  if (wanted.has('panel')) fold(wanted.get('panel') === '0');
  if (looks[wanted.get('view')]) looks[wanted.get('view')]();
  update();
}

function start() {
  renderer = new THREE.WebGLRenderer({canvas, antialias: true});
  renderer.setClearColor(0x14171c);
  makeCuts();
  clouds.push(new Cloud(about.points, '', 0));
  if (about.dynamic.shown) clouds.push(new Cloud(about.dynamic, 'dynamic-', -1));
  for (const cloud of clouds) scene.add(cloud.object);
  if (about.truth.length > 1) lines.truth = pathOf(about.truth, 0x4de36a);
  if (about.odometry.length > 1) lines.odometry = pathOf(about.odometry, 0xff9a2e);
  const ends = about.loops.map(loop => loop.map(pose => about.trajectory[pose]));
  if (ends.length) lines.loops = linesOf(ends, 0xff5ad1, 2);
  if (about.trajectory.length > 1) lines.trajectory = pathOf(about.trajectory, 0xffffff);
  canvas.addEventListener('keydown', pressKey);
  controls = new THREE.OrbitControls(camera, canvas);
  controls.addEventListener('change', redraw);
  let still;
  const move = on => { clearTimeout(still); moving = on; redraw(); };
  controls.addEventListener('start', () => {
    standard = null;
    move(true);
  });
  controls.addEventListener('end', () => { still = setTimeout(() => move(false), 250); });
  let downAt = [0, 0];
  canvas.addEventListener('pointerdown', event => { downAt = [event.clientX, event.clientY]; });
  canvas.addEventListener('click', event => {
    if (Math.hypot(event.clientX - downAt[0], event.clientY - downAt[1]) < 4)
      pick(event.clientX, event.clientY);
  });
  canvas.addEventListener('webglcontextlost',
                          () => complain('WebGL was lost; reload the page.'));
  byId('whole').addEventListener('click', () => {
    limitCuts(true);
    update();
  });
  for (const view in looks) byId(view).addEventListener('click', looks[view]);
  for (const input of byId('panel').querySelectorAll('input, select'))
    input.addEventListener('input', update);
  byId('fold').addEventListener('click', () => fold(!byId('panel').classList.contains('folded')));
  window.addEventListener('resize', () => {
    fit();
    if (standard) standard();
  });
  window.addEventListener('hashchange', readAddress);
  prepare();
  fold(window.innerWidth <= 640);
  looks.reset();
  readAddress();
  draw();
  document.body.dataset.state = `ready ${about.points.shown} points`;
}

if (document.createElement('canvas').getContext('webgl'))
  start();
else
  complain('This page needs WebGL, which is missing or switched off. The same map is in map.ply.');
