// Start: motions, the stage or what stands in for it, the clock, the controls.
const data = JSON.parse($('data').textContent);
const motions = data.motions.map((motion) => new Motion(motion));
// #t=2.5 opens the page at that second, paused; #flat draws without WebGL.
const asked = new URLSearchParams(location.hash.slice(1));

function say(text) {
  $('message').hidden = false;
  $('message').textContent = text;
}

function openView() {
  const canvas = $('canvas');
  if (!asked.has('flat')) {
    try {
      // Asked for on a canvas of its own: three.js would write an error to the console.
      const tried = document.createElement('canvas');
      const gl = tried.getContext('webgl') || tried.getContext('experimental-webgl');
      if (gl) return new Stage(canvas, $('names'), motions);
    } catch (error) {
      console.error(error);
      return null;
    }
    say('Drawn flat: WebGL is missing or off.');
  }
  return new FlatView(canvas, $('names'), motions);
}

const view = openView();
if (!view) {
  $('canvas').hidden = true;
  say('The figures cannot be drawn in this browser. Another browser, or its graphics settings, ' +
      'may help. The descriptions and tables below are complete.');
}

let slow = 0;
const player = new Player(
    motions,
    (seconds) => {
      controls.showTime(seconds);
      if (!view) return;
      const start = performance.now();
      view.show(seconds);
      slow = player.playing && performance.now() - start > 45 ? slow + 1 : Math.max(slow - 1, 0);
      if (slow < 12) return;
      slow = 0;
      view.lighten();
    },
    (on) => controls.showPlaying(on));
const controls = new Controls(player, view, motions, data.joints);

if (view) {
  new ResizeObserver(() => {
    view.resize();
    view.draw();
  }).observe($('canvas'));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    view.paint();
    controls.drawTrails();
  });
  $('canvas').addEventListener('webglcontextrestored', () => player.seek(player.seconds));
}
const wide = Math.max(...motions.map((m) => Math.max(m.high[0] - m.low[0], m.high[2] - m.low[2])));
if (motions.length === 1 && wide > 4.5) controls.turn('follow', 1);
if (motions.some((m) => m.trails.length)) controls.toggle('trails');
player.seek(asked.get('t'));
const still = asked.has('t') || matchMedia('(prefers-reduced-motion: reduce)').matches;
player.play(view && !still);

// For tests and tinkering: positions(i) is (24, 3) metres as shown, before the side-by-side places.
window.mocaplm = {
  player,
  view,
  seek(to) {
    player.play(false);
    player.seek(to);
  },
  positions(index) {
    const now = motions[index].sample(player.seconds, new Float32Array(3 * POINTS));
    return Array.from({length: 24}, (_, j) => Array.from(now.subarray(3 * j, 3 * j + 3)));
  },
};
