//! What shells and `man` are told of `convoy`.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};

use convoy_tests::{Bench, Outcome, TINY, program};

/// What `convoy` prints.
fn convoy(args: &[&str]) -> String {
    let output = Command::new(program("convoy")).args(args).output().expect("the program starts");
    assert!(output.status.success(), "{args:?}: {output:?}");
    String::from_utf8(output.stdout).expect("is UTF-8")
}

/// What bash offers for the last of some words.
fn offered(script: &Path, words: &[&str]) -> BTreeSet<String> {
    let ask = format!(
        "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _convoy convoy \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        script.display(),
        words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" "),
        words.len() - 1,
    );
    let output = Command::new("bash").args(["-c", &ask]).output().expect("bash starts");
    let text = String::from_utf8(output.stdout).expect("is UTF-8");
    text.lines().map(str::to_owned).collect()
}

#[test]
fn bash_completes_commands_and_options() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = folder.path().join("convoy.bash");
    std::fs::write(&script, convoy(&["completions", "bash"])).expect("is written");
    assert_eq!(offered(&script, &["convoy", "ver"]), BTreeSet::from(["verify".to_owned()]));
    let options = offered(&script, &["convoy", "tidy", "--"]);
    assert!(options.contains("--store"), "{options:?}");
    // Programs that it starts complete theirs, too.
    for (words, options) in [
        (vec!["convoy", "export", "n"], vec!["nuscenes"]),
        (vec!["convoy", "export", "nuscenes", "--"], vec!["--store", "--dest", "--sweeps", "--radius"]),
        (vec!["convoy", "import", "simbev2x", "--s"], vec!["--source", "--store", "--scenes"]),
        (vec!["convoy", "evaluate", "--"], vec!["--predictions", "--metrics"]),
        (vec!["convoy", "viz", "--"], vec!["--modes", "--colour"]),
        (vec!["convoy", "viz", "--colour", ""], vec!["distance", "velocity"]),
        (vec!["convoy", "preview", "--"], vec!["--frame", "--agent"]),
        (vec!["convoy", "film", "--"], vec!["--width"]),
        (vec!["convoy", "check", "--"], vec!["--every"]),
        (vec!["convoy", "view", "--"], vec!["--embed"]),
    ] {
        let offers = offered(&script, &words);
        assert!(options.iter().all(|option| offers.contains(*option)), "{words:?}: {offers:?}");
    }
    for (shell, word) in [("zsh", "#compdef convoy"), ("fish", "complete -c convoy")] {
        assert!(convoy(&["completions", shell]).contains(word), "{shell}");
    }
}

/// `convoy status | head`, `convoy check 2>&1 | head`: who reads no further closes the pipe.
#[test]
fn a_closed_pipe_is_no_error() {
    let bench = Bench::new(TINY);
    let ends = |command: &mut Command, closed: fn(&mut Command, Stdio) -> &mut Command| {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        Outcome::of(&closed(command, writer.into()).output().expect("the program starts"))
    };
    for args in [&["completions", "bash"][..], &["check", "--help"]] {
        let outcome = ends(Command::new(program("convoy")).args(args), Command::stdout);
        outcome.expect_done();
        assert_eq!(outcome.stderr, "", "{args:?}");
    }
    // There is no plan yet.
    let outcome = ends(&mut bench.command("convoy", &["status"]), Command::stdout);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""));
    // Nor does it hide what the end of the program was.
    std::fs::write(bench.config(), "seed = \"one\"").expect("is written");
    let outcome = ends(&mut bench.command("convoy", &["status"]), Command::stderr);
    assert_eq!(outcome.code, 2, "{outcome:?}");
    for args in [&["check", "nowhere"][..], &["view", "nowhere"]] {
        let outcome = ends(Command::new(program("convoy")).args(args), Command::stderr);
        assert_eq!(outcome.code, 2, "{args:?}: {outcome:?}");
    }
}

#[test]
fn every_command_has_a_page_with_its_options() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pages = folder.path().join("man");
    convoy(&["man", &pages.display().to_string()]);
    let count = pages_of(&pages, &[]);
    // Of `export` alone there are six layouts.
    assert!(count > 20, "{count}");
}

/// Looks for the pages of a command and of all below it; how many there are.
fn pages_of(pages: &Path, command: &[&str]) -> usize {
    let text = convoy(&[command, &["--help"]].concat());
    let name = [&["convoy"], command].concat().join("-");
    let page = std::fs::read_to_string(pages.join(format!("{name}.1"))).expect("has a page");
    // In manual pages a dash is written with a backslash.
    let plain = page.replace('\\', "");
    assert!(plain.contains(&format!(".TH {name} 1")), "{name}: {page}");
    let words = text.split_whitespace().filter(|word| word.starts_with("--"));
    for option in words.map(|w| w.trim_matches(|c: char| !c.is_ascii_alphanumeric() && c != '-')) {
        let option = option.trim_end_matches('-');
        assert!(option.is_empty() || plain.contains(option), "{name}: {option} is not in its page");
    }
    let commands = text.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    // Their descriptions go on in lines that are set in further.
    let names = commands.filter_map(|l| l.strip_prefix("  ").filter(|l| !l.starts_with(' ')));
    let names = names.filter_map(|l| l.split(' ').next()).filter(|name| *name != "help");
    1 + names.map(|name| pages_of(pages, &[command, &[name]].concat())).sum::<usize>()
}
