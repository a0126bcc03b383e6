'use strict';
// Lets the map grow while it is made: asks the server of the page for what is new. Needs map.js.

const pause_ms = 500, firstRoom = 4096, weak_m = 6;
let seen = {generation: 0, points: 0, poses: 0}, path = [], vehicle = null, weak = [];
let shownWeak = '', tilesByKey = new Map();

const followed = document.createElement('label');
followed.className = 'check';
followed.innerHTML = '<input id="follow" type="checkbox" checked>follow the vehicle';
document.querySelector('#panel fieldset').append(followed);

/** The tile of a key with room for one more point. */
function tileWithRoom(key, origin) {
  let tile = tilesByKey.get(key);
  const count = tile ? tile.userData.count : 0, room = tile ? tile.userData.room : 0;
  if (count < room) return tile;
  const more = Math.max(firstRoom, 2 * room);
  const places = new Uint16Array(4 * more), known = new Uint8Array(4 * more);
  if (tile) {
    places.set(tile.geometry.getAttribute('position').array);
    known.set(tile.geometry.getAttribute('known').array);
    clouds[0].object.remove(tile);
    tile.geometry.dispose();
  }
  tile = clouds[0].add(origin, places, known, count);
  tile.userData.room = more;
  tilesByKey.set(key, tile);
  return tile;
}

/** x, y, z and height above the ground of each point. */
function addPoints(numbers) {
  const changed = new Set(), limited = value => Math.min(Math.max(Math.round(value), 0), 65535);
  for (let i = 0; i < numbers.length; i += 4) {
    const cell = [0, 1, 2].map(k => Math.floor(numbers[i + k] / tile_m));
    const origin = cell.map(index => index * tile_m);
    const tile = tileWithRoom(cell.join(), origin), last = tile.userData.count++;
    // At a random place, so that the first points of a tile are an even choice of them.
    const at = Math.floor(Math.random() * (last + 1));
    const places = tile.geometry.getAttribute('position').array;
    places.copyWithin(4 * last, 4 * at, 4 * at + 4);
    for (let k = 0; k < 3; ++k)
      places[4 * at + k] = limited((numbers[i + k] - origin[k]) / quantum_m);
    places[4 * at + 3] = limited((numbers[i + 3] - lowestGround_m) / groundQuantum_m);
    changed.add(tile);
  }
  for (const tile of changed) tile.geometry.getAttribute('position').needsUpdate = true;
}

function forgetAll() {
  for (const tile of tilesByKey.values()) tile.geometry.dispose();
  clouds[0].object.remove(...tilesByKey.values());
  tilesByKey.clear();
  path = [];
}

function showPath() {
  if (lines.trajectory) {
    scene.remove(lines.trajectory);
    lines.trajectory.geometry.dispose();
    lines.trajectory.material.dispose();
    delete lines.trajectory;
  }
  if (path.length < 2) return;
  lines.trajectory = pathOf(path, 0xffffff);
  lines.trajectory.visible = byId('trajectory').checked;
  byId('trajectory').parentElement.hidden = false;
  fit();
}

const marker = new THREE.Mesh(new THREE.SphereGeometry(0.5, 12, 8),
                              new THREE.MeshBasicMaterial({color: 0xffd24a, depthTest: false}));
marker.renderOrder = 2;

function moveTo(place) {
  const moved = place.clone().sub(vehicle || controls.target);
  vehicle = place;
  marker.position.copy(place);
  for (const offset of [[-30, -30, -3], [30, 30, 10]])
    box.expandByPoint(place.clone().add(vector(offset)));
  for (const axis of ['x', 'y', 'z'])
    Object.assign(about[axis + '_most'], about[axis] = [box.min[axis], box.max[axis]]);
  limitCuts(false);
  if (byId('follow').checked) {
    camera.position.add(moved);
    controls.target.add(moved);
    controls.update();
  } else if (standard) {
    standard();
  }
}

/** Lines through the vehicle along the axes on which the scan does not show its motion. */
function showWeak(axes, place) {
  const asked = axes.length ? JSON.stringify([axes, place]) : '';
  if (asked === shownWeak) return;
  shownWeak = asked;
  for (const line of weak) {
    scene.remove(line);
    line.geometry.dispose();
    line.material.dispose();
  }
  const end = (axis, way_m) => place.map((at, k) => at + way_m * axis[k]);
  weak = axes.map(axis => pathOf([end(axis, -weak_m), end(axis, weak_m)], 0xff40c8));
}

/** Whether there is more that did not fit into the reply. */
function take(bytes) {
  const end = new Uint8Array(bytes).indexOf(10);
  const news = JSON.parse(new TextDecoder().decode(bytes.slice(0, end)));
  const numbers = new Float32Array(bytes.slice(end + 1)), split = 3 * news.poses;
  if (news.generation !== seen.generation) forgetAll();
  addPoints(numbers.subarray(split));
  for (let i = 0; i < split; i += 3) path.push([...numbers.subarray(i, i + 3)]);
  seen = {generation: news.generation, points: news.first + news.points,
          poses: news.firstPose + news.poses};
  if (news.poses) showPath();
  marker.visible = news.scans > 0;
  if (news.scans > 0) moveTo(vector(news.vehicle));
  showWeak(news.weakAxes, news.vehicle);
  byId('footer').textContent = `${seen.points} points \u00b7 scan ${news.scans}` +
      (news.ended ? ' \u00b7 the drive has ended' : '');
  update();
  document.body.dataset.state = `live ${seen.points} points ${seen.poses} places` +
      (news.ended ? ' ended' : '');
  return seen.points < news.all;
}

async function poll() {
  let next_ms = pause_ms;
  try {
    const reply = await fetch('/live?' + new URLSearchParams(seen), {cache: 'no-store'});
    if (take(await reply.arrayBuffer())) next_ms = 0;
  } catch (fault) {
    byId('footer').textContent = `${seen.points} points \u00b7 no connection: delio-slam has ended`;
    next_ms = 4 * pause_ms;
  }
  setTimeout(poll, next_ms);
}

if (renderer) {
  scene.add(marker);
  readAddress();
  poll();
}
