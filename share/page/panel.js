'use strict';
// The controls. Each has the name that it has in the page's address: map.html#color=time&dynamic=1

const byId = id => document.getElementById(id);

// What points are coloured by, in the order of the shader's modes: limits, unit, and whether the
// points have the value itself or its share of the limits.
const values = {
  height: {range: about.z_most, unit: 'm', share: false},
  ground: {range: about.ground_most, unit: 'm above the ground', share: false},
  intensity: {range: about.intensity, unit: 'as the sensor gives it', share: true},
  time: {range: about.time, unit: 's', share: true},
  observations: {range: about.observations, unit: 'scans', share: false},
};
const lineNames = ['trajectory', 'odometry', 'truth', 'loops'];

class Panel {
  constructor(picture, lines, changed) {
    Object.assign(this, {picture, lines, changed});
    this.prepare();
    for (const input of byId('panel').querySelectorAll('input, select'))
      input.addEventListener('input', () => this.update(input.id));
    byId('fold').addEventListener('click', () => this.fold(!this.folded));
    byId('help').addEventListener('click', () => this.help());
    this.fold(window.innerWidth <= 640);
  }

  /** What the map does not have is not offered. */
  prepare() {
    Object.keys(values).forEach((name, i) => {
      const option = byId('color').options[i];
      option.disabled = !values[name].range;
      if (option.disabled) option.textContent += ' (not known)';
    });
    for (const name of lineNames) byId(name).parentElement.hidden = !this.lines[name];
    byId('dynamic').parentElement.hidden = about.dynamic.shown === 0;
    byId('shading').parentElement.hidden = !this.picture.canShade;
    byId('walk').disabled = about.trajectory.length === 0;
    // Tenths of a metre.
    const low = Math.floor(10 * about.ground[0]), high = Math.ceil(10 * about.ground[1]);
    for (const id of ['low', 'high']) Object.assign(byId(id), {min: low, max: high});
    byId('low').value = low;
    byId('high').value = high;
    const {shown, total} = about.points;
    const size = ['x', 'y', 'z'].map(axis => Math.round(about[axis][1] - about[axis][0]));
    byId('footer').textContent =
        (shown < total ? `${grouped(shown)} of ${grouped(total)}` : grouped(total)) +
        ` points \u00b7 ${size.join(' \u00d7 ')} m`;
  }

  get folded() {
    return byId('panel').classList.contains('folded');
  }

  fold(folded) {
    byId('panel').classList.toggle('folded', folded);
    byId('fold').setAttribute('aria-expanded', String(!folded));
    this.cover();
  }

  /** On a wide screen the panel stands beside the map, on a narrow one over it. */
  cover() {
    const beside = window.innerWidth > 640 && !this.folded;
    this.picture.covered = beside ? byId('panel').getBoundingClientRect().right : 0;
    this.picture.fit();
    this.changed();
  }

  help() {
    const hidden = !byId('keys').hidden;
    byId('keys').hidden = hidden;
    byId('help').setAttribute('aria-expanded', String(!hidden));
    if (!hidden) this.fold(false);
  }

  /** Sets controls as an address says; other names are left to the caller. */
  read(wanted) {
    for (const [name, text] of wanted) {
      const input = byId(name);
      if (!input || !input.matches('#panel input, #panel select')) continue;
      if (input.type === 'checkbox') input.checked = text === '1';
      else if (name === 'low' || name === 'high') input.value = Math.round(10 * Number(text));
      else if (input.tagName === 'INPUT' || [...input.options].some(
          option => option.value === text && !option.disabled)) input.value = text;
    }
    if (wanted.has('panel')) this.fold(wanted.get('panel') === '0');
    this.update('');
  }

  /** Brings the picture to what the controls say; `which` has just been changed. */
  update(which) {
    const low = byId('low'), high = byId('high');
    if (Number(low.value) > Number(high.value)) {
      if (which === 'low') high.value = low.value;
      else low.value = high.value;
    }
    // At its end a slider leaves out nothing.
    const lowest = low.value === low.min ? -1e6 : low.value / 10;
    const highest = high.value === high.max ? 1e6 : high.value / 10;
    byId('low-text').textContent = lowest === -1e6 ? 'all' : `${(low.value / 10).toFixed(1)} m`;
    byId('high-text').textContent = highest === 1e6 ? 'all' : `${(high.value / 10).toFixed(1)} m`;
    byId('size-text').textContent = `${byId('size').value} cm`;
    for (const cloud of this.picture.clouds) {
      cloud.uniforms.section.value.set(lowest - 0.001, highest + 0.001);
      if (which === '' || which === 'colours') cloud.setRamp(byId('colours').value);
    }
    const [points, dynamic] = this.picture.clouds;
    const name = byId('color').value, {range, share} = values[name];
    points.uniforms.mode.value = Object.keys(values).indexOf(name);
    const [from, to] = share ? [0, 1] : range;
    points.uniforms.range.value.set(from, Math.max(to, from + 1e-3));
    if (dynamic) dynamic.object.visible = byId('dynamic').checked;
    for (const line of lineNames)
      if (this.lines[line]) this.lines[line].object.visible = byId(line).checked;
    this.picture.shaded = this.picture.canShade && byId('shading').checked;
    this.drawLegend();
    this.changed();
  }

  get pointSize_m() {
    return byId('size').value / 100;
  }

  drawLegend() {
    const {range, unit} = values[byId('color').value];
    const ramp = rampOf(byId('colours').value), context = byId('ramp').getContext('2d');
    for (let i = 0; i < 64; ++i) {
      context.fillStyle = `rgb(${ramp[3 * i]}, ${ramp[3 * i + 1]}, ${ramp[3 * i + 2]})`;
      context.fillRect(4 * i, 0, 4, 1);
    }
    const digits = range[1] - range[0] < 20 ? (Number.isInteger(range[1]) ? 0 : 1) : 0;
    const [low, high] = range.map(value => value.toFixed(digits));
    byId('ramp-low').textContent = low;
    byId('ramp-unit').textContent = unit;
    byId('ramp-high').textContent = high;
    byId('legend').setAttribute('aria-label', `Colours from ${low} to ${high}, ${unit}`);
  }
}
