//! The server over real connections.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use store::Manifest;
use tempfile::TempDir;

/// A running program over a small folder.
struct Served {
    _folder: TempDir,
    child: Child,
    port: u16,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A store as far as the server looks into it.
fn store(folder: &Path) {
    let scene = folder.join("store/scenes/0003");
    fs::create_dir_all(scene.join("log")).expect("is made");
    fs::create_dir_all(scene.join("_manifests")).expect("is made");
    fs::create_dir_all(scene.join("sensors/vehicle_0")).expect("is made");
    fs::create_dir_all(folder.join("store/maps/convoy")).expect("is made");
    let write =
        |path: &str, text: &str| fs::write(folder.join("store").join(path), text).expect("is written");
    write("dataset.json", r#"{"config": {"name": "small"}}"#);
    write(
        "scenes/0003/log/scene.json",
        r#"{"scene": 3, "split": "val", "map": "convoy/demo", "frames": 4, "agents": [{"agent": "vehicle_0"}]}"#,
    );
    write("scenes/0003/_manifests/simulate-and-log.json", "{}");
    write("scenes/0003/sensors/vehicle_0/LIDAR.parquet", "0123456789");
    write("scenes/0003/sensors/vehicle_0/.render~x.tmp", "unfinished");
    write("maps/convoy/demo.vector.parquet", "seven..");
    fs::write(folder.join("secret"), "secret").expect("is written");
}

fn serve() -> Served {
    let folder = tempfile::tempdir().expect("a temporary folder");
    store(folder.path());
    let mut child = Command::new(env!("CARGO_BIN_EXE_view"))
        .arg(folder.path().join("store"))
        .arg("--no-open")
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("is piped")).read_line(&mut line).expect("it says where it is");
    let port = line.split("http://127.0.0.1:").nth(1).and_then(|rest| rest.split('/').next());
    let port = port.and_then(|p| p.parse().ok()).unwrap_or_else(|| panic!("no address in {line}"));
    Served { _folder: folder, child, port }
}

impl Served {
    /// Sends bytes as they are; gives the answer's status, head and body.
    fn send(&self, text: &str) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.write_all(text.as_bytes()).expect("is sent");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("it answers and closes");
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n").expect("the head ends");
        let head = String::from_utf8(answer[..end].to_vec()).expect("is text");
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("has a status");
        (status, head, answer[end + 4..].to_vec())
    }

    fn ask(&self, method: &str, target: &str, headers: &str) -> (u16, String, Vec<u8>) {
        let host = format!("Host: 127.0.0.1:{}", self.port);
        self.send(&format!("{method} {target} HTTP/1.1\r\n{host}\r\nConnection: close\r\n{headers}\r\n"))
    }

    fn get(&self, target: &str) -> (u16, Vec<u8>) {
        let (status, _, body) = self.ask("GET", target, "");
        (status, body)
    }
}

const LIDAR: &str = "/store/scenes/0003/sensors/vehicle_0/LIDAR.parquet";

