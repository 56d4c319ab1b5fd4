//! From a URL and the usual environment to a bucket.

use std::net::{IpAddr, TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey};
use object_store::azure::{AzureConfigKey, MicrosoftAzureBuilder};
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::path::Path;
use object_store::{BackoffConfig, ClientOptions, ObjectStore, RetryConfig};

use super::bucket::Objects;
use super::failure::Access;
use super::profile::Profile;
use super::runtime::choose_encryption;
use super::service::patience;
use crate::StoreError;

/// A kind of service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    S3,
    Azure,
    Google,
}

/// A bucket, or a container of an account, and the folder of a store in it.
#[derive(Debug, PartialEq, Eq)]
struct Address {
    kind: Kind,
    bucket: String,
    folder: String,
}

impl Address {
    /// `rest` is what follows `scheme://`.
    fn parse(scheme: &str, rest: &str) -> Option<Result<Self, &'static str>> {
        let kind = match scheme {
            "s3" => Kind::S3,
            "az" => Kind::Azure,
            "gs" => Kind::Google,
            _ => return None,
        };
        let (bucket, folder) = rest.split_once('/').unwrap_or((rest, ""));
        let folder = folder.trim_end_matches('/');
        Some(if bucket.contains('@') || bucket.contains(':') {
            Err("holds a user, a key or a port: these come from the environment or a profile")
        } else if bucket.is_empty() {
            Err("names no bucket")
        } else if rest.contains(['?', '#']) {
            Err("holds `?` or `#`: what follows a bucket is the folder of the store alone")
        } else if Path::parse(folder).is_err() || folder.starts_with('/') {
            Err("names no folder: parts are empty, `.` or `..`")
        } else {
            Ok(Self { kind, bucket: bucket.to_owned(), folder: folder.to_owned() })
        })
    }
}

/// A URL for messages, without what may be a key: users, what follows `?`, a bucket with `:`.
pub(crate) fn without_secrets(scheme: &str, rest: &str) -> String {
    let rest = rest.split(['?', '#']).next().unwrap_or_default();
    let rest = rest.rsplit_once('@').map_or(rest, |(_, after)| after);
    match rest.split_once('/').unwrap_or((rest, "")) {
        (bucket, folder) if bucket.contains(':') => format!("{scheme}://.../{folder}"),
        _ => format!("{scheme}://{rest}"),
    }
}

/// The bucket that a URL names, or `None` for a URL of another kind.
///
/// # Errors
/// [`StoreError::Place`] for a URL that names none, [`StoreError::Refused`] without credentials.
pub(crate) fn open(scheme: &str, rest: &str) -> Option<Result<Objects, StoreError>> {
    let shown = without_secrets(scheme, rest);
    let place = |problem: &str| StoreError::Place { place: shown.clone(), problem: problem.to_owned() };
    let address = match Address::parse(scheme, rest)? {
        Ok(address) => address,
        Err(problem) => return Some(Err(place(problem))),
    };
    choose_encryption();
    let opened = match address.kind {
        Kind::S3 => s3(&address.bucket),
        Kind::Azure => azure(&address.bucket),
        Kind::Google => {
            tracing::warn!("gs:// was never tried against Google's service, nor an emulated one");
            google(&address.bucket)
        }
    };
    Some(match opened {
        Ok((service, access)) => {
            let name = format!("{scheme}://{}", address.bucket);
            let bucket = Objects::new(service, &name, &address.folder);
            Ok(bucket.reached_by(access))
        }
        Err(Unready { problem, credentials }) => {
            let problem = format!("{problem} ({credentials})");
            Err(StoreError::Refused { path: shown, action: "open", problem })
        }
    })
}

/// A service, and how it is reached.
type Opened = (Arc<dyn ObjectStore>, Access);

/// Why a service cannot be asked at all.
struct Unready {
    problem: String,
    /// Names of variables and files that were found or not, never their values.
    credentials: String,
}

fn retries() -> RetryConfig {
    RetryConfig {
        backoff: BackoffConfig {
            init_backoff: Duration::from_millis(100),
            max_backoff: Duration::from_secs(8),
            // Pauses are drawn between the least and this times the last one: with 2 they hardly grow.
            base: 3.0,
        },
        // Time alone ends them.
        max_retries: usize::MAX,
        retry_timeout: patience(),
    }
}

fn client() -> ClientOptions {
    ClientOptions::new().with_timeout(Duration::from_mins(1)).with_connect_timeout(Duration::from_secs(5))
}

/// Names of the variables with some prefixes that are set, for messages.
fn variables(prefixes: &[&str]) -> Vec<String> {
    let names = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let mut found: Vec<_> =
        names.filter(|name| prefixes.iter().any(|prefix| name.starts_with(prefix))).collect();
    found.sort_unstable();
    found
}

