'use strict';
// Puts it together. A picture is drawn when something has changed, not otherwise.

function complain(text) {
  byId('fault').textContent = text;
  byId('fault').hidden = false;
  document.body.dataset.state = 'error: ' + text;
}
window.addEventListener('error', event => complain('The map cannot be shown: ' + event.message));

/** What is worth seeing: the map without its outliers, and the whole way. */
function boxOfMap() {
  const corner = k => new THREE.Vector3(about.x_most[k], about.y_most[k], about.z_most[k]);
  const box = new THREE.Box3(corner(0), corner(1));
  for (const place of about.trajectory) box.expandByPoint(new THREE.Vector3().fromArray(place));
  return box;
}

function linesOfMap(picture) {
  const lines = {};
  const add = (name, made) => lines[name] = picture.addLines(made);
  if (about.truth.length > 1) add('truth', Lines.along(about.truth, 0x4de36a, 3));
  if (about.odometry.length > 1) add('odometry', Lines.along(about.odometry, 0xff9a2e, 3));
  const ends = about.loops.map(loop => loop.map(pose => about.trajectory[pose]));
  if (ends.length) add('loops', new Lines(ends, 0xff5ad1, 2));
  if (about.trajectory.length > 1) add('trajectory', Lines.along(about.trajectory, 0xffffff, 3));
  return lines;
}

class Page {
  constructor() {
    this.picture = new Picture(byId('view'));
    this.picture.addCloud(new Cloud(about.points, 'places', 'known', 0));
    if (about.dynamic.shown)
      this.picture.addCloud(new Cloud(about.dynamic, 'dynamic-places', 'dynamic-known', -1));
    this.picture.fit();
    this.view = 'reset';
    this.eye = new Eye(this.picture.camera, boxOfMap(), about.trajectory);
    this.share = 1;
    this.measure = new Measure(this.picture, () => this.redraw());
    this.panel = new Panel(this.picture, linesOfMap(this.picture), () => this.redraw());
    this.hands = new Hands(this.picture.canvas, this.eye, () => this.redraw(true),
                           (x, y) => { if (this.measure.on) this.measure.click(x, y); });
    this.listen();
    this.look('reset');
    this.readAddress();
    this.draw();
    document.body.dataset.state = `ready ${about.points.shown} points`;
  }

  listen() {
    for (const view of ['reset', 'top', 'walk'])
      byId(view).addEventListener('click', () => this.look(view));
    byId('measure').addEventListener('click', () => this.setMeasuring(!this.measure.on));
    window.addEventListener('resize', () => {
      this.panel.cover();
      if (!this.movedAt && !this.eye.onFoot) this.eye[this.view]();  // all of it, still
    });
    window.addEventListener('hashchange', () => this.readAddress());
    window.addEventListener('keydown', event => this.key(event));
    // Who goes from control to control by Tab has to see that the map is one of them; for others a
    // frame around it would mean nothing.
    const frame = on => this.picture.canvas.classList.toggle('tabbed', on);
    window.addEventListener('keydown', event => frame(event.key === 'Tab'), true);
    window.addEventListener('pointerdown', () => frame(false), true);
    this.picture.canvas.addEventListener('webglcontextlost',
                                         () => complain('The graphics are gone; load it again.'));
  }

  look(view) {
    if (view === 'walk' && this.eye.onFoot) this.eye.stand();
    else this.eye[view]();
    this.view = view;
    byId('walk').setAttribute('aria-pressed', String(this.eye.onFoot));
    this.redraw();
  }

  setMeasuring(on) {
    this.measure.setOn(on);
    byId('measure').setAttribute('aria-pressed', String(on));
    this.picture.canvas.classList.toggle('measuring', on);
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    // Sliders and lists have the arrows for themselves, lists the letters too.
    const {tagName} = event.target;
    if (tagName === 'SELECT' || (tagName === 'INPUT' && event.code.startsWith('Arrow'))) return;
    const actions = {KeyT: () => this.look('top'), KeyR: () => this.look('reset'),
                     KeyG: () => this.look('walk'), KeyH: () => this.panel.help(),
                     KeyM: () => this.setMeasuring(!this.measure.on),
                     Escape: () => this.setMeasuring(false)};
    if (Hands.moves(event.code) || event.key === 'Shift') {
      this.hands.keys.add(event.code);
      if (event.key !== 'Shift') event.preventDefault();
    } else if (event.key === '+' || event.key === '-') {
      this.eye.zoom(event.key === '+' ? 0.8 : 1.25);
    } else if (actions[event.code] && !event.repeat) {
      actions[event.code]();
    } else {
      return;
    }
    this.redraw(true);
  }

  /** map.html#view=top&color=time&dynamic=1&measure=x,y,z,x,y,z */
  readAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    this.panel.read(wanted);
    if (['reset', 'top', 'walk'].includes(wanted.get('view'))) this.look(wanted.get('view'));
    if (!wanted.has('measure')) return;
    this.draw();
    this.setMeasuring(true);
    // A click on each of the places, wherever in the picture that is.
    const numbers = wanted.get('measure').split(',').map(Number);
    for (let i = 0; i + 2 < numbers.length; i += 3) {
      const at = this.picture.seen(new THREE.Vector3().fromArray(numbers, i));
      if (at) this.measure.click(...at);
    }
  }

  redraw(moving = false) {
    if (moving) this.movedAt = performance.now();
    if (this.asked) return;
    this.asked = true;
    this.askedAt = performance.now();
    requestAnimationFrame(now => this.frame(now));
  }

  frame(now) {
    this.asked = false;
    const seconds = Math.min((now - (this.drawnAt || now)) / 1000, 0.1);
    const moving = this.hands.busy || performance.now() - (this.movedAt || -1e9) < 200;
    const going = [...this.hands.keys].some(Hands.moves);
    if (going) this.hands.step(this.going ? seconds : 0.016);
    this.going = going;
    // While it moves, as many points as are drawn fluently: what counts is the time from picture to
    // picture where one follows the other.
    if (moving && this.askedAt - this.drawnAt < 100) {
      if (seconds > 0.045) this.share = Math.max(0.05, 0.8 * this.share);
      if (seconds < 0.024) this.share = Math.min(1, 1.1 * this.share);
    }
    this.drawnAt = now;
    this.draw(moving ? this.share : 1);
    clearTimeout(this.rest);
    if (going) this.redraw();
    else if (moving && this.share < 1) this.rest = setTimeout(() => this.redraw(), 250);
  }

  draw(share = 1) {
    this.eye.apply();
    this.picture.draw(share, this.panel.pointSize_m);
    this.measure.follow();
  }
}

const canDraw = document.createElement('canvas').getContext('webgl') !== null;
const page = canDraw ? new Page() : null;
if (!canDraw)
  complain('This browser cannot draw in three dimensions here (WebGL is missing or switched ' +
           'off). The same map is in map.ply.');
