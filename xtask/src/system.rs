//! A description of this machine: what it has of the things walkabout may need, and what may be done about the rest.
//!
//! [`System`] is plain data, so that every decision made from it is tested on machines that do not exist. Only
//! [`System::look`] touches the real one; it starts a few short programs and installs nothing.

use std::{
    collections::BTreeSet,
    env,
    ffi::OsString,
    fs,
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::cargo::cargo;

/// The facts that decide what is missing and how to get it.
#[derive(Clone, Debug)]
pub(crate) struct System {
    /// The operating system, and on Linux how packages are installed.
    pub(crate) platform: Platform,
    /// File names of the shared libraries a program of this architecture would find.
    pub(crate) libraries: BTreeSet<String>,
    /// Programs on `PATH`.
    pub(crate) programs: BTreeSet<String>,
    /// `fmt`, `clippy`: the cargo tools that work.
    pub(crate) cargo_tools: BTreeSet<String>,
    /// Manifests of Vulkan drivers, in the order the loader looks at them.
    pub(crate) drivers: Vec<PathBuf>,
    /// Manifests of Vulkan layers.
    pub(crate) layers: Vec<PathBuf>,
    /// The kernel offers a graphics device.
    pub(crate) gpu: bool,
    /// What this user may install.
    pub(crate) rights: Rights,
    /// Somebody can answer a question.
    pub(crate) terminal: bool,
    /// apt has lists of packages.
    pub(crate) apt_lists: bool,
}

/// An operating system as far as installing is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Platform {
    /// Linux with this package manager; `None` where it is not one we know.
    Linux(Option<Packager>),
    /// macOS.
    MacOs,
    /// Windows.
    Windows,
    /// Anything else.
    Other,
}

/// A package manager whose package names we know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packager {
    /// Debian, Ubuntu and relatives.
    Apt,
    /// Fedora and relatives.
    Dnf,
    /// Arch and relatives.
    Pacman,
    /// openSUSE and relatives.
    Zypper,
}

/// How commands for the administrator can be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rights {
    /// By simply running them.
    Root,
    /// Through sudo.
    Sudo,
    /// Not at all.
    None,
}

impl System {
    /// Looks at this machine. Of programs and cargo tools, only those named are looked for.
    pub(crate) fn look(programs: &[&str], cargo_tools: &[&str]) -> Self {
        let on_path = |name: &&&str| programs_folders().iter().any(|folder| folder.join(**name).is_file());
        let tool_works = |name: &&&str| answers(cargo().args([**name, "--version"]));
        let named = |names: Vec<&&str>| names.into_iter().map(|name| (*name).to_owned()).collect();
        Self {
            platform: platform(),
            libraries: libraries(),
            programs: named(programs.iter().filter(on_path).collect()),
            cargo_tools: named(cargo_tools.iter().filter(tool_works).collect()),
            drivers: drivers(),
            layers: manifests_in(&vulkan_folders("explicit_layer.d", &|name| env::var_os(name))),
            gpu: ["/dev/dri", "/dev/nvidiactl", "/dev/dxg"].iter().any(|path| Path::new(path).exists()),
            rights: rights(),
            terminal: io::stdin().is_terminal() && io::stderr().is_terminal(),
            apt_lists: folder_has(Path::new("/var/lib/apt/lists"), |name| name.contains("_Packages")),
        }
    }

    /// Returns the manifest of lavapipe, Mesa's Vulkan driver for machines without a GPU.
    ///
    /// Where several architectures have one, this program's own.
    pub(crate) fn lavapipe(&self) -> Option<&Path> {
        let ours = |path: &&PathBuf| file_name(path).contains(env::consts::ARCH);
        let all = || self.drivers.iter().filter(|path| file_name(path).starts_with("lvp_icd"));
        all().find(ours).or_else(|| all().next()).map(PathBuf::as_path)
    }
}

/// Returns the last part of a path, empty where there is none.
pub(crate) fn file_name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

fn platform() -> Platform {
    match env::consts::OS {
        "linux" => {
            let release =
                ["/etc/os-release", "/usr/lib/os-release"].iter().find_map(|path| fs::read_to_string(path).ok());
            Platform::Linux(packager(&release.unwrap_or_default()))
        }
        "macos" => Platform::MacOs,
        "windows" => Platform::Windows,
        _ => Platform::Other,
    }
}

