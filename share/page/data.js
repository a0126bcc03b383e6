'use strict';
// What the page was written with: numbers as JSON, points as lines of base64.

const about = JSON.parse(document.getElementById('about').textContent);

/** The bytes of an element, line by line: never a second copy of all of them as text. */
function bytesOf(id, count) {
  const element = document.getElementById(id);
  const bytes = new Uint8Array(count);
  let at = 0;
  for (const line of element.textContent.split('\n')) {
    const text = atob(line);
    for (let i = 0; i < text.length; ++i) bytes[at++] = text.charCodeAt(i);
  }
  element.remove();
  if (at !== count) throw new Error('the points are cut off');
  return bytes;
}

// As libdelio's page_cloud.h has them.
const quantum_m = 0.001;
const tile_m = 65;
const groundQuantum_m = 0.01;
const lowestGround_m = -10;

/** "1 234 567" */
function grouped(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}
