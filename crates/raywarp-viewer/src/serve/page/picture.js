// Stripes to pixels: decoded beside the main thread, drawn together.

const HEAD = 24;
const TYPES = { 1: "image/jpeg", 2: "image/png" };

/// The picture on a canvas. `on` has: shown (a frame is on the canvas: its head), received (bytes of a lossless frame
/// so far), failed.
export class Picture {
  constructor(canvas, on) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.on = on;
    this.coming = null;
    this.latest = 0;
  }

  /// After a new connection frames count from the start again.
  restart() {
    this.coming = null;
    this.latest = 0;
    this.session = (this.session ?? 0) + 1;
  }

  /// One stripe, head and all.
  take(data) {
    const head = readHead(data);
    if (this.coming?.frame !== head.frame) this.coming = { frame: head.frame, bytes: 0, stripes: [] };
    const coming = this.coming;
    coming.bytes += data.byteLength;
    const blob = new Blob([new Uint8Array(data, HEAD)], { type: TYPES[head.kind] });
    const bitmap = createImageBitmap(blob, { colorSpaceConversion: "none" });
    // Handled with the others; without this a frame that is broken off would count as an error nobody caught.
    bitmap.catch(() => {});
    coming.stripes.push({ row: head.row, bitmap });
    if (head.kind === 2) this.on.received(head.frame, coming.bytes);
    if (coming.stripes.length === head.count) this.finish(head, coming.stripes, this.session);
  }

  async finish(head, stripes, session) {
    let bitmaps;
    try {
      bitmaps = await Promise.all(stripes.map((stripe) => stripe.bitmap));
    } catch (error) {
      this.on.failed(error);
      if (session === this.session) this.on.shown(head, false);
      return;
    }
    const isNew = session === this.session && head.frame > this.latest;
    if (isNew) this.draw(head, stripes, bitmaps);
    bitmaps.forEach((bitmap) => bitmap.close());
    if (session === this.session) this.on.shown(head, isNew);
  }

  draw(head, stripes, bitmaps) {
    const { canvas, context } = this;
    this.latest = head.frame;
    if (canvas.width !== head.width || canvas.height !== head.height) {
      canvas.width = head.width;
      canvas.height = head.height;
    }
    bitmaps.forEach((bitmap, index) => context.drawImage(bitmap, 0, stripes[index].row));
    canvas.dataset.frame = head.frame;
    canvas.dataset.kind = head.kind === 2 ? "png" : "jpeg";
    canvas.dataset.settled = head.settled;
  }
}

/// The kind of a binary message.
export function kindOf(data) {
  return new DataView(data).getUint8(0);
}

function readHead(data) {
  const view = new DataView(data);
  const short = (at) => view.getUint16(at, true);
  return {
    kind: view.getUint8(0),
    settled: (view.getUint8(1) & 1) === 1,
    index: short(2),
    count: short(4),
    width: short(6),
    height: short(8),
    row: short(10),
    rows: short(12),
    frame: view.getUint32(16, true),
    mark: view.getUint32(20, true),
  };
}