/// Tells the package manager from the text of `/etc/os-release`: by `ID`, else by the relatives in `ID_LIKE`.
fn packager(os_release: &str) -> Option<Packager> {
    let value = |key: &str| {
        let line = os_release.lines().find_map(|line| line.trim().strip_prefix(key)?.strip_prefix('='));
        line.unwrap_or_default().trim_matches(['"', '\'']).to_lowercase()
    };
    let (id, like) = (value("ID"), value("ID_LIKE"));
    [id.as_str()].into_iter().chain(like.split_whitespace()).find_map(|name| match name {
        "debian" | "ubuntu" => Some(Packager::Apt),
        "fedora" | "rhel" | "centos" => Some(Packager::Dnf),
        "arch" | "archlinux" => Some(Packager::Pacman),
        "suse" | "opensuse" | "opensuse-tumbleweed" | "opensuse-leap" => Some(Packager::Zypper),
        _ => None,
    })
}

/// Returns the names of the libraries in the linker's cache, in `LD_LIBRARY_PATH` and in the customary folders.
fn libraries() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for ldconfig in ["/sbin/ldconfig", "/usr/sbin/ldconfig", "ldconfig"] {
        if let Ok(output) = Command::new(ldconfig).arg("-p").stderr(Stdio::null()).output() {
            found = cached_libraries(&String::from_utf8_lossy(&output.stdout), env::consts::ARCH);
            break;
        }
    }
    let mut folders: Vec<PathBuf> =
        env::var_os("LD_LIBRARY_PATH").map(|paths| env::split_paths(&paths).collect()).unwrap_or_default();
    // Without a cache, as with musl, the folders are all there is to go by.
    if found.is_empty() {
        folders.extend(["/lib", "/usr/lib", "/usr/local/lib", "/lib64", "/usr/lib64"].map(PathBuf::from));
        folders.push(format!("/usr/lib/{}-linux-gnu", env::consts::ARCH).into());
    }
    for entry in folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.contains(".so") && entry.path().exists() {
            found.insert(name);
        }
    }
    found
}

/// Reads what `ldconfig -p` prints, leaving out the libraries of other architectures.
fn cached_libraries(text: &str, arch: &str) -> BTreeSet<String> {
    let tag = match arch {
        "x86_64" => Some("x86-64"),
        "aarch64" => Some("AArch64"),
        _ => None,
    };
    let ours = |flags: &str| tag.is_none_or(|tag| flags.split([',', ' ', ')']).any(|flag| flag == tag));
    let library = |line: &str| {
        let (name, rest) = line.trim().split_once(" (")?;
        let (flags, _path) = rest.split_once(" => ")?;
        ours(flags).then(|| name.to_owned())
    };
    text.lines().filter_map(library).collect()
}

/// Returns the driver manifests the Vulkan loader would look at.
fn drivers() -> Vec<PathBuf> {
    let var = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
    // Either variable replaces the search; the first is the newer name and wins.
    let Some(list) = var("VK_DRIVER_FILES").or_else(|| var("VK_ICD_FILENAMES")) else {
        return manifests_in(&vulkan_folders("icd.d", &var));
    };
    let named = env::split_paths(&list);
    named
        .flat_map(|path| if path.is_dir() { manifests_in(&[path]) } else { vec![path] })
        .filter(|p| p.is_file())
        .collect()
}

/// Returns the folders in which the Vulkan loader looks for manifests of a kind, in its order.
fn vulkan_folders(kind: &str, var: &dyn Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let home = var("HOME").map(PathBuf::from);
    let one = |name: &str, default: &str| {
        var(name).map(PathBuf::from).or_else(|| home.as_ref().map(|home| home.join(default))).into_iter().collect()
    };
    let list = |name: &str, default: &str| env::split_paths(&var(name).unwrap_or_else(|| default.into())).collect();
    let bases: [Vec<PathBuf>; 5] = [
        one("XDG_CONFIG_HOME", ".config"),
        list("XDG_CONFIG_DIRS", "/etc/xdg"),
        vec!["/usr/local/etc".into(), "/etc".into()],
        one("XDG_DATA_HOME", ".local/share"),
        list("XDG_DATA_DIRS", "/usr/local/share:/usr/share"),
    ];
    bases.concat().into_iter().map(|base| base.join("vulkan").join(kind)).collect()
}

