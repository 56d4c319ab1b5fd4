//! What a service answers when it does not do as asked, told without anything secret.

use std::error::Error;
use std::io;

use object_store::Error as Answer;
use object_store::client::{HttpError, HttpErrorKind};

use crate::StoreError;

/// Why a request failed.
#[derive(Debug)]
pub(super) enum Failure {
    /// The service cannot be reached, is overloaded or out of order: another try may succeed.
    Away(io::Error),
    /// There is no such object.
    Absent,
    /// There is an object where there should be none, or another one than was expected; some services also
    /// answer so when two ask at once.
    Conflict,
    /// It will not be done: for want of rights, or because it cannot be.
    Refused(String),
}

/// How a service is reached and who is let in, for messages: names, never values.
#[derive(Debug)]
pub(crate) struct Access {
    /// Where variables or a profile say that the service is.
    pub(crate) endpoint: Option<String>,
    /// What was found that lets somebody in.
    pub(crate) credentials: String,
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Away(error)
    }
}

impl From<Answer> for Failure {
    fn from(answer: Answer) -> Self {
        let told = told(&answer);
        // A bucket that is not there is no object that is not there.
        if told.contains("NoSuchBucket") || told.contains("ContainerNotFound") {
            return Self::Refused(told);
        }
        // What runs out in mid-run is fetched anew by the next try.
        if ["ExpiredToken", "RequestTimeTooSkewed", "SlowDown"].iter().any(|code| told.contains(code)) {
            return Self::Away(io::Error::new(io::ErrorKind::NotConnected, told));
        }
        match answer {
            Answer::NotFound { .. } => Self::Absent,
            Answer::AlreadyExists { .. } | Answer::Precondition { .. } => Self::Conflict,
            Answer::Generic { ref source, .. } if is_final(source.as_ref()) => Self::Refused(told),
            Answer::Generic { ref source, .. } => Self::Away(io::Error::new(kind_of(source.as_ref()), told)),
            Answer::JoinError { .. } => Self::Away(io::Error::other(told)),
            _ => Self::Refused(told),
        }
    }
}

impl Failure {
    /// As an error of reading or writing `location` of a service.
    pub(super) fn into_store(
        self,
        location: String,
        action: &'static str,
        writes: bool,
        access: &Access,
    ) -> StoreError {
        let at_endpoint = |source: io::Error| match &access.endpoint {
            Some(endpoint) => io::Error::new(source.kind(), format!("{endpoint}: {source}")),
            None => source,
        };
        match self {
            Self::Away(source) if writes => StoreError::write(location, action, at_endpoint(source)),
            Self::Away(source) => StoreError::Read { path: location, action, source: at_endpoint(source) },
            Self::Absent => StoreError::Missing { path: location },
            Self::Conflict => StoreError::Contested { path: location },
            Self::Refused(told) => {
                let problem = format!("the service refuses: {told} ({})", access.credentials);
                StoreError::Refused { path: location, action, problem }
            }
        }
    }

    /// As an error of a stream. Nothing in mid-stream is the fault of what is streamed.
    pub(super) fn into_io(self) -> io::Error {
        match self {
            Self::Away(error) => error,
            Self::Absent => io::ErrorKind::NotFound.into(),
            Self::Conflict => io::Error::other("another object is there now"),
            Self::Refused(problem) => io::Error::new(io::ErrorKind::NotConnected, problem),
        }
    }
}