/// What was found of variables and profiles, and which of the usual variables are not set.
fn listed(found: &[String], usual: &[&str]) -> String {
    let missing: Vec<&str> =
        usual.iter().copied().filter(|name| !found.iter().any(|found| found == name)).collect();
    let list = |word: &str, names: String| (!names.is_empty()).then(|| format!("{word}: {names}"));
    let parts = [list("found", found.join(", ")), list("not set", missing.join(", "))];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// An endpoint for messages, without a user or a key in it.
fn endpoint_shown(url: &str) -> String {
    let url = url.split(['?', '#']).next().unwrap_or_default();
    let Some((scheme, rest)) = url.split_once("://") else { return url.to_owned() };
    format!("{scheme}://{}", rest.rsplit_once('@').map_or(rest, |(_, after)| after))
}

/// Whether what goes to an endpoint is guarded on its way: by TLS, or since it stays on this machine.
fn is_guarded(url: &str) -> bool {
    let Ok(url) = reqwest::Url::parse(url) else { return false };
    let host = url.host_str().unwrap_or_default().trim_matches(['[', ']']);
    url.scheme() == "https" || host == "localhost" || host.parse().is_ok_and(|ip: IpAddr| ip.is_loopback())
}

/// Whether this machine has a service that hands out the credentials of its role.
fn has_instance_role(host: &str) -> bool {
    if std::env::var("AWS_EC2_METADATA_DISABLED").is_ok_and(|value| value == "true") {
        return false;
    }
    let address = (host, 80).to_socket_addrs().ok().and_then(|mut found| found.next());
    address.is_some_and(|address| TcpStream::connect_timeout(&address, Duration::from_secs(1)).is_ok())
}

fn s3(bucket: &str) -> Result<Opened, Unready> {
    let mut looked_at = variables(&["AWS_"]);
    let mut builder = AmazonS3Builder::new().with_client_options(client());
    let mut given = Vec::new();
    // Others' variables may be no UTF-8.
    for (name, value) in std::env::vars_os() {
        if let (Some(name), Some(value)) = (name.to_str(), value.to_str())
            && name.starts_with("AWS_")
            && let Ok(key) = name.to_ascii_lowercase().parse::<AmazonS3ConfigKey>()
        {
            given.push(key);
            builder = builder.with_config(key, value);
        }
    }
    // Variables go before a profile, as with the service's own tools.
    let keys = ["AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"];
    let unready =
        |problem: String, looked_at: &[String]| Unready { problem, credentials: listed(looked_at, &keys) };
    let profile = Profile::read().map_err(|problem| unready(problem, &looked_at))?;
    if let Some(profile) = &profile {
        looked_at.push(format!("profile `{}` of {}", profile.name, profile.files.join(" and ")));
    }
    let mut has_keys = given.contains(&AmazonS3ConfigKey::AccessKeyId);
    let settings = profile.iter().flat_map(|profile| &profile.settings);
    for (key, value) in settings.filter(|(key, _)| !(has_keys && Profile::is_key(*key))) {
        if !given.contains(key) {
            builder = builder.with_config(*key, value);
        }
    }
    has_keys |= profile.is_some_and(|profile| profile.has_keys());
    let others = [
        AmazonS3ConfigKey::WebIdentityTokenFile,
        AmazonS3ConfigKey::ContainerCredentialsRelativeUri,
        AmazonS3ConfigKey::ContainerCredentialsFullUri,
        AmazonS3ConfigKey::MetadataEndpoint,
        AmazonS3ConfigKey::SkipSignature,
    ];
    let mut usual: &[&str] = &[];
    if !has_keys && !others.iter().any(|key| given.contains(key)) {
        if !has_instance_role("169.254.169.254") {
            return Err(unready("there are no credentials".into(), &looked_at));
        }
        usual = &keys;
        looked_at.push(
            "no key, so this machine's role was asked (AWS_EC2_METADATA_DISABLED=true leaves it out)".into(),
        );
    }
    // The one for S3 goes before the one for all services.
    let endpoint = [AmazonS3ConfigKey::S3Endpoint, AmazonS3ConfigKey::Endpoint]
        .iter()
        .find_map(|key| builder.get_config_value(key));
    // Servers of one's own need not speak TLS.
    if endpoint.as_ref().is_some_and(|url| url.starts_with("http://")) {
        builder = builder.with_allow_http(true);
    }
    // What is sent need not be hashed for its signature, too, where nobody can change it on the way.
    if !given.contains(&AmazonS3ConfigKey::UnsignedPayload) {
        builder = builder.with_unsigned_payload(endpoint.as_deref().is_none_or(is_guarded));
    }
    // Objects are removed one by one: not every server can do several at once.
    let builder = builder.with_bucket_name(bucket).with_retry(retries()).with_disable_bulk_delete(true);
    match builder.build() {
        Ok(service) => {
            let endpoint = endpoint.map(|url| endpoint_shown(&url));
            Ok((Arc::new(service), Access { endpoint, credentials: listed(&looked_at, usual) }))
        }
        Err(e) => Err(unready(e.to_string(), &looked_at)),
    }
}

fn azure(container: &str) -> Result<Opened, Unready> {
    let usual = ["AZURE_STORAGE_ACCOUNT_NAME", "AZURE_STORAGE_ACCOUNT_KEY"];
    let credentials = listed(&variables(&["AZURE_"]), &usual);
    let mut builder = MicrosoftAzureBuilder::from_env().with_client_options(client());
    let given = |key: AzureConfigKey| builder.get_config_value(&key);
    let is_emulated = given(AzureConfigKey::UseEmulator).is_some_and(|value: String| value == "true");
    let keys = [
        AzureConfigKey::AccessKey,
        AzureConfigKey::SasKey,
        AzureConfigKey::Token,
        AzureConfigKey::ClientId,
        AzureConfigKey::FederatedTokenFile,
        AzureConfigKey::MsiEndpoint,
    ];
    let is_open = given(AzureConfigKey::SkipSignature).is_some_and(|value: String| value == "true");
    if !is_emulated && !is_open && keys.into_iter().all(|key| given(key).is_none()) {
        let has_account = given(AzureConfigKey::AccountName).is_some();
        if !has_account || !has_instance_role("169.254.169.254") {
            return Err(Unready { problem: "there are no credentials".into(), credentials });
        }
    }
    let endpoint = given(AzureConfigKey::Endpoint);
    if is_emulated || endpoint.as_ref().is_some_and(|url| url.starts_with("http://")) {
        builder = builder.with_allow_http(true);
    }
    let built = builder.with_container_name(container).with_retry(retries()).build();
    match built {
        Ok(service) => {
            let endpoint = endpoint.map(|url| endpoint_shown(&url));
            Ok((Arc::new(service), Access { endpoint, credentials }))
        }
        Err(e) => Err(Unready { problem: e.to_string(), credentials }),
    }
}

fn google(bucket: &str) -> Result<Opened, Unready> {
    let credentials = listed(&variables(&["GOOGLE_"]), &["GOOGLE_APPLICATION_CREDENTIALS"]);
    let built = GoogleCloudStorageBuilder::from_env()
        .with_client_options(client())
        .with_bucket_name(bucket)
        .with_retry(retries())
        .build();
    match built {
        Ok(service) => Ok((Arc::new(service), Access { endpoint: None, credentials })),
        Err(e) => Err(Unready { problem: e.to_string(), credentials }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_name_buckets_and_folders() {
        for (scheme, rest, bucket, folder) in [
            ("s3", "set", "set", ""),
            ("s3", "set/", "set", ""),
            ("az", "set/a/b c/", "set", "a/b c"),
            ("gs", "set.one/x", "set.one", "x"),
        ] {
            let address = Address::parse(scheme, rest).expect("is a bucket").expect(rest);
            assert_eq!((address.bucket.as_str(), address.folder.as_str()), (bucket, folder));
        }
        assert_eq!(Address::parse("ftp", "a/b"), None);
        for (rest, problem) in [
            ("", "names no bucket"),
            ("/a", "names no bucket"),
            ("key:secret@set/a", "environment"),
            ("localhost:9000/a", "environment"),
            ("set/a//b", "names no folder"),
            ("set//a", "names no folder"),
            ("set/../a", "names no folder"),
            ("set/a?versionId=1", "`?`"),
        ] {
            let said = Address::parse("s3", rest).expect("is a bucket").expect_err(rest);
            assert!(said.contains(problem), "{rest}: {said}");
        }
    }

    #[test]
    fn payloads_are_signed_where_others_could_change_them() {
        for url in
            ["https://minio.lab:9000", "http://localhost:9000", "http://127.0.0.1:9000", "http://[::1]"]
        {
            assert!(is_guarded(url), "{url}");
        }
        for url in ["http://minio.lab:9000", "http://10.0.0.1", "http://localhost.lab", "minio.lab"] {
            assert!(!is_guarded(url), "{url}");
        }
    }

    #[test]
    fn keys_in_urls_are_not_repeated() {
        for (rest, shown) in [
            ("AKIAEXAMPLE:secret@set/a", "`s3://set/a`"),
            ("AKIAEXAMPLE:se/cret@set/a", "`s3://set/a`"),
            ("AKIAEXAMPLE:secret/a", "`s3://.../a`"),
            ("AKIAEXAMPLE:se?cret@set/a", "`s3://.../`"),
            ("set/a?X-Amz-Credential=AKIAEXAMPLE&X-Amz-Signature=secret", "`s3://set/a`"),
        ] {
            let refused = open("s3", rest).expect("is a bucket");
            let text = refused.expect_err("is refused").to_string();
            let tells = ["se?", "secret", "cret@", "AKIA"].iter().any(|secret| text.contains(secret));
            assert!(text.contains(shown) && !tells, "{text}");
        }
    }
}