#[test]
fn the_page_and_its_lists_are_served() {
    let served = serve();
    let (status, head, body) = served.ask("GET", "/", "");
    assert_eq!(status, 200);
    assert!(
        head.contains("Content-Security-Policy: default-src 'none'") && head.contains("nosniff"),
        "{head}"
    );
    assert!(String::from_utf8_lossy(&body).contains("app.js"));
    for (target, word) in [("/app.js", "WebGL"), ("/worker.js", "postMessage"), ("/style.css", "body")] {
        let (status, body) = served.get(target);
        assert_eq!(status, 200, "{target}");
        assert!(String::from_utf8_lossy(&body).contains(word), "{target}");
    }
    let json = |target: &str| -> serde_json::Value {
        let (status, body) = served.get(target);
        assert_eq!(status, 200, "{target}");
        serde_json::from_slice(&body).expect("is JSON")
    };
    let names = json("/api/names.json");
    assert_eq!(names["tags"][14], serde_json::json!({"name": "car", "rgb": [0, 0, 142]}));
    assert_eq!(names["frame_period_s"], 0.05);
    let index = json("/api/store.json");
    assert_eq!(index["name"], "small");
    assert_eq!(index["scenes"][0]["folder"], "0003");
    let missing = ["render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];
    assert_eq!(index["scenes"][0]["missing"], serde_json::json!(missing));
    let scene = json("/api/scenes/0003.json");
    assert_eq!(scene["info"]["frames"], 4);
    assert_eq!(scene["map_bytes"], 7);
    let files = ["_manifests/simulate-and-log.json", "log/scene.json", "sensors/vehicle_0/LIDAR.parquet"];
    let listed: Vec<&str> =
        scene["files"].as_array().expect("is a list").iter().filter_map(|f| f[0].as_str()).collect();
    assert_eq!(listed, files);
    assert_eq!(scene["files"][2][1], 10);
    assert!(index["predictions"].is_null());
    let (status, body) = served.get("/api/predictions/0003.json");
    assert_eq!(status, 404);
    assert!(String::from_utf8_lossy(&body).contains("start with --predictions FILE"), "{body:?}");
}

/// What was made from another log than the one that is there is named, what was made from it is not.
#[test]
fn stages_of_another_log_are_named() {
    let served = serve();
    let folder = served._folder.path().join("store/scenes/0003/_manifests");
    let manifest = |stage: &str, inputs: serde_json::Value| {
        serde_json::json!({
            "format_version": 1, "stage": stage, "code_version": "1", "config_hash": "0", "generation": 0,
            "inputs": inputs, "outputs": [],
        })
    };
    let write = |stage: &str, inputs: serde_json::Value| {
        let text = manifest(stage, inputs).to_string();
        fs::write(folder.join(format!("{stage}.json")), text).expect("is written");
    };
    let log: Manifest =
        serde_json::from_value(manifest("simulate-and-log", serde_json::json!({}))).expect("is a manifest");
    write("simulate-and-log", serde_json::json!({}));
    write("bev-gt", serde_json::json!({ "simulate-and-log": "another" }));
    write("render-sensors", serde_json::json!({ "simulate-and-log": log.digest() }));
    let (status, body) = served.get("/api/scenes/0003.json");
    let scene: serde_json::Value = serde_json::from_slice(&body).expect("is JSON");
    assert_eq!((status, &scene["stale"]), (200, &serde_json::json!(["bev-gt"])));
}

#[test]
fn files_come_whole_and_in_parts() {
    let served = serve();
    assert_eq!(served.get(LIDAR), (200, b"0123456789".to_vec()));
    let part = |range: &str| served.ask("GET", LIDAR, &format!("Range: {range}\r\n"));
    let (status, head, body) = part("bytes=2-4");
    assert_eq!((status, body.as_slice()), (206, b"234".as_slice()));
    assert!(head.contains("Content-Range: bytes 2-4/10") && head.contains("Content-Length: 3"), "{head}");
    assert_eq!(part("bytes=7-").2, b"789");
    assert_eq!(part("bytes=-2").2, b"89");
    let (status, head, _) = part("bytes=10-12");
    assert_eq!(status, 416);
    assert!(head.contains("Content-Range: bytes */10"), "{head}");
    let (status, head, body) = served.ask("HEAD", LIDAR, "Range: bytes=2-4\r\n");
    assert_eq!((status, body.len()), (206, 0));
    assert!(head.contains("Content-Length: 3"), "{head}");
}

#[test]
fn a_connection_serves_several_requests() {
    let served = serve();
    let host = format!("Host: localhost:{}", served.port);
    let first = format!("GET {LIDAR} HTTP/1.1\r\n{host}\r\nRange: bytes=0-1\r\n\r\n");
    let second = format!("GET {LIDAR} HTTP/1.1\r\n{host}\r\nRange: bytes=8-9\r\nConnection: close\r\n\r\n");
    let (status, _, rest) = served.send(&format!("{first}{second}"));
    let rest = String::from_utf8(rest).expect("is text");
    assert_eq!(status, 206);
    assert!(rest.starts_with("01HTTP/1.1 206") && rest.ends_with("\r\n\r\n89"), "{rest}");
}

#[test]
fn what_lies_outside_is_not_there() {
    let served = serve();
    let outside = [
        "/store/../secret",
        "/store/%2e%2e/secret",
        "/store/%2e%2e%2fsecret",
        "/store/..%2fsecret",
        "/store/%252e%252e/secret",
        "/store/..%5csecret",
        "/store//etc/passwd",
        "/store/%2fetc%2fpasswd",
        "/store/scenes",
        "/store/",
        "/store",
        "/secret",
        "/store/scenes/0003/sensors/vehicle_0/.render~x.tmp",
        "/store/dataset.json%00",
        "/api/scenes/0004.json",
        "/api/scenes/../../secret.json",
        "/api/scenes/.json",
        "/nothing",
    ];
    for target in outside {
        assert_eq!(served.get(target).0, 404, "{target}");
    }
    #[cfg(unix)]
    {
        let root = served._folder.path().join("store");
        std::os::unix::fs::symlink("../secret", root.join("link")).expect("is linked");
        assert_eq!(served.get("/store/link").0, 404);
        std::os::unix::fs::symlink("dataset.json", root.join("within")).expect("is linked");
        assert_eq!(served.get("/store/within").0, 200);
    }
}

#[test]
fn other_methods_hosts_and_forms_are_refused() {
    let served = serve();
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT", "get"] {
        let (status, head, _) = served.ask(method, "/", "");
        assert_eq!(status, 405, "{method}");
        assert!(head.contains("Allow: GET, HEAD"), "{head}");
    }
    let port = served.port;
    let with_host = |host: &str| served.send(&format!("GET / HTTP/1.1\r\n{host}Connection: close\r\n\r\n")).0;
    assert_eq!(with_host(&format!("Host: LOCALHOST:{port}\r\n")), 200);
    let foreign = [
        String::new(),
        "Host: evil.example\r\n".into(),
        format!("Host: evil.example:{port}\r\n"),
        "Host: 127.0.0.1\r\n".into(),
        format!("Host: 127.0.0.1.evil.example:{port}\r\n"),
        format!("Host: 127.0.0.1:{}\r\n", port ^ 1),
    ];
    for host in foreign {
        assert_eq!(with_host(&host), 403, "{host:?}");
    }
    let twice = format!("Host: 127.0.0.1:{port}\r\nHost: evil.example\r\n");
    assert_eq!(with_host(&twice), 400);
    assert_eq!(served.ask("GET", "http://evil.example/", "").0, 400);
    assert_eq!(served.ask("GET", "/", "Content-Length: 5\r\n").0, 400);
    assert_eq!(served.send("nonsense\r\n\r\n").0, 400);
}

