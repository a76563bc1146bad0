//! The command `lichtenberg`: an exit code, nothing else.

fn main() -> std::process::ExitCode {
    lichtenberg::cli::main()
}
