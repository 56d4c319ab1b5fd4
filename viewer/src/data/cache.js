// Requests to workers, and what they brought: the least recently used goes when the budget is spent.

import { MissingFile } from './files.js'

const MAX_WORKERS = 4

/** Work handed out: urgent requests first, the latest of them first; what nobody wants any more is dropped before it starts. */
class Pool {
  constructor(makeWorker, filesFor, count) {
    this.waiting = []
    this.running = new Map()
    this.number = 0
    this.idle = Array.from({ length: count }, () => {
      const worker = makeWorker()
      worker.postMessage({ files: filesFor() })
      worker.onmessage = ({ data }) => this.finished(worker, data)
      worker.onerror = event => this.broken(worker, event.message || 'the worker did not start')
      return worker
    })
  }

  run(request, urgency) {
    return new Promise((resolve, reject) => {
      this.waiting.push({ request, urgency, resolve, reject, number: ++this.number })
      this.next()
    })
  }

  next() {
    while (this.idle.length && this.waiting.length) {
      let best = 0
      this.waiting.forEach((job, i) => {
        const than = this.waiting[best]
        if (job.urgency > than.urgency || (job.urgency === than.urgency && job.number < than.number)) best = i
      })
      const [job] = this.waiting.splice(best, 1)
      const worker = this.idle.pop()
      this.running.set(worker, job)
      worker.postMessage({ number: job.number, request: job.request })
    }
  }

  finished(worker, { number, result, error }) {
    const job = this.running.get(worker)
    if (job?.number !== number) return
    this.running.delete(worker)
    this.idle.push(worker)
    if (error) job.reject(error.path ? new MissingFile(error.path) : new Error(error.message))
    else job.resolve(result)
    this.next()
  }

  broken(worker, message) {
    this.running.get(worker)?.reject(new Error(message))
    this.running.delete(worker)
  }

  /** Drops what waits and is less urgent than asked. */
  drop(below) {
    this.waiting = this.waiting.filter(job => {
      if (job.urgency >= below) return true
      job.reject(new DOMException('not wanted any more', 'AbortError'))
      return false
    })
  }
}

export class Cache {
  /** `budget` bytes of decoded frames are kept. */
  constructor(makeWorker, filesFor, budget, workers) {
    const count = workers ?? Math.max(1, Math.min(MAX_WORKERS, (navigator.hardwareConcurrency ?? 2) - 1))
    this.pool = new Pool(makeWorker, filesFor, count)
    this.budget = budget
    this.bytes = 0
    this.entries = new Map()
  }

  /** What is at hand already, or undefined. */
  peek(request) {
    const key = keyOf(request)
    const entry = this.entries.get(key)
    if (!entry?.result) return undefined
    this.entries.delete(key)
    this.entries.set(key, entry)
    return entry.result
  }

  /** What a request brings; `urgency` 2 is for what is on the screen, 1 for what comes next. */
  get(request, urgency = 2) {
    const key = keyOf(request)
    const known = this.entries.get(key)
    if (known) {
      this.entries.delete(key)
      this.entries.set(key, known)
      const waits = this.pool.waiting.find(job => keyOf(job.request) === key)
      if (waits && waits.urgency < urgency) waits.urgency = urgency
      return known.promise
    }
    const entry = { bytes: 0 }
    entry.promise = this.pool.run(request, urgency).then(result => {
      entry.result = result
      entry.bytes = result.bytes ?? 0
      this.bytes += entry.bytes
      this.trim(key)
      return result
    }, error => {
      if (this.entries.get(key) === entry) this.entries.delete(key)
      throw error
    })
    this.entries.set(key, entry)
    return entry.promise
  }

  trim(keep) {
    for (const [key, entry] of this.entries) {
      if (this.bytes <= this.budget) return
      if (!entry.bytes || key === keep || entry.result?.pinned) continue
      this.entries.delete(key)
      this.bytes -= entry.bytes
      // Pictures hold memory that the garbage collector does not see. One that is on the screen is drawn already.
      entry.result.picture?.close()
    }
  }

  /** Forgets what waits to be looked at ahead of time. */
  dropAhead() {
    this.pool.drop(2)
  }
}

const keyOf = request => JSON.stringify(request)
