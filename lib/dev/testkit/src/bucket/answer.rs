//! What S3 does and says.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Range;
use std::sync::{Arc, Mutex};

use super::http::Request;
use super::place::{Object, Place, lock};

/// Keys of one answer to a listing.
const PAGE: usize = 1000;

/// An answer.
pub(crate) struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    pub(crate) body: Vec<u8>,
    /// What a `HEAD` says that a body would have.
    length: usize,
}

impl Answer {
    fn new(status: u16) -> Self {
        Self { status, headers: Vec::new(), body: Vec::new(), length: 0 }
    }

    fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.headers.push((name, value.into()));
        self
    }

    fn saying(mut self, body: impl Into<Vec<u8>>) -> Self {
        self.body = body.into();
        self.length = self.body.len();
        self
    }

    fn error(status: u16, code: &str) -> Self {
        Self::new(status).saying(format!("<Error><Code>{code}</Code><Message>no</Message></Error>"))
    }

    /// As a service refuses that is out of order, or asks who it is.
    pub(crate) fn refused(status: u16) -> Self {
        let code = match status {
            403 => "AccessDenied",
            404 => "NoSuchBucket",
            503 => "SlowDown",
            _ => "InternalError",
        };
        Self::error(status, code)
    }

    /// The whole answer; that to a `HEAD` has no body.
    pub(crate) fn bytes(&self, is_head: bool) -> Vec<u8> {
        let mut head = format!("HTTP/1.1 {} x\r\nContent-Length: {}\r\n", self.status, self.length);
        for (name, value) in &self.headers {
            let _ = write!(head, "{name}: {value}\r\n");
        }
        head.push_str("\r\n");
        let mut bytes = head.into_bytes();
        if !is_head {
            bytes.extend_from_slice(&self.body);
        }
        bytes
    }

    /// Does what is asked for.
    pub(crate) fn to(request: &Request, place: &Mutex<Place>) -> Self {
        let mut place = lock(place);
        let (upload, key) = (request.asked("uploadId").and_then(|id| id.parse().ok()), request.path.as_str());
        match (request.method.as_str(), upload) {
            ("GET", _) if request.asked("list-type").is_some() => list(&place, request),
            ("GET" | "HEAD", _) => get(&place, request),
            ("PUT", Some(id)) => put_part(&mut place, id, request),
            ("PUT", None) => put(&mut place, request),
            ("POST", Some(id)) => complete(&mut place, id, request),
            ("POST", None) if request.asked("uploads").is_some() => {
                place.changes += 1;
                let id = place.changes;
                place.uploads.insert(id, (key.to_owned(), Default::default()));
                let start = "<InitiateMultipartUploadResult><UploadId>";
                Self::new(200).saying(format!("{start}{id}</UploadId></InitiateMultipartUploadResult>"))
            }
            ("DELETE", Some(id)) => {
                place.uploads.remove(&id);
                Self::new(204)
            }
            ("DELETE", None) => {
                place.objects.remove(key);
                Self::new(204)
            }
            _ => Self::error(400, "InvalidRequest"),
        }
    }
}

fn tag(object: &Object) -> String {
    format!("\"{}\"", object.version)
}

fn get(place: &Place, request: &Request) -> Answer {
    let Some(object) = place.objects.get(&request.path) else { return Answer::error(404, "NoSuchKey") };
    let size = object.bytes.len();
    let described = |answer: Answer| {
        answer.with("ETag", tag(object)).with("Last-Modified", "Thu, 01 Jan 2026 00:00:00 GMT")
    };
    match request.header("range").map(|range| part_of(range, size)) {
        None => described(Answer::new(200)).saying(object.bytes.to_vec()),
        Some(Some(part)) => {
            let range = format!("bytes {}-{}/{size}", part.start, part.end - 1);
            described(Answer::new(206)).with("Content-Range", range).saying(object.bytes[part].to_vec())
        }
        Some(None) => Answer::error(416, "InvalidRange"),
    }
}

/// The part that `bytes=a-b`, `bytes=a-` or `bytes=-n` names.
fn part_of(range: &str, size: usize) -> Option<Range<usize>> {
    let (start, end) = range.strip_prefix("bytes=")?.split_once('-')?;
    let part = match (start.parse::<usize>().ok(), end.parse::<usize>().ok()) {
        (Some(start), Some(last)) => start..size.min(last + 1),
        (Some(start), None) => start..size,
        (None, Some(n)) => size.saturating_sub(n)..size,
        (None, None) => return None,
    };
    (part.start < part.end).then_some(part)
}

