'use strict';
// Where the eye is: `distance` before `target`, towards which it looks; on foot it is at `target`.

class Eye {
  /** `box`: low and high corner of what is worth seeing. `path`: places of the trajectory. */
  constructor(camera, box, path) {
    this.camera = camera;
    this.box = box;
    this.path = path.map(place => new THREE.Vector3().fromArray(place));
    this.radius = Math.max(1, box.getSize(new THREE.Vector3()).length() / 2);
    this.target = new THREE.Vector3();
    this.onFoot = false;
    this.reset();
  }

  forward() {
    const level = Math.cos(this.pitch);
    return new THREE.Vector3(level * Math.cos(this.yaw), level * Math.sin(this.yaw),
                             Math.sin(this.pitch));
  }

  upward() {
    const level = -Math.sin(this.pitch);
    return new THREE.Vector3(level * Math.cos(this.yaw), level * Math.sin(this.yaw),
                             Math.cos(this.pitch));
  }

  /** The whole map from above and aside, its long side along the picture's. */
  reset() {
    const size = this.box.getSize(new THREE.Vector3());
    this.onFoot = false;
    this.yaw = (size.x > size.y) === (this.camera.aspect > 1) ? Math.PI / 2 : 0;
    this.pitch = -0.65;
    this.lookAtAll();
  }

  top() {
    this.onFoot = false;
    this.yaw = Math.PI / 2;
    this.pitch = -Math.PI / 2;
    this.lookAtAll();
  }

  /** From so far that every corner of the box is in the picture. */
  lookAtAll() {
    this.box.getCenter(this.target);
    const forward = this.forward(), upward = this.upward(), right = forward.clone().cross(upward);
    const upright = Math.tan(this.camera.fov / 2 * Math.PI / 180);
    const across = upright * this.camera.aspect;
    this.distance = 1;
    for (let i = 0; i < 8; ++i) {
      const corner = new THREE.Vector3(...['x', 'y', 'z'].map(
          (axis, k) => this.box[i >> k & 1 ? 'max' : 'min'][axis])).sub(this.target);
      const needed = Math.max(Math.abs(right.dot(corner)) / across,
                              Math.abs(upward.dot(corner)) / upright) - forward.dot(corner);
      this.distance = Math.max(this.distance, 1.05 * needed);
    }
  }

  /** Onto the trajectory, where it is nearest to what is looked at. */
  walk() {
    if (!this.path.length) return;
    const [index, place] = this.nearestOnPath(this.target);
    const next = this.path.slice(index).find(other => other.distanceTo(place) > 1);
    const last = this.path.slice(0, index).reverse().find(other => other.distanceTo(place) > 1);
    const ahead = next ? next.clone().sub(place) : last ? place.clone().sub(last) : null;
    if (ahead) this.yaw = Math.atan2(ahead.y, ahead.x);
    this.pitch = 0;
    this.distance = 0;
    this.target.copy(place);
    this.target.z += eyeHeight_m;
    this.onFoot = true;
  }

  stand() {
    if (!this.onFoot) return;
    this.onFoot = false;
    this.distance = 20;
    this.target.addScaledVector(this.forward(), this.distance);
  }

  nearestOnPath(from) {
    let best = 0, least = Infinity;
    this.path.forEach((place, i) => {
      const off = Math.hypot(place.x - from.x, place.y - from.y);
      if (off < least) [best, least] = [i, off];
    });
    return [best, this.path[best], least];
  }

  /** By a drag of so many pixels: the map follows the hand; on foot, what is seen does. */
  turn(dx, dy) {
    const sense = this.onFoot ? 1 : -1, perPixel = 0.005;
    this.yaw += sense * perPixel * dx;
    this.pitch = clamp(this.pitch + sense * perPixel * dy, -Math.PI / 2, Math.PI / 2);
  }

  pan(dx, dy, height) {
    const half = Math.tan(this.camera.fov / 2 * Math.PI / 180);
    const perPixel = 2 * half * (this.distance || 10) / height;
    const right = this.forward().cross(this.upward());
    this.target.addScaledVector(right, -dx * perPixel);
    this.target.addScaledVector(this.upward(), dy * perPixel);
  }

  /** Below one metre the target goes ahead: no place is out of reach. */
  zoom(factor) {
    const wanted = (this.distance || 5) * factor;
    if (this.onFoot || wanted < 1)
      this.target.addScaledVector(this.forward(), (this.distance || 5) - wanted);
    else
      this.distance = Math.min(wanted, 20 * this.radius);
  }

  /** Shares of a step of so many metres. */
  go(ahead, right, up, step_m) {
    const cos = Math.cos(this.yaw), sin = Math.sin(this.yaw);
    this.target.x += step_m * (ahead * cos + right * sin);
    this.target.y += step_m * (ahead * sin - right * cos);
    this.target.z += step_m * up;
    if (!this.onFoot || up || !this.path.length) return;
    // Along the trajectory the ground is known.
    const [, place, off] = this.nearestOnPath(this.target);
    if (off < 10) this.target.z += 0.2 * (place.z + eyeHeight_m - this.target.z);
  }

  speed_mps() {
    return this.onFoot ? 6 : Math.max(2, this.distance / 1.5);
  }

  apply() {
    const camera = this.camera, forward = this.forward();
    camera.position.copy(this.target).addScaledVector(forward, -this.distance);
    camera.up.copy(this.upward());
    camera.lookAt(camera.position.clone().add(forward));
    const middle = this.box.getCenter(new THREE.Vector3());
    camera.far = camera.position.distanceTo(middle) + 4 * this.radius + 100;
    camera.near = clamp(this.distance / 100, 0.1, camera.far / 100);
  }
}

const eyeHeight_m = 1.7;
