//! `cargo xtask bench`: the benchmarks, headed by the machine they ran on; and `cargo xtask report`.

use std::{fs, process::ExitCode, thread};

use crate::cargo::{cargo_in_workspace, exit, succeeds};

/// Runs the benchmarks named, or all of them.
pub(crate) fn bench(names: &[String]) -> ExitCode {
    println!("{}", machine());
    let mut command = cargo_in_workspace();
    command.args(["bench", "--package", "walkabout"]);
    let all = ["parse", "kinematics", "startup", "hold", "solve"];
    let named: Vec<&str> = if names.is_empty() { all.to_vec() } else { names.iter().map(String::as_str).collect() };
    for name in named {
        command.args(["--bench", name]);
    }
    exit(succeeds(&mut command))
}

/// Writes the report on held feet into docs.
pub(crate) fn report() -> ExitCode {
    exit(succeeds(cargo_in_workspace().args(["bench", "--package", "walkabout", "--bench", "report"])))
}

/// Says how many cores there are, and of which kind where the system tells.
fn machine() -> String {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let model = fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| cpu_model(&text).map(str::to_owned));
    let model = model.unwrap_or_else(|| format!("unnamed {} processor", std::env::consts::ARCH));
    format!("{cores} {}, {model}", if cores == 1 { "core" } else { "cores" })
}

/// Finds the processor's name in Linux's `/proc/cpuinfo`.
fn cpu_model(cpuinfo: &str) -> Option<&str> {
    let (_, name) = cpuinfo.lines().find(|line| line.starts_with("model name"))?.split_once(':')?;
    Some(name.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cpu_model_is_read_from_cpuinfo() {
        let text =
            "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU @ 2.50GHz\n\nprocessor\t: 1\nmodel name\t: Other\n";
        assert_eq!(cpu_model(text), Some("Some CPU @ 2.50GHz"));
        assert_eq!(cpu_model("processor\t: 0\nBogoMIPS\t: 50.00\n"), None);
    }
}
