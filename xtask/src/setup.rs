//! `cargo xtask setup`, and the first step of running and testing: what is missing is told, and installed if it may be.
//!
//! [`remedy`] decides from a description of the machine and can be tested; [`set_up`] looks, speaks and acts. Nothing
//! here stops the caller: walkabout works without most of what could be missing, and CI decides for itself.

use std::{
    env,
    io::{self, Write},
    process::{Command, ExitCode},
};

use crate::{
    apt,
    cargo::{exit, succeeds},
    needs::{self, Need, Purpose},
    system::{Packager, Platform, Rights, System},
    wrong_usage,
};

/// Whether something may be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Consent {
    /// Yes, it was said on the command line, or this is CI.
    Given,
    /// Only after asking, and not where nobody can answer.
    ToBeAsked,
}

impl Consent {
    /// Reads consent from `--yes` and from the variable `CI`.
    pub(crate) fn given(yes: bool) -> Self {
        if yes || in_ci() { Self::Given } else { Self::ToBeAsked }
    }
}

/// True in continuous integration, where nothing may be left out.
pub(crate) fn in_ci() -> bool {
    env::var_os("CI").is_some()
}

/// Makes the machine ready for running and testing.
pub(crate) fn setup(args: &[String]) -> ExitCode {
    let consent = match args {
        [] => Consent::given(false),
        [yes] if yes == "--yes" => Consent::given(true),
        _ => return wrong_usage("setup knows `--yes` and nothing else"),
    };
    let ready = set_up(Purpose::Test, consent);
    if ready {
        eprintln!("Everything that running and testing need is here.");
    }
    exit(ready)
}

/// What can be done about packages that are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remedy {
    /// Install them.
    Install,
    /// Ask, then install them.
    Ask,
    /// Say what to type.
    Tell,
}

/// Makes the machine ready for a purpose as far as it can. True when nothing is missing at the end.
///
/// Speaks on stderr, and only when something is missing.
pub(crate) fn set_up(purpose: Purpose, consent: Consent) -> bool {
    let system = look(purpose);
    let missing = needs::missing(&system, purpose);
    if let Some(advice) = advice(system.platform, !missing.is_empty()) {
        eprintln!("{advice}");
    }
    if missing.is_empty() {
        return true;
    }
    eprintln!("Missing on this machine:");
    tell(&missing);
    let packages = needs::packages(&missing, system.platform);
    if !packages.is_empty() {
        bring_packages(&system, &packages, consent);
    }
    let components = needs::components(&missing);
    if !components.is_empty() {
        bring_components(&system, &components, consent);
    }
    let left = needs::missing(&look(purpose), purpose);
    if !left.is_empty() && left.len() < missing.len() {
        eprintln!("Still missing:");
        tell(&left);
    }
    left.is_empty()
}

fn look(purpose: Purpose) -> System {
    let (programs, cargo_tools) = needs::looked_for(purpose);
    System::look(&programs, &cargo_tools)
}

fn tell(needs: &[&Need]) {
    for need in needs {
        eprintln!("  {}: for {}", need.name, need.serves);
    }
}

fn bring_packages(system: &System, packages: &[&str], consent: Consent) {
    match remedy(system, consent) {
        Remedy::Tell => {
            eprintln!(
                "Nothing was installed. To install it:\n  {}",
                command_line(system, packages).unwrap_or_default()
            );
        }
        Remedy::Ask if !agreed(&format!("Install {} with apt-get?", packages.join(" "))) => {}
        Remedy::Ask | Remedy::Install => {
            eprintln!("Installing {}.", packages.join(" "));
            if !apt::install(packages, system.apt_lists, system.rights, system.terminal) {
                eprintln!("apt-get could not install them.");
            }
        }
    }
}

fn bring_components(system: &System, components: &[&str], consent: Consent) {
    let line = format!("rustup component add {}", components.join(" "));
    let may = match consent {
        Consent::Given => true,
        Consent::ToBeAsked => system.terminal && agreed(&format!("Run `{line}`?")),
    };
    if may {
        succeeds(Command::new("rustup").args(["component", "add"]).args(components).stdout(io::stderr()));
    } else {
        eprintln!("Nothing was added to the Rust toolchain. To add it:\n  {line}");
    }
}

/// Decides what to do about missing packages. Only apt-get is ever run, and only with the right to.
fn remedy(system: &System, consent: Consent) -> Remedy {
    let can_install = system.platform == Platform::Linux(Some(Packager::Apt)) && system.rights != Rights::None;
    match (can_install, consent) {
        (true, Consent::Given) => Remedy::Install,
        (true, Consent::ToBeAsked) if system.terminal => Remedy::Ask,
        _ => Remedy::Tell,
    }
}

