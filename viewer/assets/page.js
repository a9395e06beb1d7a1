// The clock, the controls and the keys.
const $ = (id) => document.getElementById(id);
const motions = JSON.parse($('data').textContent).motions.map((data) => new Motion(data));
const duration = Math.max(...motions.map((m) => m.seconds));
const rate = Math.max(...motions.map((m) => m.fps));  // of the scrub bar and the frame steps
const lastFrame = Math.round(duration * rate);

let stage = null;
let seconds = 0, playing = false, before = 0;

function showTime() {
  const frame = Math.round(seconds * rate);
  $('scrub').value = frame;
  $('scrub').setAttribute(
      'aria-valuetext', `${seconds.toFixed(2)} of ${duration.toFixed(2)} seconds`);
  $('clock').textContent =
      `${seconds.toFixed(2)} of ${duration.toFixed(2)} s, frame ${frame} of ${lastFrame}`;
}

function seek(to) {
  seconds = Math.min(Math.max(Number(to) || 0, 0), duration);
  showTime();
  if (stage) stage.show(seconds);
}

function step(frames) {
  play(false);
  seek((Math.round(seconds * rate) + frames) / rate);
}

function play(on) {
  on = Boolean(on) && duration > 0;
  if (on && seconds >= duration) seconds = 0;
  if (on && !playing) {
    before = performance.now();
    requestAnimationFrame(tick);
  }
  playing = on;
  $('play').parentElement.classList.toggle('playing', on);
  $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
}

function tick(now) {
  if (!playing) return;
  // After a hidden tab or a long frame the clock goes on from where it was.
  const passed = Math.min(Math.max(now - before, 0) / 1000, .1) * Number($('speed').value);
  before = now;
  let next = seconds + passed;
  // The last frame is held for a moment before it starts again.
  if (next > duration + .4 || (next > duration && !$('loop').checked)) {
    if (!$('loop').checked) play(false);
    next = $('loop').checked ? 0 : duration;
  }
  const shown = performance.now();
  seconds = next;
  showTime();
  if (stage) stage.show(Math.min(seconds, duration));
  lighten(performance.now() - shown);
  if (playing) requestAnimationFrame(tick);
}

// Where drawing is slow (no graphics card) the picture gets coarser instead of stuttering.
let slow = 0;
function lighten(milliseconds) {
  slow = milliseconds > 45 ? slow + 1 : Math.max(slow - 1, 0);
  if (slow < 12 || !stage || stage.pixels <= .6) return;
  slow = 0;
  stage.pixels *= .8;
  stage.resize();
}

function openStage() {
  try {
    stage = new Stage($('canvas'), $('names'), motions);
  } catch (error) {
    console.error(error);
    $('canvas').hidden = true;
    $('message').hidden = false;
    $('message').textContent =
        'This browser shows no 3-D pictures: WebGL is missing or switched off. ' +
        'Another browser, or its graphics settings, may help. The descriptions and tables below are complete.';
    return;
  }
  new ResizeObserver(() => {
    stage.resize();
    stage.draw();
  }).observe($('canvas'));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    stage.paint();
    stage.draw();
  });
  $('canvas').addEventListener('webglcontextrestored', () => seek(seconds));
}

function fillIn() {
  $('scrub').max = lastFrame;
  motions.forEach((motion, i) => {
    $('captions').children[i].style.setProperty('--tint', COLOURS[i % COLOURS.length]);
    if (motions.length > 1) $('follow').add(new Option('Follow ' + motion.title, i));
  });
  if (motions.length === 1) $('follow').options[1].text = 'Follow the dancer';
}

function listen() {
  $('play').onclick = () => play(!playing);
  $('back').onclick = () => step(-1);
  $('forward').onclick = () => step(1);
  $('scrub').oninput = () => {
    play(false);
    seek($('scrub').value / rate);
  };
  $('trails').onchange = () => {
    if (stage) stage.showTrails($('trails').checked);
    seek(seconds);
  };
  $('follow').onchange = () => stage && stage.follow($('follow').value);
  $('reset').onclick = () => stage && stage.resetView();
  document.addEventListener('keydown', onKey);
}

const KEYS = {
  ' ': () => play(!playing),
  'ArrowLeft': (e) => step(e.shiftKey ? -Math.round(rate) : -1),
  'ArrowRight': (e) => step(e.shiftKey ? Math.round(rate) : 1),
  'Home': () => step(-lastFrame),
  'End': () => step(lastFrame),
  '+': () => stage && stage.orbit.zoom(.85),
  '-': () => stage && stage.orbit.zoom(1 / .85),
  '[': () => stage && stage.orbit.rotate(-.2, 0),
  ']': () => stage && stage.orbit.rotate(.2, 0),
  '0': () => stage && stage.resetView(),
};

// Controls keep the keys that they use themselves.
function onKey(event) {
  const own = {
    BUTTON: ' ',
    SELECT: ' ArrowLeftArrowRightHomeEnd',
    SUMMARY: ' '
  }[event.target.tagName] ||
      '';
  const box = event.target.type === 'checkbox' ? ' ' : '';
  if (event.ctrlKey || event.altKey || event.metaKey || (own + box).includes(event.key)) return;
  if (!KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key](event);
}

fillIn();
listen();
openStage();
// #t=2.5 opens the page at that second, paused.
const asked = /^#t=([0-9.]+)$/.exec(location.hash);
const wide = Math.max(...motions.map((m) => Math.max(m.high[0] - m.low[0], m.high[2] - m.low[2])));
if (motions.length === 1 && wide > 4.5 && stage) {
  $('follow').value = 'all';
  stage.follow('all');
}
if (motions.some((m) => m.trails.length)) {
  $('trails').checked = true;
  if (stage) stage.showTrails(true);
}
seek(asked ? asked[1] : 0);
play(stage && !asked && !matchMedia('(prefers-reduced-motion: reduce)').matches);

// For tests and tinkering: positions(i) is (24, 3) metres as shown, before the side-by-side places.
window.mocaplm = {
  seek(to) {
    play(false);
    seek(to);
  },
  positions(index) {
    const now = motions[index].sample(seconds, new Float32Array(3 * POINTS));
    return Array.from({length: 24}, (_, j) => Array.from(now.subarray(3 * j, 3 * j + 3)));
  },
};
