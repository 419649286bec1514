// Pictures and films of what is seen: all stages as they stand beside each other, under their names.

// Draw what is seen on one canvas; of a size that is given, so that the frames of a film are alike.
function seenOn(stages, canvas, size = null) {
  const boxes = stages.map((s) => s.canvas.parentElement.getBoundingClientRect());
  const [left, top] = [Math.min(...boxes.map((b) => b.left)), Math.min(...boxes.map((b) => b.top))];
  const [right, bottom] = [Math.max(...boxes.map((b) => b.right)), Math.max(...boxes.map((b) => b.bottom))];
  const dpr = stages[0].canvas.width / stages[0].canvas.clientWidth || 1;
  const [w, h] = size || [right - left, bottom - top].map((v) => 2 * Math.ceil(v * dpr / 2));   // films want even sides
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const ctx = canvas.getContext("2d"), k = Math.min(w / (right - left), h / (bottom - top));
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.fillStyle = stages[0].back; ctx.fillRect(0, 0, w, h);
  ctx.setTransform(k, 0, 0, k, 0, 0);
  for (const { canvas: one } of stages) {
    const name = one.parentElement.querySelector("h2"), box = one.getBoundingClientRect();
    if (name) heading(ctx, name, left, top);
    if (box.width) ctx.drawImage(one, box.left - left, box.top - top, box.width, box.height);
  }
  return [w, h];
}

function heading(ctx, name, left, top) {                  // as the page shows it
  const box = name.getBoundingClientRect(), style = getComputedStyle(name), bar = parseFloat(style.borderLeftWidth);
  ctx.fillStyle = style.borderLeftColor; ctx.fillRect(box.left - left, box.top - top, bar, box.height);
  ctx.fillStyle = style.color; ctx.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
  ctx.textBaseline = "middle"; ctx.textAlign = "left";
  ctx.fillText(fitting(ctx, name.textContent, box.width - bar - 6), box.left - left + bar + 6, box.top - top + box.height / 2);
}

function savePicture(stages, name, t) {
  const canvas = el("canvas");
  seenOn(stages, canvas);
  canvas.toBlob((blob) => save(blob, `${fileName(name)}_${t.toFixed(3)}s.png`));
}

// A film that is being made. frame() adds what is seen by now, stop() saves it and calls `ended`.
class Filming {
  static kind() {                                         // what this browser makes films of; undefined: none
    return ["video/mp4;codecs=avc1", "video/webm;codecs=vp9", "video/webm"].find((k) =>
      globalThis.MediaRecorder && MediaRecorder.isTypeSupported(k));
  }
  constructor(stages, name, ended) {
    this.canvas = el("canvas");
    this.size = seenOn(stages, this.canvas);
    const type = Filming.kind(), pieces = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(60), { mimeType: type, videoBitsPerSecond: 8e6 });
    this.recorder.ondataavailable = (e) => pieces.push(e.data);
    this.recorder.onstop = () => {
      save(new Blob(pieces, { type }), `${fileName(name)}.${type.slice(6).split(";")[0]}`);
      ended();
    };
    this.recorder.start();
  }
  frame(stages) { seenOn(stages, this.canvas, this.size); }
  stop() { if (this.recorder.state !== "inactive") this.recorder.stop(); }
}
