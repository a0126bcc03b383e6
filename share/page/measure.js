'use strict';
// The distance between two points of the cloud.

class Measure {
  constructor(picture, changed) {
    this.picture = picture;
    this.changed = changed;
    this.places = [];
    this.on = false;
    this.line = null;
    this.marks = document.getElementById('marks');
    this.result = document.getElementById('result');
  }

  setOn(on) {
    this.on = on;
    this.places = [];
    this.show(on ? 'Measure: click the first point' : '');
  }

  click(x, y) {
    const {camera, canvas} = this.picture;
    const matrix = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix,
                                                        camera.matrixWorldInverse);
    let nearest = null;
    for (const cloud of this.picture.clouds) {
      if (!cloud.object.visible) continue;
      const found = cloud.pointAt(x, y, matrix, canvas.clientWidth, canvas.clientHeight);
      if (found && (!nearest || found.distanceTo(camera.position) <
                                    nearest.distanceTo(camera.position))) nearest = found;
    }
    if (!nearest) return this.show('There is no point');
    if (this.places.length === 2) this.places = [];
    this.places.push(nearest);
    if (this.places.length === 1) return this.show('Measure: click the second point');
    const d = this.places[1].clone().sub(this.places[0]);
    this.show(`${d.length().toFixed(2)} m; level ${Math.hypot(d.x, d.y).toFixed(2)} m, ` +
              `height ${d.z < 0 ? '\u2212' : '+'}${Math.abs(d.z).toFixed(2)} m`);
  }

  show(text) {
    this.result.textContent = text;
    this.result.hidden = text === '';
    if (this.line) this.picture.lines.remove(this.line.object);
    this.line = null;
    if (this.places.length === 2)
      this.line = this.picture.addLines(
          Lines.along(this.places.map(place => place.toArray()), 0xffd24a, 3));
    this.marks.replaceChildren(...this.places.map(() => document.createElement('i')));
    this.changed();
  }

  /** Puts the marks where the points are seen. */
  follow() {
    this.places.forEach((place, i) => {
      const at = this.picture.seen(place), mark = this.marks.children[i];
      mark.hidden = at === null;
      if (at) [mark.style.left, mark.style.top] = [at[0] + 'px', at[1] + 'px'];
    });
  }
}
