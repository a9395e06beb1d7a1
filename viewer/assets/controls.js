// The controls under the stage and the keys.
const $ = (id) => document.getElementById(id);
const LEFT_AND_RIGHT = ['wrist', 'elbow', 'ankle', 'foot'];
const WRISTS = [20, 21];

class Controls {
  constructor(player, view, motions, jointNames) {
    Object.assign(this, {player, view, motions});
    this.chosen = null;  // joints of all trails; null: each motion's own
    $('scrub').max = player.lastFrame;
    motions.forEach((motion, i) => {
      $('captions').children[i].style.setProperty('--tint', COLOURS[i % COLOURS.length]);
      if (motions.length > 1) $('follow').add(new Option('Follow ' + motion.title, i));
    });
    if (motions.length === 1) $('follow').options[1].text = 'Follow the dancer';
    $('layout').hidden = motions.length < 2;
    this.listJoints(jointNames);
    this.listen();
    this.listenKeys();
  }

  // The joints that dancers draw with, and those that a motion asks for.
  listJoints(names) {
    const own = new Set(this.motions.flatMap((m) => this.joints(m)));
    const pairs = LEFT_AND_RIGHT.flatMap((name) => ['left_' + name, 'right_' + name]);
    const usual = ['head', 'pelvis', ...pairs].map((name) => names.indexOf(name));
    for (const joint of new Set([...usual, ...own])) {
      const label = document.createElement('label'), box = document.createElement('input');
      Object.assign(box, {type: 'checkbox', value: joint, checked: own.has(joint)});
      box.onchange = () => this.chooseJoints();
      label.append(box, ' ' + names[joint].replace('_', ' '));
      label.className = 'check';
      $('joints').append(label);
    }
  }

  joints(motion) {
    return this.chosen || (motion.trails.length ? motion.trails : WRISTS);
  }

  chooseJoints() {
    this.chosen = [...$('joints').querySelectorAll(':checked')].map((box) => Number(box.value));
    $('trails').checked = true;
    this.drawTrails();
  }

  drawTrails() {
    const wanted = $('length').value, on = $('trails').checked;
    if (this.view)
      this.view.setTrails((m) => this.joints(m), on ? Number(wanted) || wanted : 0);
  }

  listen() {
    const {player, view} = this;
    $('play').onclick = () => player.play(!player.playing);
    $('back').onclick = () => player.step(-1);
    $('forward').onclick = () => player.step(1);
    $('scrub').oninput = () => {
      player.play(false);
      player.seek($('scrub').value / player.rate);
    };
    $('speed').onchange = () => player.speed = Number($('speed').value);
    $('loop').onchange = () => player.loop = $('loop').checked;
    $('trails').onchange = () => this.drawTrails();
    $('length').onchange = () => {
      $('trails').checked = true;
      this.drawTrails();
    };
    $('layout').onchange = () => view && view.arrange($('layout').value === 'over');
    $('follow').onchange = () => view && view.follow($('follow').value);
    $('reset').onclick = () => view && view.resetView();
    $('keys').onclick = () => $('help').showModal();
    $('full').hidden = !document.fullscreenEnabled;
    $('full').onclick = () =>
        document.fullscreenElement ? document.exitFullscreen() : $('player').requestFullscreen();
    // A click beside the trails' panel closes it, as Escape does.
    const panel = $('trailpanel');
    document.addEventListener('pointerdown', (e) => panel.contains(e.target) || close());
    const close = () => panel.open = false;
    panel.addEventListener('keydown', (e) => {
      if (e.key !== 'Escape' || !panel.open) return;
      close();
      panel.firstElementChild.focus();
    });
  }

  showTime(seconds) {
    const {player} = this, of = player.duration.toFixed(2), now = seconds.toFixed(2);
    const frame = Math.round(seconds * player.rate);
    $('scrub').value = frame;
    $('scrub').setAttribute('aria-valuetext', `${now} of ${of} seconds, frame ${frame}`);
    $('clock').textContent = `${now} of ${of} s`;
    $('frame').textContent = `frame ${frame} of ${player.lastFrame}`;
  }

  showPlaying(on) {
    $('player').classList.toggle('playing', on);
    $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
  }

  // The next choice of a <select>, or the one before.
  turn(id, by, around) {
    const select = $(id), count = select.options.length, next = select.selectedIndex + by;
    if (select.hidden || (!around && !select.options[next])) return;
    select.selectedIndex = (next + count) % count;
    select.onchange();
  }

  toggle(id) {
    $(id).checked = !$(id).checked;
    $(id).onchange();
  }

  listenKeys() {
    const {player, view} = this, second = Math.round(player.rate);
    const look = (turn, tilt) => () => view && view.resetView(turn, tilt);
    this.keys = {
      ' ': () => player.play(!player.playing),
      'ArrowLeft': (e) => player.step(e.shiftKey ? -second : -1),
      'ArrowRight': (e) => player.step(e.shiftKey ? second : 1),
      'Home': () => player.step(-player.lastFrame),
      'End': () => player.step(player.lastFrame),
      '<': () => this.turn('speed', -1),
      '>': () => this.turn('speed', 1),
      'l': () => this.toggle('loop'),
      't': () => this.toggle('trails'),
      'o': () => this.turn('layout', 1, true),
      'c': () => this.turn('follow', 1, true),
      'f': () => $('full').click(),
      '+': () => view && view.orbit.zoom(.85),
      '-': () => view && view.orbit.zoom(1 / .85),
      '[': () => view && view.orbit.rotate(-.2, 0),
      ']': () => view && view.orbit.rotate(.2, 0),
      '0': look(),
      '1': look(0, .08),
      '2': look(Math.PI / 2, .08),
      '3': look(0, 1.5),
      '?': () => $('keys').click(),
    };
    document.addEventListener('keydown', (event) => this.onKey(event));
  }

  // Controls keep the keys that they use themselves.
  onKey(event) {
    const {target, key} = event;
    const own = {BUTTON: ' ', SELECT: ' ArrowLeftArrowRightHomeEnd', SUMMARY: ' '}[target.tagName];
    const box = target.type === 'checkbox' ? ' ' : '';
    if (event.ctrlKey || event.altKey || event.metaKey || $('help').open) return;
    if (((own || '') + box).includes(key) || !this.keys[key]) return;
    // Letters choose in an open or focused list.
    if (target.tagName === 'SELECT' && /[a-z0-9]/.test(key)) return;
    event.preventDefault();
    this.keys[key](event);
  }
}
