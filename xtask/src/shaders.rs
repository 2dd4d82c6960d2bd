//! The check of compiled shaders.
//!
//! The build script has compiled them already, so that a wrong shader fails the build with its line; here the Khronos
//! validator looks at what came out, on its own and without a driver.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::cargo::{cargo_in_workspace, succeeds, workspace};

/// Validates every compiled shader. True when the validator accepts them all, or is not installed, which is told.
pub(crate) fn check() -> bool {
    let Some(folder) = build_output() else {
        println!("the build script's output was not found");
        return false;
    };
    let shaders = files_ending(&folder, "spv");
    if shaders.is_empty() {
        println!("no compiled shader in {}", folder.display());
        return files_ending(&workspace().join("shaders"), "wgsl").is_empty();
    }
    if Command::new("spirv-val").arg("--version").stdout(Stdio::null()).status().is_err() {
        println!("SKIPPED: spirv-val is not installed, so only the build script has looked at the shaders");
        return true;
    }
    let valid = |path: &&PathBuf| succeeds(Command::new("spirv-val").args(["--target-env", "vulkan1.3"]).arg(path));
    let n_valid = shaders.iter().filter(valid).count();
    println!("{n_valid} of {} compiled shaders are valid", shaders.len());
    n_valid == shaders.len()
}

/// Returns the folder into which walkabout's build script wrote, as cargo tells.
///
/// Asks for what the tests are made of: another selection would have other features and build half of it again.
fn build_output() -> Option<PathBuf> {
    let mut command = cargo_in_workspace();
    command.args(["test", "--workspace", "--no-run", "--quiet", "--message-format", "json"]).stderr(Stdio::inherit());
    let output = command.output().ok()?;
    out_dir(&String::from_utf8_lossy(&output.stdout), &workspace()).map(PathBuf::from)
}

/// Finds the output folder in cargo's messages: one JSON object a line, of which one tells of our build script.
fn out_dir<'a>(messages: &'a str, workspace: &Path) -> Option<&'a str> {
    let package = format!("path+file://{}#", workspace.display());
    let ours = |line: &&str| line.contains("\"build-script-executed\"") && line.contains(&package);
    let (_, rest) = messages.lines().find(ours)?.split_once("\"out_dir\":\"")?;
    Some(rest.split_once('"')?.0)
}

fn files_ending(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ext| ext == extension)).collect();
    found.sort();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_folder_is_that_of_our_own_build_script() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","package_id":"path+file:///w#walkabout@0.1.0"}"#,
            "\n",
            r#"{"reason":"build-script-executed","package_id":"registry+https://r#serde@1.0.0","out_dir":"/t/serde"}"#,
            "\n",
            r#"{"reason":"build-script-executed","package_id":"path+file:///w#walkabout@0.1.0","env":[],"out_dir":"/t/out"}"#,
            "\n",
        );
        assert_eq!(out_dir(messages, Path::new("/w")), Some("/t/out"));
        assert_eq!(out_dir(messages, Path::new("/elsewhere")), None);
        assert_eq!(out_dir("", Path::new("/w")), None);
    }
}
