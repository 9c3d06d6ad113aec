// What the page measures by itself: pictures and bits a second, and the time from an input to the picture that has it.

const SECOND = 1000;
const SAMPLES = 240;
// An input that changes nothing has no picture of its own; the next one, much later, is not its picture.
const EXPIRY = 2000;

export class Stats {
  constructor() {
    this.marks = [];
    this.latencies = [];
    this.shown = [];
    this.bytes = [];
    this.next = 1;
    this.frames = 0;
  }

  /// An input that a picture should follow, at the time when it happened; its number.
  mark(time) {
    if (this.marks.length > SAMPLES) this.marks.shift();
    this.marks.push({ number: this.next, time });
    return this.next++;
  }

  received(bytes) {
    this.bytes.push({ time: performance.now(), bytes });
  }

  /// A picture is on the canvas that includes all inputs up to a mark.
  drawn(mark) {
    const now = performance.now();
    this.frames += 1;
    this.shown.push(now);
    while (this.marks.length > 0 && this.marks[0].number <= mark) {
      const latency = now - this.marks.shift().time;
      if (latency <= EXPIRY) this.latencies.push(latency);
    }
    this.latencies.splice(0, this.latencies.length - SAMPLES);
  }

  /// Numbers of the last second, and of the last inputs.
  read() {
    const since = performance.now() - SECOND;
    this.shown = this.shown.filter((time) => time > since);
    this.bytes = this.bytes.filter((one) => one.time > since);
    const sorted = [...this.latencies].sort((a, b) => a - b);
    const at = (share) => (sorted.length > 0 ? sorted[Math.floor(share * (sorted.length - 1))] : null);
    return {
      fps: this.shown.length,
      bits_per_s: 8 * this.bytes.reduce((sum, one) => sum + one.bytes, 0),
      frames: this.frames,
      latency_ms: { median: at(0.5), p95: at(0.95), count: sorted.length, last: this.latencies.at(-1) ?? null },
    };
  }

  /// Forgets what inputs took.
  reset() {
    this.marks = [];
    this.latencies = [];
  }
}
