// Where bytes come from: a server that answers range requests, or files inside the page itself.

export class MissingFile extends Error {
  constructor(path) {
    super(`there is no ${path}`)
    this.name = 'MissingFile'
    this.path = path
  }
}

/** Files below a URL, read by ranges. */
export class HttpFiles {
  constructor(base) {
    this.base = base
  }

  async read(path, start, end) {
    const response = await fetch(this.base + path.split('/').map(encodeURIComponent).join('/'), {
      headers: { Range: `bytes=${start}-${end - 1}` },
    })
    if (response.status === 404) throw new MissingFile(path)
    if (response.status !== 206) throw new Error(`${path}: the server answered ${response.status}`)
    const bytes = new Uint8Array(await response.arrayBuffer())
    if (bytes.length !== end - start) throw new Error(`${path}: ${bytes.length} bytes came, ${end - start} were asked for`)
    return bytes
  }
}

/** Files in memory: path to bytes. */
export class MemoryFiles {
  constructor(files) {
    this.files = files
  }

  async read(path, start, end) {
    const bytes = this.files.get(path)
    if (!bytes) throw new MissingFile(path)
    return bytes.subarray(start, end)
  }
}
