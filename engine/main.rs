//! The `froth` command line.

fn main() -> std::process::ExitCode {
    froth::cli::main(std::env::args_os())
}