/// What to type on this system to install packages; nothing where its package manager is not known.
fn command_line(system: &System, packages: &[&str]) -> Option<String> {
    let Platform::Linux(Some(packager)) = system.platform else { return None };
    let names = packages.join(" ");
    Some(match packager {
        Packager::Apt => apt::line(packages, system.rights),
        Packager::Dnf => format!("sudo dnf install {names}"),
        Packager::Pacman => format!("sudo pacman -S --needed {names}"),
        Packager::Zypper => format!("sudo zypper install {names}"),
    })
}

/// What there is to say on systems where nothing is installed automatically: on Linux only if something is missing,
/// elsewhere always, because there we do not look.
fn advice(platform: Platform, something_missing: bool) -> Option<&'static str> {
    match platform {
        Platform::Linux(None) if something_missing => Some(
            "This system's package manager is not known here: nothing is installed automatically. What is missing is \
             listed by library and program.",
        ),
        Platform::Linux(_) => None,
        Platform::MacOs => Some(
            "On macOS nothing is installed automatically. The preview needs a Vulkan driver: MoltenVK, as in the \
             Vulkan SDK. The editor works without.",
        ),
        Platform::Windows => Some(
            "On Windows nothing is installed automatically. The preview needs a Vulkan driver, which graphics drivers \
             bring. The editor works without.",
        ),
        Platform::Other => Some("On this system nothing is installed automatically."),
    }
}

/// Asks on the terminal. An empty answer is a yes, the end of input is a no.
fn agreed(question: &str) -> bool {
    eprint!("{question} [Y/n] ");
    // A prompt that cannot be shown is answered all the same.
    let _ = io::stderr().flush();
    let mut answer = String::new();
    match io::stdin().read_line(&mut answer) {
        Ok(0) | Err(_) => false,
        Ok(_) => matches!(answer.trim().to_lowercase().as_str(), "" | "y" | "yes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(platform: Platform, rights: Rights, terminal: bool) -> System {
        System {
            platform,
            libraries: [].into(),
            programs: [].into(),
            cargo_tools: [].into(),
            drivers: Vec::new(),
            layers: Vec::new(),
            gpu: false,
            rights,
            terminal,
            apt_lists: false,
        }
    }

    const DEBIAN: Platform = Platform::Linux(Some(Packager::Apt));

    #[test]
    fn installing_takes_apt_rights_and_consent() {
        use Consent::{Given, ToBeAsked};
        let cases = [
            (DEBIAN, Rights::Root, false, Given, Remedy::Install),
            (DEBIAN, Rights::Sudo, true, Given, Remedy::Install),
            (DEBIAN, Rights::Sudo, true, ToBeAsked, Remedy::Ask),
            (DEBIAN, Rights::Root, false, ToBeAsked, Remedy::Tell),
            (DEBIAN, Rights::None, true, Given, Remedy::Tell),
            (Platform::Linux(Some(Packager::Dnf)), Rights::Root, true, Given, Remedy::Tell),
            (Platform::Linux(None), Rights::Root, true, Given, Remedy::Tell),
            (Platform::MacOs, Rights::Sudo, true, Given, Remedy::Tell),
        ];
        for (platform, rights, terminal, consent, expected) in cases {
            let system = system(platform, rights, terminal);
            assert_eq!(remedy(&system, consent), expected, "{platform:?} {rights:?} {terminal} {consent:?}");
        }
    }

    #[test]
    fn people_are_told_their_own_package_manager() {
        let line = |packager| {
            let system = system(Platform::Linux(packager), Rights::Sudo, true);
            command_line(&system, &["a", "b"]).unwrap_or_default()
        };
        assert_eq!(line(Some(Packager::Apt)), "sudo apt-get install --no-install-recommends a b");
        assert_eq!(line(Some(Packager::Dnf)), "sudo dnf install a b");
        assert_eq!(line(Some(Packager::Pacman)), "sudo pacman -S --needed a b");
        assert_eq!(line(Some(Packager::Zypper)), "sudo zypper install a b");
        assert_eq!(line(None), "");
    }

    #[test]
    fn systems_left_alone_are_told_so() {
        for something_missing in [false, true] {
            assert_eq!(advice(DEBIAN, something_missing), None);
            assert_eq!(advice(Platform::Linux(None), something_missing).is_some(), something_missing);
            for platform in [Platform::MacOs, Platform::Windows, Platform::Other] {
                let text = advice(platform, something_missing).unwrap_or_default();
                assert!(text.contains("nothing is installed automatically"), "{text}");
            }
        }
    }
}
