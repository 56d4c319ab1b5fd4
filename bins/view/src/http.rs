//! As much of HTTP/1.1 as a page that reads files needs: requests without bodies, one byte range.

use std::io::{self, BufRead, Read};

/// Longest head of a request that is read, bytes.
const HEAD_LIMIT: u64 = 16 << 10;

/// What a client asks for.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Request {
    pub(crate) method: String,
    /// As sent: with its query, percent signs and all.
    pub(crate) target: String,
    pub(crate) host: Option<String>,
    pub(crate) range: Option<String>,
    /// Whether the connection stays open for another request.
    pub(crate) keep_alive: bool,
}

/// Why there is no request.
#[derive(Debug)]
pub(crate) enum NoRequest {
    /// The client has gone, or said nothing for too long.
    Gone,
    /// What it sent is no request that is understood here: why.
    Bad(&'static str),
}

impl From<io::Error> for NoRequest {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

/// Reads the head of a request.
pub(crate) fn read_request(stream: &mut impl BufRead) -> Result<Request, NoRequest> {
    let mut head = stream.take(HEAD_LIMIT);
    let first = line(&mut head)?.ok_or(NoRequest::Gone)?;
    let mut words = first.split(' ');
    let (Some(method), Some(target), Some(version), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return Err(NoRequest::Bad("the request line has not three words"));
    };
    if !matches!(version, "HTTP/1.1" | "HTTP/1.0") {
        return Err(NoRequest::Bad("only HTTP/1.1 and 1.0 are spoken here"));
    }
    let mut request = Request {
        method: method.to_owned(),
        target: target.to_owned(),
        host: None,
        range: None,
        keep_alive: version == "HTTP/1.1",
    };
    loop {
        let Some(header) = line(&mut head)? else { return Err(NoRequest::Bad("the head has no end")) };
        if header.is_empty() {
            return Ok(request);
        }
        let Some((name, value)) = header.split_once(':') else {
            return Err(NoRequest::Bad("a header has no colon"));
        };
        let value = value.trim();
        match name.to_ascii_lowercase().as_str() {
            "host" if request.host.is_some() => return Err(NoRequest::Bad("there are two hosts")),
            "host" => request.host = Some(value.to_owned()),
            "range" => request.range = Some(value.to_owned()),
            "connection" if value.eq_ignore_ascii_case("close") => request.keep_alive = false,
            "content-length" if value == "0" => {}
            "content-length" | "transfer-encoding" => {
                return Err(NoRequest::Bad("requests have no body here"));
            }
            _ => {}
        }
    }
}

/// A line without its end; none at the end of what may be read.
fn line(head: &mut impl BufRead) -> Result<Option<String>, NoRequest> {
    let mut bytes = Vec::new();
    head.read_until(b'\n', &mut bytes)?;
    if bytes.pop() != Some(b'\n') {
        return Ok(None);
    }
    if bytes.last() == Some(&b'\r') {
        bytes.pop();
    }
    String::from_utf8(bytes).map(Some).map_err(|_| NoRequest::Bad("the head is no text"))
}

/// Which part of a file is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByteRange {
    /// All of it.
    Whole,
    /// From a byte, so many.
    Range { start: u64, length: u64 },
    /// A part that the file does not have.
    Outside,
}

/// The part of a file of some size that a `Range` header asks for. Several ranges, and what is no range of
/// bytes, are passed over, as the standard allows.
pub(crate) fn part_of(range: Option<&str>, size: u64) -> ByteRange {
    let Some(range) = range.and_then(|r| r.strip_prefix("bytes=")) else { return ByteRange::Whole };
    let Some((first, last)) = range.split_once('-') else { return ByteRange::Whole };
    let number =
        |text: &str| (text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse::<u64>().ok()).flatten();
    match (first.trim(), last.trim()) {
        ("", last) => match number(last) {
            None => ByteRange::Whole,
            Some(0) => ByteRange::Outside,
            Some(_) if size == 0 => ByteRange::Outside,
            Some(length) => ByteRange::Range { start: size - length.min(size), length: length.min(size) },
        },
        (first, last) => {
            let last = if last.is_empty() { Some(u64::MAX) } else { number(last) };
            match (number(first), last) {
                (Some(first), Some(last)) if first <= last => {
                    if first >= size {
                        return ByteRange::Outside;
                    }
                    ByteRange::Range { start: first, length: last.min(size - 1) - first + 1 }
                }
                _ => ByteRange::Whole,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Request, &'static str> {
        read_request(&mut text.as_bytes()).map_err(|e| match e {
            NoRequest::Gone => "gone",
            NoRequest::Bad(why) => why,
        })
    }

    #[test]
    fn heads_are_read() {
        let request = read("GET /a?b HTTP/1.1\r\nHost: localhost:80\r\nRANGE: bytes=0-1\r\nX: y\r\n\r\nrest")
            .expect("is one");
        assert_eq!((request.method.as_str(), request.target.as_str()), ("GET", "/a?b"));
        assert_eq!(
            (request.host.as_deref(), request.range.as_deref()),
            (Some("localhost:80"), Some("bytes=0-1"))
        );
        assert!(request.keep_alive);
        assert!(!read("GET / HTTP/1.0\r\n\r\n").expect("is one").keep_alive);
        assert!(!read("GET / HTTP/1.1\r\nConnection: Close\r\n\r\n").expect("is one").keep_alive);
        // Line feeds alone are accepted, as by most servers.
        assert!(read("GET / HTTP/1.1\nHost: x\n\n").is_ok());
    }

    #[test]
    fn what_is_no_request_is_named() {
        assert_eq!(read(""), Err("gone"));
        assert_eq!(read("GET / HTTP/1.1\r\nHost: a\r\n"), Err("the head has no end"));
        assert_eq!(read("GET /\r\n\r\n"), Err("the request line has not three words"));
        assert_eq!(read("GET /a b HTTP/1.1\r\n\r\n"), Err("the request line has not three words"));
        assert_eq!(read("GET / HTTP/2\r\n\r\n"), Err("only HTTP/1.1 and 1.0 are spoken here"));
        assert_eq!(read("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"), Err("there are two hosts"));
        assert_eq!(read("GET / HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc"), Err("requests have no body here"));
        assert_eq!(
            read("GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"),
            Err("requests have no body here")
        );
        assert_eq!(read("GET / HTTP/1.1\r\nnonsense\r\n\r\n"), Err("a header has no colon"));
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(20_000));
        assert_eq!(read(&long), Err("gone"));
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(5_000));
        assert_eq!(read(&many), Err("the head has no end"));
    }

    #[test]
    fn ranges_are_cut_to_the_file() {
        let part = |range: &str| part_of(Some(range), 10);
        let range = |start, length| ByteRange::Range { start, length };
        assert_eq!(part_of(None, 10), ByteRange::Whole);
        assert_eq!(part("bytes=0-0"), range(0, 1));
        assert_eq!(part("bytes=3-5"), range(3, 3));
        assert_eq!(part("bytes=3-"), range(3, 7));
        assert_eq!(part("bytes=8-99"), range(8, 2));
        assert_eq!(part("bytes=0-18446744073709551615"), range(0, 10));
        assert_eq!(part("bytes=-4"), range(6, 4));
        assert_eq!(part("bytes=-40"), range(0, 10));
        assert_eq!(part("bytes=10-"), ByteRange::Outside);
        assert_eq!(part("bytes=-0"), ByteRange::Outside);
        assert_eq!(part_of(Some("bytes=0-"), 0), ByteRange::Outside);
        assert_eq!(part_of(Some("bytes=-3"), 0), ByteRange::Outside);
        for passed_over in [
            "bytes=5-3",
            "bytes=a-b",
            "bytes=0-1,4-5",
            "bytes=",
            "bytes=-",
            "lines=0-1",
            "bytes=+1-2",
            "bytes=99999999999999999999-",
        ] {
            assert_eq!(part(passed_over), ByteRange::Whole, "{passed_over}");
        }
    }
}
