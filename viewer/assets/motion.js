// A motion's frames. Points of a frame: SMPL's 24 joints, then crown, face, heels and toe tips
// (viewer/figure.h). Metres, Y up.
const POINTS = 30;
const CROWN = 24, FACE = 25;

class Motion {
  constructor(data) {
    Object.assign(this, data);
    this.points = unpackPoints(data.points, data.frames, 3 * POINTS);
    this.seconds = (data.frames - 1) / data.fps;
    this.measure();
  }

  // The box around everything that the body reaches.
  measure() {
    const low = [0, 0, 0], high = [0, 0, 0], points = this.points;
    for (let i = 0; i < points.length; i += 3) {
      for (let k = 0; k < 3; k++) {
        if (points[i + k] < low[k]) low[k] = points[i + k];
        if (points[i + k] > high[k]) high[k] = points[i + k];
      }
    }
    this.low = low.map((x) => x * this.unit);
    this.high = high.map((x) => x * this.unit);
  }

  // The frame shown at a time, with a fraction between frames; held at both ends.
  frameAt(seconds) {
    const at = Math.min(Math.max(seconds * this.fps, 0), this.frames - 1);
    return Math.abs(at - Math.round(at)) < 1e-4 ? Math.round(at) : at;
  }

  // Fills `out` with (POINTS, 3) metres; between two frames on the straight line.
  sample(seconds, out) {
    const at = this.frameAt(seconds), frame = Math.floor(at), share = at - frame;
    const size = 3 * POINTS, a = frame * size, b = share > 0 ? a + size : a;
    for (let i = 0; i < size; i++) {
      out[i] = this.unit * (this.points[a + i] * (1 - share) + this.points[b + i] * share);
    }
    return out;
  }

  // A point of a frame, metres.
  place(frame, point, out) {
    const at = 3 * (frame * POINTS + point);
    return out.fromArray(this.points, at).multiplyScalar(this.unit);
  }
}
