// Chromium without a window, driven through a pipe: no library and no open port.

import { spawn } from 'node:child_process'
import { mkdtemp, rm } from 'node:fs/promises'
import { tmpdir } from 'node:os'
import path from 'node:path'

/** A reply takes no longer than this, ms. */
const PATIENCE_MS = 120_000

export class Chromium {
  static async start(program) {
    const profile = await mkdtemp(path.join(tmpdir(), 'convoy-viewer-'))
    const child = spawn(program, [
      '--headless=new', '--remote-debugging-pipe', '--no-sandbox', '--no-first-run', '--disable-extensions', '--hide-scrollbars', '--mute-audio',
      '--disable-background-networking', '--disable-component-update', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      `--user-data-dir=${profile}`, 'about:blank',
    ], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] })
    return new Chromium(child, profile)
  }

  constructor(child, profile) {
    Object.assign(this, { child, profile, number: 0, waiting: new Map(), pages: new Map(), rest: '' })
    child.stdio[4].setEncoding('utf8')
    child.stdio[4].on('data', text => this.take(text))
    child.on('exit', () => {
      for (const { reject } of this.waiting.values()) reject(new Error('Chromium has ended'))
      this.waiting.clear()
    })
  }

  take(text) {
    const messages = (this.rest + text).split('\0')
    this.rest = messages.pop()
    for (const message of messages.map(m => JSON.parse(m))) {
      const job = this.waiting.get(message.id)
      if (job) {
        this.waiting.delete(message.id)
        clearTimeout(job.timer)
        if (message.error) job.reject(new Error(`${job.method}: ${message.error.message}`))
        else job.resolve(message.result)
      } else if (message.method) {
        this.pages.get(message.sessionId)?.event(message.method, message.params)
      }
    }
  }

  send(method, params = {}, sessionId) {
    const id = ++this.number
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.waiting.delete(id)
        reject(new Error(`${method} was not answered`))
      }, PATIENCE_MS)
      this.waiting.set(id, { resolve, reject, timer, method })
      this.child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`)
    })
  }

  async page({ width, height, scale = 1, isPhone = false }) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' })
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true })
    const page = new Page(this, sessionId, targetId)
    this.pages.set(sessionId, page)
    for (const domain of ['Page', 'Runtime', 'Log', 'Performance']) await page.send(`${domain}.enable`)
    await page.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: scale, mobile: isPhone })
    if (isPhone) await page.send('Emulation.setTouchEmulationEnabled', { enabled: true })
    return page
  }

  async stop() {
    await this.send('Browser.close').catch(() => this.child.kill())
    await new Promise(resolve => this.child.exitCode === null ? this.child.once('exit', resolve) : resolve())
    await rm(this.profile, { recursive: true, force: true, maxRetries: 5 })
  }
}

class Page {
  constructor(browser, session, target) {
    Object.assign(this, { browser, session, target, errors: [] })
  }

  send(method, params) {
    return this.browser.send(method, params, this.session)
  }

  event(method, params) {
    if (method === 'Runtime.exceptionThrown') {
      const { exceptionDetails: d } = params
      this.errors.push(d.exception?.description ?? d.text)
    } else if (method === 'Runtime.consoleAPICalled' && params.type === 'error') {
      this.errors.push(params.args.map(a => a.description ?? a.value).join(' '))
    } else if (method === 'Log.entryAdded' && params.entry.level === 'error') {
      this.errors.push(`${params.entry.text} ${params.entry.url ?? ''}`)
    } else if (method === 'Page.loadEventFired') {
      this.loaded?.()
    }
  }

  async open(url) {
    const loaded = new Promise(resolve => { this.loaded = resolve })
    await this.send('Page.navigate', { url: 'about:blank' })
    await loaded
    const again = new Promise(resolve => { this.loaded = resolve })
    const { errorText } = await this.send('Page.navigate', { url })
    if (errorText) throw new Error(`${url}: ${errorText}`)
    await again
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true })
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`)
    return result.value
  }

  async until(expression, seconds = 240) {
    const end = Date.now() + 1000 * seconds
    while (!await this.evaluate(expression)) {
      if (Date.now() > end) throw new Error(`waited ${seconds} s for ${expression}\n${this.errors.join('\n')}`)
      await new Promise(resolve => setTimeout(resolve, 50))
    }
  }

  async press(key, code = key, modifiers = 0) {
    const text = key.length === 1 ? key : undefined
    await this.send('Input.dispatchKeyEvent', { type: 'keyDown', key, code, text, modifiers })
    await this.send('Input.dispatchKeyEvent', { type: 'keyUp', key, code, modifiers })
  }

  async click(x, y) {
    for (const type of ['mouseMoved', 'mousePressed', 'mouseReleased']) {
      await this.send('Input.dispatchMouseEvent', { type, x, y, button: type === 'mouseMoved' ? 'none' : 'left', clickCount: type === 'mouseMoved' ? 0 : 1 })
    }
  }

  async metrics() {
    const { metrics } = await this.send('Performance.getMetrics')
    return Object.fromEntries(metrics.map(m => [m.name, m.value]))
  }

  async picture() {
    const { data } = await this.send('Page.captureScreenshot', { format: 'png' })
    return Buffer.from(data, 'base64')
  }

  async close() {
    await this.browser.send('Target.closeTarget', { targetId: this.target })
  }
}
