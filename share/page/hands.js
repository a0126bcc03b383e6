'use strict';
// Mouse, fingers and keys.

class Hands {
  /** `moved()` after every change of the eye; `tapped(x, y)` for a click that is no drag. */
  constructor(canvas, eye, moved, tapped) {
    Object.assign(this, {canvas, eye, moved, tapped});
    this.pointers = new Map();
    this.keys = new Set();
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, event => this.up(event));
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
    window.addEventListener('keyup', event => {
      if (this.keys.delete(event.code)) this.moved();
    });
    window.addEventListener('blur', () => {
      this.keys.clear();
      this.moved();
    });
  }

  get busy() {
    return this.pointers.size > 0 || this.keys.size > 0;
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus({preventScroll: true});
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.way = this.pointers.size > 1 ? Infinity : 0;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const dx = now[0] - before[0], dy = now[1] - before[1];
    const height = this.canvas.clientHeight;
    this.way += Math.hypot(dx, dy);
    if (this.pointers.size === 1) {
      if (this.way < 4) return;  // a click by an unsteady hand
      const pans = event.shiftKey || (event.buttons & 6) !== 0;
      if (pans) this.eye.pan(dx, dy, height);
      else this.eye.turn(dx, dy);
    } else if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(p => p[1]);
      const apart = place => Math.max(10, Math.hypot(place[0] - other[0], place[1] - other[1]));
      this.eye.zoom(apart(before) / apart(now));
      this.eye.pan(dx / 2, dy / 2, height);
    }
    this.pointers.set(event.pointerId, now);
    this.moved();
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && this.way < 4 && event.button === 0)
      this.tapped(event.clientX, event.clientY);
    this.moved();
  }

  wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 30 : 1);
    this.eye.zoom(Math.exp(clamp(0.0015 * pixels, -0.5, 0.5)));
    this.moved();
  }

  static moves(code) {
    return /^(Key[WASDQE]|Arrow(Up|Down|Left|Right))$/.test(code);
  }

  /** The step of the keys that are held. */
  step(seconds) {
    const held = (...codes) => codes.some(code => this.keys.has(code)) ? 1 : 0;
    const fast = held('ShiftLeft', 'ShiftRight') ? 4 : 1;
    this.eye.go(held('KeyW', 'ArrowUp') - held('KeyS', 'ArrowDown'),
                held('KeyD', 'ArrowRight') - held('KeyA', 'ArrowLeft'),
                held('KeyE') - held('KeyQ'), fast * this.eye.speed_mps() * seconds);
  }
}
