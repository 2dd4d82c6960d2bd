//! Installing packages on Debian, Ubuntu and their relatives.

use std::process::{Command, Stdio};

use crate::{cargo::succeeds, system::Rights};

/// An `apt-get` call as words, the program first.
type Call = Vec<String>;

/// Installs packages. True when apt-get said so.
///
/// Package lists that are missing are fetched first; lists that turn out to be too old are fetched and the
/// installation tried once more.
pub(crate) fn install(packages: &[&str], lists_present: bool, rights: Rights, can_ask_password: bool) -> bool {
    let call = |words: &[&str]| start(&call(words, rights, can_ask_password));
    let install = install_words(packages);
    if lists_present && call(&install) {
        return true;
    }
    call(&["update"]) && call(&install)
}

/// What to type to install packages, as one line.
pub(crate) fn line(packages: &[&str], rights: Rights) -> String {
    let sudo = if rights == Rights::Root { "" } else { "sudo " };
    format!("{sudo}apt-get {}", install_words(packages).join(" "))
}

fn install_words<'a>(packages: &[&'a str]) -> Vec<&'a str> {
    [&["install", "--no-install-recommends"], packages].concat()
}

/// Makes an apt-get call that asks nothing and waits for another one that holds the lock.
fn call(words: &[&str], rights: Rights, can_ask_password: bool) -> Call {
    let sudo: &[&str] = match (rights, can_ask_password) {
        (Rights::Root | Rights::None, _) => &[],
        (Rights::Sudo, true) => &["sudo"],
        (Rights::Sudo, false) => &["sudo", "--non-interactive"],
    };
    let apt: &[&str] =
        &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "--yes", "--quiet", "-o", "DPkg::Lock::Timeout=300"];
    [sudo, apt, words].concat().into_iter().map(str::to_owned).collect()
}

/// Runs a call with its output on stderr, since stdout may be walkabout's.
fn start(call: &Call) -> bool {
    let mut command = Command::new(&call[0]);
    command.args(&call[1..]).stdin(Stdio::null()).stdout(std::io::stderr());
    succeeds(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(rights: Rights, can_ask_password: bool, expected: &str) {
        let call = call(&install_words(&["libvulkan1", "libxi6"]), rights, can_ask_password);
        assert_eq!(call.join(" "), expected);
    }

    #[test]
    fn calls_ask_nothing_and_use_sudo_only_where_needed() {
        let apt = "env DEBIAN_FRONTEND=noninteractive apt-get --yes --quiet -o DPkg::Lock::Timeout=300 \
                   install --no-install-recommends libvulkan1 libxi6";
        check(Rights::Root, true, apt);
        check(Rights::Root, false, apt);
        check(Rights::Sudo, true, &format!("sudo {apt}"));
        check(Rights::Sudo, false, &format!("sudo --non-interactive {apt}"));
    }

    #[test]
    fn the_line_for_people_names_sudo_unless_they_are_root() {
        assert_eq!(line(&["xvfb"], Rights::Root), "apt-get install --no-install-recommends xvfb");
        assert_eq!(line(&["xvfb"], Rights::Sudo), "sudo apt-get install --no-install-recommends xvfb");
        assert_eq!(line(&["xvfb"], Rights::None), "sudo apt-get install --no-install-recommends xvfb");
    }
}