/// All causes, outermost first.
fn causes<'e>(error: &'e (dyn Error + 'static)) -> impl Iterator<Item = &'e (dyn Error + 'static)> {
    std::iter::successors(Some(error), |&error| error.source())
}

/// Whether the service answered, and would answer the same again: 4xx without those that ask to come back.
fn is_final(error: &(dyn Error + 'static)) -> bool {
    let text = causes(error).map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let status = text.split("status code: ").nth(1).and_then(|rest| rest.get(..3)?.parse::<u16>().ok());
    status.is_some_and(|status| (300..500).contains(&status) && ![408, 425, 429].contains(&status))
        || text.contains("incorrectly configured region")
}

fn kind_of(error: &(dyn Error + 'static)) -> io::ErrorKind {
    let http = causes(error).find_map(|cause| cause.downcast_ref::<HttpError>());
    match http.map(HttpError::kind) {
        Some(HttpErrorKind::Timeout) => io::ErrorKind::TimedOut,
        _ => io::ErrorKind::NotConnected,
    }
}

/// What a service said, in short. Whole answers are not repeated: that to a wrong signature tells the name of
/// the key and what was signed.
fn told(answer: &Answer) -> String {
    let chain: Vec<String> = causes(answer).map(ToString::to_string).collect();
    let whole = chain.join(": ");
    let field = |name: &str| {
        let (_, rest) = whole.split_once(&format!("<{name}>"))?;
        Some(rest.split_once('<')?.0.trim().to_owned())
    };
    match (field("Code"), field("Message")) {
        (Some(code), _) if code == "SignatureDoesNotMatch" => {
            format!("{code}: the secret does not fit the key")
        }
        (Some(code), message) => {
            let message = message.unwrap_or_default();
            let first = message.lines().next().filter(|line| !line.is_empty());
            let no_bucket = ["NoSuchBucket", "ContainerNotFound"].contains(&code.as_str());
            let cure = no_bucket.then_some("make the bucket first, it is not made by itself");
            [Some(code.as_str()), first, cure].into_iter().flatten().collect::<Vec<_>>().join(": ")
        }
        // The innermost cause says most; a body that is no XML is left out.
        _ => {
            let last = chain.iter().rev().find(|text| !text.is_empty()).map_or("", String::as_str);
            last.lines().next().unwrap_or_default().split(" body: ").next().unwrap_or_default().to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn generic(text: &str) -> Failure {
        Answer::Generic { store: "S3", source: text.into() }.into()
    }

    #[test]
    fn answers_are_told_in_short_and_without_secrets() {
        let body = "Server returned non-2xx status code: 403 Forbidden: <Error><Code>SignatureDoesNotMatch\
            </Code><Message>The request signature</Message><AWSAccessKeyId>AKIAEXAMPLE</AWSAccessKeyId></Error>";
        let Failure::Refused(told) = generic(body) else { panic!("is refused") };
        assert_eq!(told, "SignatureDoesNotMatch: the secret does not fit the key");
        let body = "Server returned non-2xx status code: 404 Not Found: <Error><Code>NoSuchBucket</Code>\
            <Message>The specified bucket does not exist</Message></Error>";
        let answer = Answer::NotFound { path: "a".into(), source: body.into() };
        let Failure::Refused(told) = answer.into() else { panic!("is refused") };
        let cure = "make the bucket first, it is not made by itself";
        assert_eq!(told, format!("NoSuchBucket: The specified bucket does not exist: {cure}"));
        let access = Access { endpoint: Some("http://127.0.0.1:9000".into()), credentials: String::new() };
        let refused = io::Error::new(io::ErrorKind::ConnectionRefused, "Connection refused");
        let error = Failure::Away(refused).into_store("s3://set/a".into(), "read", false, &access);
        let StoreError::Read { source, .. } = error else { panic!("is read") };
        assert_eq!(source.to_string(), "http://127.0.0.1:9000: Connection refused");
    }

    #[test]
    fn who_is_overloaded_is_asked_again_later() {
        for body in [
            "Server returned non-2xx status code: 503 Service Unavailable: <Code>SlowDown</Code>",
            "Server returned non-2xx status code: 429 Too Many Requests: ",
            "Server returned non-2xx status code: 400 Bad Request: <Code>ExpiredToken</Code>",
            "error sending request",
        ] {
            assert!(matches!(generic(body), Failure::Away(_)), "{body}");
        }
        assert!(matches!(
            generic("Server returned non-2xx status code: 400 Bad Request: "),
            Failure::Refused(_)
        ));
        let answer = Answer::NotFound { path: "a".into(), source: "nothing".into() };
        assert!(matches!(answer.into(), Failure::Absent));
    }
}