#[test]
fn what_is_no_store_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |args: &[&std::ffi::OsStr]| {
        Command::new(env!("CARGO_BIN_EXE_view")).args(args).output().expect("it starts")
    };
    let output = run(&[folder.path().as_os_str()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("is no store"), "{output:?}");
    let output = run(&[folder.path().join("nothing").as_os_str()]);
    assert_eq!(output.status.code(), Some(2));
    store(folder.path());
    let page = folder.path().join("page.html");
    let embed = |more: &[&str]| {
        let mut args = vec![
            folder.path().join("store").into_os_string(),
            "--embed".into(),
            page.clone().into_os_string(),
        ];
        args.extend(more.iter().map(|a| a.to_string().into()));
        let output = Command::new(env!("CARGO_BIN_EXE_view")).args(args).output().expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(
        embed(&["--scene", "4"]),
        (Some(1), "error: scene 0004 has no log yet: make stage STAGE=simulate-and-log\n".into())
    );
    assert_eq!(
        embed(&["--scene", "3", "--frames", "2..9"]),
        (Some(1), "error: scene 3 has the frames 0..4\n".into())
    );
    let (code, text) = embed(&["--scene", "3", "--agents", "vehicle_7"]);
    assert_eq!((code, text.as_str()), (Some(1), "error: scene 3 has no vehicle_7, but vehicle_0\n"));
    let (code, text) = embed(&["--scene", "3", "--cameras", "CAM_FRONT"]);
    assert_eq!((code, text.as_str()), (Some(1), "error: none of vehicle_0 has pictures of CAM_FRONT\n"));
    assert!(!page.exists());
    // Predictions that cannot be end it before anything is shown.
    let bad = folder.path().join("bad.parquet");
    fs::write(&bad, "no table").expect("is written");
    let (none, results) = (folder.path().join("none.parquet"), folder.path().join("results.json"));
    for (file, want) in
        [(&bad, "is no readable Parquet file"), (&none, "cannot be read"), (&results, "nuScenes")]
    {
        let store = folder.path().join("store");
        let output = run(&[store.as_os_str(), "--predictions".as_ref(), file.as_os_str()]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(want), "{said}");
    }
}
