// How many of the points are drawn while the picture moves: as many as the machine draws in time. A still picture has them all.

/** What a moving picture may take, ms: twelve a second, with something left for decoding. */
const TARGET_MS = 80
/** The least share of the points. */
const LEAST = 1 / 32
/** One point of so many at least is read. */
const MOST_STRIDE = 8
/** The picture is still when nothing has changed for so long, ms. */
const STILL_MS = 350
/** A picture that takes longer is not waited for, ms. */
const PATIENCE_MS = 5000

export class Detail {
  /** `context` is a WebGL 2 context. */
  constructor(context) {
    this.context = context
    this.share = 1
    /** What is being drawn: `{fence, start, share}`. */
    this.pending = null
    this.changed = -Infinity
    this.isWhole = true
  }

  /**
   * The picture that has to be drawn now, or null: `share` of the points, and `isStill` when it has stood still for a moment
   * (`isDirty`: something has changed; `isMoving`: it soon will).
   */
  next(now, isDirty, isMoving) {
    if (isDirty || isMoving) this.changed = now
    if (!this.isDone(now)) return null
    if (isDirty) return { share: this.share, isStill: false }
    return !this.isWhole && now - this.changed > STILL_MS ? { share: 1, isStill: true } : null
  }

  /** A picture of a share of the points was handed to the graphics card, with all else or with less of it. */
  drawn(now, share, isWhole) {
    const { context } = this
    this.isWhole = isWhole
    this.pending = { fence: context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0), start: now, share }
    context.flush()
  }

  /** Whether the last picture is on the screen. Its time says what the next may hold. */
  isDone(now) {
    if (!this.pending) return true
    const { context, pending: { fence, start, share } } = this
    const tookMs = now - start
    const isDone = !fence || context.getSyncParameter(fence, context.SYNC_STATUS) === context.SIGNALED
    if (!isDone && tookMs < PATIENCE_MS) return false
    context.deleteSync(fence)
    this.pending = null
    this.share = shareFor(share, tookMs)
    return true
  }
}

/** The share that takes about the time that there is, after a picture of a share took so long, ms. Small steps up: times vary. */
export function shareFor(share, tookMs) {
  const wanted = share * TARGET_MS / Math.max(tookMs, 1)
  if (wanted > 1 && share === 1) return 1
  return Math.min(1, Math.max(LEAST, Math.min(wanted, 1.25 * share)))
}

/** How many points there may be to one that is read, where a share of them is drawn: a power of two, so that few frames are read twice. */
export function strideFor(share) {
  let stride = 1
  while (2 * stride <= MOST_STRIDE && 2 * stride * share <= 1) stride *= 2
  return stride
}
