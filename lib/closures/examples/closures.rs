//! Prints what each program is built from: `cargo run -p convoy-closures --example closures`.

fn main() -> Result<(), closures::ClosureError> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for (program, closure) in closures::closures(&root)? {
        #[expect(clippy::print_stdout, reason = "this is what it is for")]
        {
            println!("{program} {}", closure.digest);
            println!("  crates: {}", closure.crates.into_iter().collect::<Vec<_>>().join(" "));
            let files = closure.files.into_iter().filter(|f| f.starts_with("lib/schema/"));
            println!(
                "  schema: {}",
                files.map(|f| f.replace("lib/schema/src/", "")).collect::<Vec<_>>().join(" ")
            );
            println!("  packages: {}", closure.packages.len());
        }
    }
    Ok(())
}
