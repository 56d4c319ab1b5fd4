//! What programs say of themselves. `INSTA_UPDATE=always cargo nextest run -p convoy-tests help` rewrites the
//! texts; read the difference.

use std::process::Command;

use convoy_tests::{Bench, SMALL, program};

/// What `--help` prints, 100 characters wide.
fn help(name: &str, args: &[&str]) -> String {
    let mut command = Command::new(program(name));
    // The help states what the environment holds.
    for (variable, _) in std::env::vars().filter(|(name, _)| name.starts_with("CONVOY_")) {
        command.env_remove(variable);
    }
    let slots = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX", "RUST_LOG"];
    let output = slots.iter().fold(&mut command, |c, name| c.env_remove(name)).env("COLUMNS", "100");
    let output = output.args(args).arg("--help").output().expect("the program starts");
    assert!(output.status.success(), "{name}: {output:?}");
    String::from_utf8(output.stdout).expect("is UTF-8")
}

#[test]
fn stages_explain_themselves() {
    for stage in &runner::Graph::get().stages {
        insta::assert_snapshot!(stage.name, help(stage.name, &[]));
    }
}

#[test]
fn the_checker_explains_itself() {
    insta::assert_snapshot!("check", help("check", &[]));
}

#[test]
fn the_viewer_explains_itself() {
    insta::assert_snapshot!("view", help("view", &[]));
}

#[test]
fn convoy_explains_itself_and_its_commands() {
    let text = help("convoy", &[]);
    insta::assert_snapshot!("convoy", text);
    let commands = text.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    // Their descriptions go on in lines that are set in further.
    let names = commands.filter_map(|l| l.strip_prefix("  ").filter(|l| !l.starts_with(' ')));
    let commands: Vec<&str> = names.filter_map(|l| l.split(' ').next()).collect();
    for command in commands.iter().filter(|name| **name != "help") {
        insta::assert_snapshot!(format!("convoy-{command}"), help("convoy", &[command]));
    }
    assert!(commands.len() > 6, "{commands:?}");
}

#[test]
fn status_is_a_table_of_scenes_and_stages() {
    let bench = Bench::new(&SMALL.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2"));
    let status = || {
        let outcome = bench.run("convoy", &["status"]);
        let said = outcome.stdout.replace(&bench.folder.path().display().to_string(), "FOLDER");
        // How many bytes its shards have changes with what drives by.
        let sized = |line: &str| match line.split_once(" of one core, ") {
            Some((cost, _)) => format!("{cost} of one core, SIZE\n"),
            None => format!("{line}\n"),
        };
        said.lines().map(sized).collect::<String>()
    };
    bench.run("spawn-planner", &[]).expect_done();
    insta::assert_snapshot!("status-of-a-plan", status());
    bench.run("simulate-and-log", &["--scenes", "1"]).expect_done();
    bench.run("bev-gt", &["--scenes", "1"]).expect_done();
    insta::assert_snapshot!("status-of-a-scene", status());
    bench.configure(&SMALL.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2\n\n[bev]\ncells = 200"));
    insta::assert_snapshot!("status-of-another-configuration", status());
}