/// Whether the conditions of a request forbid that an object is put.
fn forbidden(place: &Place, request: &Request) -> bool {
    let there = place.objects.get(&request.path);
    if place.ignores_conditions {
        return false;
    }
    let is_new = request.header("if-none-match").is_none() || there.is_none();
    let is_same =
        request.header("if-match").is_none_or(|wanted| there.is_some_and(|there| tag(there) == wanted));
    !is_new || !is_same
}

fn insert(place: &mut Place, key: &str, bytes: Vec<u8>) -> String {
    place.changes += 1;
    let object = Object { bytes: Arc::new(bytes), version: place.changes };
    let tag = tag(&object);
    place.objects.insert(key.to_owned(), object);
    tag
}

fn put(place: &mut Place, request: &Request) -> Answer {
    if forbidden(place, request) {
        return Answer::error(412, "PreconditionFailed");
    }
    let tag = insert(place, &request.path, request.body.clone());
    Answer::new(200).with("ETag", tag)
}

fn put_part(place: &mut Place, id: u64, request: &Request) -> Answer {
    let number = request.asked("partNumber").and_then(|number| number.parse().ok());
    match (place.uploads.get_mut(&id), number) {
        (Some((_, parts)), Some(number)) => {
            parts.insert(number, request.body.clone());
            Answer::new(200).with("ETag", format!("\"part{number}\""))
        }
        _ => Answer::error(404, "NoSuchUpload"),
    }
}

fn complete(place: &mut Place, id: u64, request: &Request) -> Answer {
    let Some((key, parts)) = place.uploads.remove(&id) else { return Answer::error(404, "NoSuchUpload") };
    let named = String::from_utf8_lossy(&request.body).matches("<PartNumber>").count();
    let last = parts.len();
    if named != last || parts.values().take(last.saturating_sub(1)).any(|part| part.len() < 5 << 20) {
        return Answer::error(400, "InvalidPart");
    }
    let tag = insert(place, &key, parts.into_values().flatten().collect());
    let (start, end) = ("<CompleteMultipartUploadResult><ETag>", "</ETag></CompleteMultipartUploadResult>");
    Answer::new(200).saying(format!("{start}{}{end}", escaped(&tag)))
}

fn list(place: &Place, request: &Request) -> Answer {
    let bucket = request.path.trim_end_matches('/');
    let prefix = request.asked("prefix").unwrap_or_default();
    let after = request.asked("continuation-token").unwrap_or_default();
    let start = format!("{bucket}/");
    let keys = place.objects.iter().filter_map(|(key, object)| Some((key.strip_prefix(&start)?, object)));
    let (mut contents, mut folders, mut seen, mut last) = (String::new(), BTreeSet::new(), 0, None);
    for (key, object) in keys.filter(|(key, _)| key.starts_with(prefix) && *key > after) {
        if seen == PAGE {
            break;
        }
        last = Some(key);
        let rest = &key[prefix.len()..];
        match (request.asked("delimiter"), rest.find('/')) {
            (Some("/"), Some(end)) => {
                seen += usize::from(folders.insert(&key[..=prefix.len() + end]));
            }
            _ => {
                seen += 1;
                let _ = write!(
                    contents,
                    "<Contents><Key>{}</Key><Size>{}</Size><ETag>{}</ETag>\
                     <LastModified>2026-01-01T00:00:00.000Z</LastModified></Contents>",
                    escaped(key),
                    object.bytes.len(),
                    escaped(&tag(object))
                );
            }
        }
    }
    let more = last.filter(|_| seen == PAGE).map(|last| {
        format!(
            "<IsTruncated>true</IsTruncated><NextContinuationToken>{}</NextContinuationToken>",
            escaped(last)
        )
    });
    let folders = folders
        .iter()
        .map(|folder| format!("<CommonPrefixes><Prefix>{}</Prefix></CommonPrefixes>", escaped(folder)));
    let folders: String = folders.collect();
    let more = more.unwrap_or_default();
    Answer::new(200).saying(format!("<ListBucketResult>{contents}{folders}{more}</ListBucketResult>"))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
