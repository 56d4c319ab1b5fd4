//! A server for this machine alone: reads, never writes.
//!
//! Its own rather than a crate's: one page's requests without bodies are a few hundred lines over std, and
//! what small servers of others bring beyond (uploads, chunked bodies, TLS, pools) would be surface without
//! use.

use std::io::{self, BufReader, BufWriter, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use crate::content::{Content, content};
use crate::http::{ByteRange, NoRequest, Request, part_of, read_request};
use crate::site::Site;

/// Browsers keep what they remember by host and port.
const USUAL_PORT: u16 = 8461;
/// A browser opens six; more than this at once are turned away.
const MAX_CONNECTIONS: usize = 64;
/// Connections on which nothing happens are closed after this.
const PATIENCE: Duration = Duration::from_secs(30);
/// Objects pass through memory in pieces of this size, bytes.
const PIECE: usize = 64 << 10;

/// For the page: nothing from elsewhere, nothing sent elsewhere, no frame around it.
const PAGE_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; \
    style-src 'self'; img-src 'self' data: blob:; connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// For files of the store, which may come from anybody: a report's own scripts, typeface and figures, and no
/// requests.
const FILE_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; font-src data:; img-src 'self' data:; \
    frame-ancestors 'none'";

/// A server that listens.
pub(crate) struct Server {
    listener: TcpListener,
    port: u16,
    site: Arc<Site>,
}

impl Server {
    /// Listens on the loopback interface; port 0 is any free one, as is none where the usual one is taken.
    ///
    /// # Errors
    /// The port is taken or not allowed.
    pub(crate) fn bind(port: Option<u16>, site: Site) -> io::Result<Self> {
        let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = match port {
            Some(port) => bind(port)?,
            None => bind(USUAL_PORT).or_else(|_| bind(0))?,
        };
        let port = listener.local_addr()?.port();
        Ok(Self { listener, port, site: Arc::new(site) })
    }

    /// Where browsers find it.
    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Answers until the program ends.
    pub(crate) fn run(&self) {
        let open = Arc::new(AtomicUsize::new(0));
        for stream in self.listener.incoming().flatten() {
            let (site, port, open) = (Arc::clone(&self.site), self.port, Arc::clone(&open));
            if open.fetch_add(1, Ordering::SeqCst) >= MAX_CONNECTIONS {
                open.fetch_sub(1, Ordering::SeqCst);
                continue;
            }
            let count = Arc::clone(&open);
            let started = thread::Builder::new().name("connection".into()).spawn(move || {
                // A client that goes in the middle of an answer is nobody's fault.
                let _ = converse(&stream, port, &site);
                let _ = stream.shutdown(Shutdown::Both);
                count.fetch_sub(1, Ordering::SeqCst);
            });
            if started.is_err() {
                open.fetch_sub(1, Ordering::SeqCst);
            }
        }
    }
}

/// Answers the requests of one connection.
fn converse(stream: &TcpStream, port: u16, site: &Site) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    let mut reader = BufReader::new(stream);
    let mut writer = BufWriter::with_capacity(PIECE, stream);
    loop {
        let keep_alive = match read_request(&mut reader) {
            Ok(request) => {
                answer(&request, port, site, &mut writer)?;
                request.keep_alive
            }
            Err(NoRequest::Gone) => return Ok(()),
            Err(NoRequest::Bad(why)) => {
                Head::new("400 Bad Request").write_text(&mut writer, why, true)?;
                false
            }
        };
        writer.flush()?;
        if !keep_alive {
            return Ok(());
        }
    }
}

/// Answers a request. A request that names another host than this machine comes from a foreign page
/// whose name was made to point here (DNS rebinding); it gets nothing.
fn answer(request: &Request, port: u16, site: &Site, out: &mut impl Write) -> io::Result<()> {
    let with_body = request.method != "HEAD";
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    if !request.host.as_ref().is_some_and(|host| hosts.iter().any(|own| own.eq_ignore_ascii_case(host))) {
        return Head::new("403 Forbidden").write_text(out, "this host is not known here", with_body);
    }
    if !matches!(request.method.as_str(), "GET" | "HEAD") {
        return Head::new("405 Method Not Allowed").with("Allow", "GET, HEAD").write_text(
            out,
            "nothing is written here",
            with_body,
        );
    }
    let path = request.target.split(['?', '#']).next().unwrap_or_default();
    if !path.starts_with('/') {
        return Head::new("400 Bad Request").write_text(out, "a path is asked for", with_body);
    }
    let policy = if path.starts_with("/store/") { FILE_POLICY } else { PAGE_POLICY };
    match content(site, path) {
        Err(why) => Head::new("404 Not Found").write_text(out, &why.to_string(), with_body),
        Ok(Content::Text(text, media_type)) => {
            let head =
                Head::new("200 OK").with("Content-Type", media_type).with("Content-Security-Policy", policy);
            head.write(out, text.len() as u64)?;
            if with_body { out.write_all(text.as_bytes()) } else { Ok(()) }
        }
        Ok(Content::Object(object, media_type)) => {
            let size = object.size();
            let head = |status| {
                Head::new(status)
                    .with("Content-Type", media_type)
                    .with("Content-Security-Policy", policy)
                    .with("Accept-Ranges", "bytes")
            };
            let (start, length) = match part_of(request.range.as_deref(), size) {
                ByteRange::Outside => {
                    let head = Head::new("416 Range Not Satisfiable")
                        .with("Content-Range", &format!("bytes */{size}"));
                    return head.write_text(out, "the file has no such part", with_body);
                }
                ByteRange::Whole => {
                    head("200 OK").write(out, size)?;
                    (0, size)
                }
                ByteRange::Range { start, length } => {
                    let range = format!("bytes {start}-{}/{size}", start + length - 1);
                    head("206 Partial Content").with("Content-Range", &range).write(out, length)?;
                    (start, length)
                }
            };
            if !with_body {
                return Ok(());
            }
            object.will_read(start..start + length);
            let mut stream = BufReader::with_capacity(PIECE, object.stream(start).take(length));
            let sent = io::copy(&mut stream, out)?;
            // The promised length cannot be kept: the connection must not go on as if it were.
            if sent < length { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
        }
    }
}

/// The head of an answer.
struct Head(String);

impl Head {
    fn new(status: &str) -> Self {
        Self(format!(
            "HTTP/1.1 {status}\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n"
        ))
    }

    fn with(mut self, name: &str, value: &str) -> Self {
        self.0.push_str(&format!("{name}: {value}\r\n"));
        self
    }

    fn write(self, out: &mut impl Write, length: u64) -> io::Result<()> {
        write!(out, "{}Content-Length: {length}\r\n\r\n", self.0)
    }

    fn write_text(self, out: &mut impl Write, text: &str, with_body: bool) -> io::Result<()> {
        self.with("Content-Type", "text/plain; charset=utf-8").write(out, text.len() as u64)?;
        if with_body { out.write_all(text.as_bytes()) } else { Ok(()) }
    }
}
