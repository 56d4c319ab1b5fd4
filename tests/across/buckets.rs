//! Stores in a bucket: the bytes of the disk's, whatever goes wrong on the way, and errors that say what it
//! was.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::os::unix::ffi::OsStrExt;
use std::process::{Command, Stdio};

use convoy_tests::{Bench, LEAN, Outcome, TINY, program};
use testkit::bucket::{BucketServer, Wrong};

const URL: &str = "s3://sets/one";
const FOLDER: &str = "sets/one";

/// A program that uses a server's bucket, and finds no other credentials on this machine.
fn command(server: &BucketServer, bench: &Bench, words: &[&str]) -> Command {
    let mut command = Command::new(program("convoy"));
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.as_bytes().starts_with(b"AWS_")) {
        command.env_remove(name);
    }
    command.args(words).envs(server.environment()).env("HOME", bench.folder.path());
    command
}

fn convoy(server: &BucketServer, bench: &Bench, words: &[&str]) -> Outcome {
    Outcome::of(&command(server, bench, words).output().expect("the program starts"))
}

fn run(server: &BucketServer, bench: &Bench) -> Outcome {
    let config = bench.config().display().to_string();
    convoy(server, bench, &["run", "--config", &config, "--store", URL, "--progress", "none"])
}

/// The bucket's objects, by digest.
fn digests(server: &BucketServer) -> BTreeMap<String, String> {
    let objects = server.objects(FOLDER).into_iter();
    objects.map(|(key, bytes)| (key, store::hash_bytes(&bytes))).collect()
}

/// What a disk has.
fn on_disk(config: &str) -> Bench {
    let bench = Bench::new(config);
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    bench
}

#[test]
fn a_dataset_in_a_bucket_has_the_bytes_of_the_disk() {
    let (bench, server) = (on_disk(TINY), BucketServer::start());
    run(&server, &bench).expect_done();
    assert_eq!(digests(&server), bench.digests());
    assert_eq!(server.uploads(), 0);
    let status = convoy(&server, &bench, &["status", "--store", URL]);
    assert!(status.code == 0 && status.stdout.contains("render-sensors"), "{status:?}");
    let verified = convoy(&server, &bench, &["verify", "--store", URL]);
    verified.expect_done();
    assert!(verified.stdout.contains("let a rule of the bucket end it"), "{}", verified.stdout);

    // With nothing to do it looks and goes.
    drop(server.requests());
    run(&server, &bench).expect_done();
    let asked = server.requests();
    assert!(asked.get("GET").is_some_and(|gets| *gets < 150), "{asked:?}");
    assert_eq!(digests(&server), bench.digests());

    // And back to a disk, by scene.
    let copy = Bench::new(TINY);
    let place = copy.store().display().to_string();
    convoy(&server, &bench, &["merge", "--scenes", "0", "--store", &place, URL]).expect_done();
    copy.run("convoy", &["run", "--progress", "none"]).expect_done();
    assert_eq!(copy.digests(), bench.digests());
}

/// An answer of the viewer's server: its head and body.
fn ask(address: &str, target: &str, headers: &str) -> (String, Vec<u8>) {
    let host = address.trim_start_matches("http://").trim_end_matches('/');
    let mut stream = TcpStream::connect(host).expect("it listens");
    let request = format!("GET {target} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{headers}\r\n");
    stream.write_all(request.as_bytes()).expect("is sent");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("it answers");
    let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("the head ends");
    (String::from_utf8_lossy(&answer[..end]).into_owned(), answer.split_off(end + 4))
}

#[test]
fn a_store_in_a_bucket_is_shown_as_one_on_a_disk() {
    let (bench, server) = (on_disk(LEAN), BucketServer::start());
    let place = bench.store().display().to_string();
    convoy(&server, &bench, &["merge", "--store", URL, &place]).expect_done();
    // Excerpts hold what the page would fetch.
    let excerpt = |store: &str, name: &str| {
        let file = bench.folder.path().join(name);
        let words =
            ["view", store, "--embed", file.to_str().expect("is UTF-8"), "--scene", "0", "--frames", "3..8"];
        convoy(&server, &bench, &words).expect_done();
        std::fs::read(file).expect("is written")
    };
    assert!(excerpt(URL, "bucket.html") == excerpt(&place, "disk.html"));

    let mut view = command(&server, &bench, &["view", URL, "--no-open"]);
    let mut view = view.stdout(Stdio::piped()).spawn().expect("it starts");
    let mut line = String::new();
    BufReader::new(view.stdout.take().expect("is piped")).read_line(&mut line).expect("it says where it is");
    let address = line.split_whitespace().find(|word| word.starts_with("http://")).expect("names an address");
    let (_, index) = ask(address, "/api/store.json", "");
    let index: serde_json::Value = serde_json::from_slice(&index).expect("is JSON");
    assert_eq!(index["scenes"][0]["missing"], serde_json::json!([]), "{index}");
    let key = "scenes/0000/sensors/vehicle_0/LIDAR.parquet";
    let bytes = std::fs::read(bench.store().join(key)).expect("is read");
    let (head, part) = ask(address, &format!("/store/{key}"), "Range: bytes=100-299\r\n");
    assert!(head.starts_with("HTTP/1.1 206") && part == bytes[100..300], "{head}");
    assert!(ask(address, &format!("/store/{key}"), "").1 == bytes);
    for nothing in ["/store/scenes/none.parquet", "/store/../other/dataset.json"] {
        assert!(ask(address, nothing, "").0.starts_with("HTTP/1.1 404"), "{nothing}");
    }
    view.kill().expect("is ended");
    view.wait().expect("ends");
}