/// Returns the manifests in these folders, sorted within each; a folder that cannot be read has none.
fn manifests_in(folders: &[PathBuf]) -> Vec<PathBuf> {
    let manifests = |folder: &PathBuf| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|ext| ext == "json")).collect();
        paths.sort();
        paths
    };
    folders.iter().flat_map(manifests).collect()
}

/// Tells the user's rights from the effective user's number that Linux shows in `/proc`, and from sudo on `PATH`.
fn rights() -> Rights {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    if effective_user(&status) == Some(0) {
        Rights::Root
    } else if programs_folders().iter().any(|folder| folder.join("sudo").is_file()) {
        Rights::Sudo
    } else {
        Rights::None
    }
}

fn effective_user(proc_status: &str) -> Option<u32> {
    proc_status.lines().find_map(|line| line.strip_prefix("Uid:"))?.split_whitespace().nth(1)?.parse().ok()
}

fn programs_folders() -> Vec<PathBuf> {
    env::var_os("PATH").map(|paths| env::split_paths(&paths).collect()).unwrap_or_default()
}

fn folder_has(folder: &Path, wanted: impl Fn(&str) -> bool) -> bool {
    fs::read_dir(folder).into_iter().flatten().flatten().any(|entry| wanted(&entry.file_name().to_string_lossy()))
}

/// True when a program starts and ends well, whatever it prints.
fn answers(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_packager(os_release: &str, expected: Option<Packager>) {
        assert_eq!(packager(os_release), expected, "{os_release}");
    }

    #[test]
    fn the_package_manager_follows_from_the_distribution_or_its_relatives() {
        check_packager("PRETTY_NAME=\"Debian GNU/Linux 12\"\nID=debian\n", Some(Packager::Apt));
        check_packager("ID=ubuntu\nID_LIKE=debian\n", Some(Packager::Apt));
        check_packager("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", Some(Packager::Apt));
        check_packager("ID=fedora\n", Some(Packager::Dnf));
        check_packager("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n", Some(Packager::Dnf));
        check_packager("ID=arch\n", Some(Packager::Pacman));
        check_packager("ID=manjaro\nID_LIKE=arch\n", Some(Packager::Pacman));
        check_packager("ID=\"opensuse-tumbleweed\"\nID_LIKE=\"opensuse suse\"\n", Some(Packager::Zypper));
        check_packager("ID=alpine\n", None);
        check_packager("VERSION_ID=12\nBUILD_ID=debian\n", None);
        check_packager("", None);
    }

    #[test]
    fn libraries_of_other_architectures_do_not_count() {
        let text = "3 libs found in cache `/etc/ld.so.cache'\n\
                    \tlibvulkan.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libvulkan.so.1\n\
                    \tlibX11.so.6 (libc6) => /lib/i386-linux-gnu/libX11.so.6\n\
                    \tlibXi.so.6 (libc6,x86-64, OS ABI: Linux 3.2.0) => /lib/x86_64-linux-gnu/libXi.so.6\n";
        let names = |arch| cached_libraries(text, arch).into_iter().collect::<Vec<_>>();
        assert_eq!(names("x86_64"), ["libXi.so.6", "libvulkan.so.1"]);
        assert_eq!(names("aarch64"), [""; 0]);
        assert_eq!(names("riscv64").len(), 3);
    }

    #[test]
    fn manifests_are_sought_where_the_loader_seeks_them() {
        let var = |name: &str| match name {
            "HOME" => Some(OsString::from("/home/a")),
            "XDG_DATA_DIRS" => Some("/x:/y".into()),
            _ => None,
        };
        let folders: Vec<_> = vulkan_folders("icd.d", &var).iter().map(|path| path.display().to_string()).collect();
        let bases = ["/home/a/.config", "/etc/xdg", "/usr/local/etc", "/etc", "/home/a/.local/share", "/x", "/y"];
        assert_eq!(folders, bases.map(|base| format!("{base}/vulkan/icd.d")));
        let homeless = vulkan_folders("icd.d", &|_| None);
        assert!(homeless.contains(&"/usr/share/vulkan/icd.d".into()));
    }

    #[test]
    fn the_effective_user_decides() {
        assert_eq!(effective_user("Name:\txtask\nUid:\t1000\t0\t0\t0\nGid:\t1000\n"), Some(0));
        assert_eq!(effective_user("Uid:\t1000\t1000\t1000\t1000\n"), Some(1000));
        assert_eq!(effective_user(""), None);
    }
}
