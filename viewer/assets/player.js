// The clock that all motions share.
class Player {
  // `shown` is told the seconds whenever they change, `turned` when playing starts or stops.
  constructor(motions, shown, turned) {
    Object.assign(this, {shown, turned, seconds: 0, playing: false, speed: 1, loop: true});
    this.duration = Math.max(...motions.map((m) => m.seconds));
    this.rate = Math.max(...motions.map((m) => m.fps));  // of the time bar and the frame steps
    this.lastFrame = Math.round(this.duration * this.rate);
  }

  get frame() {
    return Math.round(this.seconds * this.rate);
  }

  seek(to) {
    this.seconds = Math.min(Math.max(Number(to) || 0, 0), this.duration);
    this.shown(this.seconds);
  }

  // Stops on a frame, so many frames from this one.
  step(frames) {
    this.play(false);
    this.seek((this.frame + frames) / this.rate);
  }

  play(on) {
    on = Boolean(on) && this.duration > 0;
    if (on && this.seconds >= this.duration) this.seconds = 0;
    if (on && !this.playing) {
      this.before = performance.now();
      requestAnimationFrame((now) => this.tick(now));
    }
    this.playing = on;
    this.turned(on);
  }

  tick(now) {
    if (!this.playing) return;
    // After a hidden tab or a long frame the clock goes on from where it was.
    const passed = Math.min(Math.max(now - this.before, 0) / 1000, .1) * this.speed;
    this.before = now;
    this.seconds += passed;
    // The last frame is held for a moment before it starts again.
    if (this.seconds > this.duration + (this.loop ? .4 : 0)) {
      if (!this.loop) this.play(false);
      this.seconds = this.loop ? 0 : this.duration;
    }
    this.shown(Math.min(this.seconds, this.duration));
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
  }
}