#[test]
fn whatever_goes_wrong_with_requests_the_bytes_are_the_same() {
    let (bench, server) = (on_disk(LEAN), BucketServer::start());
    // By the number of the request alone.
    server.fail(|number, _| {
        let draw = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        (draw % 8 == 0).then_some(match (draw / 8) % 6 {
            0 => Wrong::Refused(503),
            1 => Wrong::AnswerLost,
            2 => Wrong::Reset,
            3 => Wrong::Truncated,
            4 => Wrong::Twice,
            _ => Wrong::Late(std::time::Duration::from_millis(30)),
        })
    });
    let mut tries = 0;
    loop {
        let outcome = run(&server, &bench);
        tries += 1;
        match outcome.code {
            0 => break,
            // Nobody is to blame.
            75 if tries < 20 => {}
            _ => panic!("{tries}: {outcome:?}"),
        }
    }
    server.mend();
    assert_eq!(digests(&server), bench.digests());
    let verified = convoy(&server, &bench, &["verify", "--store", URL]);
    verified.expect_done();
}

#[test]
fn damage_in_a_bucket_is_named() {
    let (bench, server) = (Bench::new(LEAN), BucketServer::start());
    run(&server, &bench).expect_done();
    let objects = server.objects(FOLDER);
    let shards: Vec<_> =
        objects.iter().filter(|(key, bytes)| !key.contains("_manifest") && !bytes.is_empty()).collect();
    let mut planted = Vec::new();
    for (i, (key, bytes)) in shards.into_iter().enumerate() {
        let place = format!("{FOLDER}/{key}");
        match i % 3 {
            0 => {
                let mut other = bytes.clone();
                other[bytes.len() / 2] ^= 4;
                server.damage(&place, Some(other));
            }
            1 => server.damage(&place, Some(bytes[..bytes.len() / 2].to_vec())),
            _ => server.damage(&place, None),
        }
        planted.push(key);
    }
    let verified = convoy(&server, &bench, &["verify", "--store", URL]);
    assert_eq!(verified.code, 1, "{verified:?}");
    for key in planted {
        assert!(verified.stdout.contains(key.as_str()), "{key}\n{}", verified.stdout);
    }
}

/// What programs say of a place that cannot be had, and how they end.
#[test]
fn a_bucket_that_cannot_be_had_is_told_in_a_line() {
    let (bench, server) = (Bench::new(LEAN), BucketServer::start());
    let mut said = String::new();
    let mut tell = |what: &str, outcome: &Outcome| {
        let text = outcome.stderr.replace(&server.endpoint(), "ENDPOINT");
        let text = text.replace(&bench.folder.path().display().to_string(), "HOME");
        said.push_str(&format!("# {what}: {}\n{}", outcome.code, text));
    };
    for url in [
        "s3://",
        "s3://AKIAEXAMPLE:secret@sets/one",
        "s3://AKIAEXAMPLE:secret/one",
        "gcs://sets/one",
        "s3://sets/../one",
    ] {
        tell(url, &convoy(&server, &bench, &["verify", "--store", url]));
    }
    let verify = || command(&server, &bench, &["verify", "--store", URL]);
    let mut of = |what: &str, command: &mut Command| {
        tell(what, &Outcome::of(&command.output().expect("the program starts")));
    };
    let unset = |command: &mut Command| {
        command.env_remove("AWS_ACCESS_KEY_ID").env_remove("AWS_SECRET_ACCESS_KEY");
        command.env("AWS_EC2_METADATA_DISABLED", "true").env_remove("AWS_ENDPOINT_URL");
        command.env_remove("AWS_REGION");
    };
    let mut without = verify();
    unset(&mut without);
    of("no credentials", &mut without);
    // Whatever others keep in the environment.
    without.env("AWS_OF_OTHERS", std::ffi::OsStr::from_bytes(b"\xff"));
    of("no such profile", without.env("AWS_PROFILE", "lab"));
    of("nobody there", verify().env("AWS_ENDPOINT_URL", "http://127.0.0.1:1").env("CONVOY_RETRY_S", "1"));
    for (what, status) in [("no rights", 403), ("no such bucket", 404), ("out of order", 500)] {
        server.fail(move |_, _| Some(Wrong::Refused(status)));
        of(what, verify().env("CONVOY_RETRY_S", "1"));
    }
    insta::assert_snapshot!("buckets-that-cannot-be-had", said);
}

#[test]
fn a_service_that_ignores_conditions_is_refused() {
    let (bench, server) = (Bench::new(LEAN), BucketServer::start());
    // Whatever is put on a condition is put anyway.
    server.ignore_conditions();
    let outcome = run(&server, &bench);
    assert_eq!(outcome.code, 2, "{outcome:?}");
    assert!(outcome.stderr.contains("both succeed"), "{}", outcome.stderr);
    assert!(server.objects(FOLDER).is_empty());
}
