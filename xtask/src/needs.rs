//! What walkabout needs of a machine, and what to do where something is missing.
//!
//! [`NEEDS`] is the one table: another need is another row. [`missing`] and [`packages`] are pure functions of the
//! table and of a [`System`], so this file touches nothing. Needs of Linux only are shared libraries and programs;
//! elsewhere drivers and window systems are not ours to install.

use crate::system::{Packager, Platform, System, file_name};

/// What the machine is to be made ready for. Testing needs all that running does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Purpose {
    /// Building and using walkabout.
    Run,
    /// Every check, pictures and windows included.
    Test,
}

/// One thing walkabout needs.
#[derive(Debug)]
pub(crate) struct Need {
    /// What it is, in plain words.
    pub(crate) name: &'static str,
    /// What does not work without it.
    pub(crate) serves: &'static str,
    /// From which purpose on it is needed.
    purpose: Purpose,
    /// How to tell whether it is there.
    pub(crate) thing: Thing,
    /// What brings it.
    source: Source,
}

/// Something a machine has or lacks.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Thing {
    /// A shared library, by file name.
    Library(&'static str),
    /// Any one of these programs.
    Program(&'static [&'static str]),
    /// A subcommand of cargo.
    CargoTool(&'static str),
    /// A Vulkan driver that can work here: lavapipe, or any other where there is a graphics device.
    Driver,
    /// Mesa's Vulkan driver that needs no GPU; pictures are compared on it alone.
    Lavapipe,
    /// A Vulkan layer, by the name of its manifest.
    Layer(&'static str),
}

/// Where a missing thing comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Packages of the distribution.
    Packages { apt: Names, dnf: Names, pacman: Names, zypper: Names },
    /// A component of the Rust toolchain.
    Rustup(&'static str),
}

/// Names of packages.
type Names = &'static [&'static str];

/// Everything needed, in the order it is told. Of the package names, only Debian's have been tried.
const NEEDS: &[Need] = &[
    Need {
        name: "C compiler (cc)",
        serves: "linking programs",
        purpose: Purpose::Run,
        thing: Thing::Program(&["cc", "gcc", "clang"]),
        source: Source::Packages { apt: &["gcc", "libc6-dev"], dnf: &["gcc"], pacman: &["gcc"], zypper: &["gcc"] },
    },
    Need {
        name: "Vulkan loader (libvulkan.so.1)",
        serves: "the preview and rendered pictures",
        purpose: Purpose::Run,
        thing: Thing::Library("libvulkan.so.1"),
        source: Source::Packages {
            apt: &["libvulkan1"],
            dnf: &["vulkan-loader"],
            pacman: &["vulkan-icd-loader"],
            zypper: &["libvulkan1"],
        },
    },
    Need {
        name: "Vulkan driver",
        serves: "the preview and rendered pictures",
        purpose: Purpose::Run,
        thing: Thing::Driver,
        source: MESA,
    },
    Need {
        name: "Vulkan driver for machines without a GPU (lavapipe)",
        serves: "tests that compare pictures",
        purpose: Purpose::Test,
        thing: Thing::Lavapipe,
        source: MESA,
    },
    x11("libX11.so.6", &["libx11-6"], &["libX11"], &["libx11"], &["libX11-6"]),
    x11("libX11-xcb.so.1", &["libx11-xcb1"], &["libX11-xcb"], &["libx11"], &["libX11-xcb1"]),
    x11("libXcursor.so.1", &["libxcursor1"], &["libXcursor"], &["libxcursor"], &["libXcursor1"]),
    x11("libXi.so.6", &["libxi6"], &["libXi"], &["libxi"], &["libXi6"]),
    x11(
        "libxkbcommon-x11.so.0",
        &["libxkbcommon-x11-0"],
        &["libxkbcommon-x11"],
        &["libxkbcommon-x11"],
        &["libxkbcommon-x11-0"],
    ),
    Need {
        name: "Vulkan validation layer",
        serves: "tests that deny Vulkan mistakes",
        purpose: Purpose::Test,
        thing: Thing::Layer("VkLayer_khronos_validation.json"),
        source: Source::Packages {
            apt: &["vulkan-validationlayers"],
            dnf: &["vulkan-validation-layers"],
            pacman: &["vulkan-validation-layers"],
            zypper: &["vulkan-validationlayers"],
        },
    },
    Need {
        name: "Xvfb, a display without a screen",
        serves: "tests of the window",
        purpose: Purpose::Test,
        thing: Thing::Program(&["Xvfb"]),
        source: Source::Packages {
            apt: &["xvfb"],
            dnf: &["xorg-x11-server-Xvfb"],
            pacman: &["xorg-server-xvfb"],
            zypper: &["xorg-x11-server-Xvfb"],
        },
    },
    Need {
        name: "spirv-val",
        serves: "the check of compiled shaders",
        purpose: Purpose::Test,
        thing: Thing::Program(&["spirv-val"]),
        source: Source::Packages {
            apt: &["spirv-tools"],
            dnf: &["spirv-tools"],
            pacman: &["spirv-tools"],
            zypper: &["spirv-tools"],
        },
    },
    Need {
        name: "cargo fmt",
        serves: "the format check",
        purpose: Purpose::Test,
        thing: Thing::CargoTool("fmt"),
        source: Source::Rustup("rustfmt"),
    },
    Need {
        name: "cargo clippy",
        serves: "the clippy check",
        purpose: Purpose::Test,
        thing: Thing::CargoTool("clippy"),
        source: Source::Rustup("clippy"),
    },
];

/// Mesa's Vulkan drivers. Debian, Ubuntu and Fedora ship them all in one package; where each has its own, the one
/// that works on every machine.
const MESA: Source = Source::Packages {
    apt: &["mesa-vulkan-drivers"],
    dnf: &["mesa-vulkan-drivers"],
    pacman: &["vulkan-swrast"],
    zypper: &["libvulkan_lvp"],
};

/// A library that winit loads when it opens a window on X11.
const fn x11(library: &'static str, apt: Names, dnf: Names, pacman: Names, zypper: Names) -> Need {
    Need {
        name: library,
        serves: "a window on X11",
        purpose: Purpose::Run,
        thing: Thing::Library(library),
        source: Source::Packages { apt, dnf, pacman, zypper },
    }
}

/// Returns the needs of a purpose that the system does not meet, in the table's order.
pub(crate) fn missing(system: &System, purpose: Purpose) -> Vec<&'static Need> {
    needs(purpose).filter(|need| need.concerns(system.platform) && !system.has(need.thing)).collect()
}

/// Returns the packages that bring what is missing, each once. Empty where the package manager is not known.
pub(crate) fn packages(missing: &[&Need], platform: Platform) -> Vec<&'static str> {
    let Platform::Linux(Some(packager)) = platform else { return Vec::new() };
    let mut names = Vec::new();
    for need in missing {
        let Source::Packages { apt, dnf, pacman, zypper } = need.source else { continue };
        let wanted = match packager {
            Packager::Apt => apt,
            Packager::Dnf => dnf,
            Packager::Pacman => pacman,
            Packager::Zypper => zypper,
        };
        names.extend(wanted.iter().filter(|name| !names.contains(*name)).copied().collect::<Vec<_>>());
    }
    names
}

/// Returns the components of the Rust toolchain that bring what is missing.
pub(crate) fn components(missing: &[&Need]) -> Vec<&'static str> {
    let component = |need: &&Need| match need.source {
        Source::Rustup(component) => Some(component),
        Source::Packages { .. } => None,
    };
    missing.iter().filter_map(component).collect()
}

/// Returns the programs and the cargo tools whose presence matters for a purpose.
pub(crate) fn looked_for(purpose: Purpose) -> (Vec<&'static str>, Vec<&'static str>) {
    let (mut programs, mut tools) = (Vec::new(), Vec::new());
    for need in needs(purpose) {
        match need.thing {
            Thing::Program(names) => programs.extend(names),
            Thing::CargoTool(name) => tools.push(name),
            Thing::Library(_) | Thing::Driver | Thing::Lavapipe | Thing::Layer(_) => {}
        }
    }
    (programs, tools)
}

fn needs(purpose: Purpose) -> impl Iterator<Item = &'static Need> {
    NEEDS.iter().filter(move |need| need.purpose <= purpose)
}

impl Need {
    /// True where the lack would be noticed and told: packages on Linux, toolchain components everywhere.
    fn concerns(&self, platform: Platform) -> bool {
        matches!(platform, Platform::Linux(_)) || matches!(self.source, Source::Rustup(_))
    }
}

impl System {
    fn has(&self, thing: Thing) -> bool {
        match thing {
            Thing::Library(name) => self.libraries.contains(name),
            Thing::Program(names) => names.iter().any(|name| self.programs.contains(*name)),
            Thing::CargoTool(name) => self.cargo_tools.contains(name),
            Thing::Driver => self.lavapipe().is_some() || (self.gpu && !self.drivers.is_empty()),
            Thing::Lavapipe => self.lavapipe().is_some(),
            Thing::Layer(manifest) => self.layers.iter().any(|path| file_name(path) == manifest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::Rights;

    /// A machine with a C compiler, a Rust toolchain and nothing else.
    fn bare(platform: Platform) -> System {
        System {
            platform,
            libraries: ["libc.so.6".to_owned()].into(),
            programs: ["cc".to_owned()].into(),
            cargo_tools: ["fmt".to_owned(), "clippy".to_owned()].into(),
            drivers: Vec::new(),
            layers: Vec::new(),
            gpu: false,
            rights: Rights::Root,
            terminal: false,
            apt_lists: true,
        }
    }

    /// A Debian machine with everything that running needs.
    fn ready() -> System {
        let libraries = [
            "libvulkan.so.1",
            "libX11.so.6",
            "libX11-xcb.so.1",
            "libXcursor.so.1",
            "libXi.so.6",
            "libxkbcommon-x11.so.0",
        ];
        System {
            libraries: libraries.map(str::to_owned).into(),
            drivers: vec!["/usr/share/vulkan/icd.d/lvp_icd.x86_64.json".into()],
            ..bare(Platform::Linux(Some(Packager::Apt)))
        }
    }

    /// Checks which packages a system is told to install.
    #[track_caller]
    fn check(system: &System, purpose: Purpose, expected: &str) {
        assert_eq!(packages(&missing(system, purpose), system.platform).join(" "), expected);
    }

    #[test]
    fn a_bare_machine_gets_everything_and_each_package_once() {
        let mut system = bare(Platform::Linux(Some(Packager::Apt)));
        check(
            &system,
            Purpose::Run,
            "libvulkan1 mesa-vulkan-drivers libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0",
        );
        check(
            &system,
            Purpose::Test,
            "libvulkan1 mesa-vulkan-drivers libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0 \
             vulkan-validationlayers xvfb spirv-tools",
        );
        system.programs.clear();
        check(
            &system,
            Purpose::Run,
            "gcc libc6-dev libvulkan1 mesa-vulkan-drivers libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0",
        );
    }

    #[test]
    fn other_distributions_have_other_names() {
        let on = |packager| bare(Platform::Linux(Some(packager)));
        check(
            &on(Packager::Dnf),
            Purpose::Run,
            "vulkan-loader mesa-vulkan-drivers libX11 libX11-xcb libXcursor libXi libxkbcommon-x11",
        );
        check(
            &on(Packager::Pacman),
            Purpose::Run,
            "vulkan-icd-loader vulkan-swrast libx11 libxcursor libxi libxkbcommon-x11",
        );
        check(
            &on(Packager::Zypper),
            Purpose::Run,
            "libvulkan1 libvulkan_lvp libX11-6 libX11-xcb1 libXcursor1 libXi6 libxkbcommon-x11-0",
        );
    }

    #[test]
    fn a_machine_that_has_it_all_needs_nothing() {
        check(&ready(), Purpose::Run, "");
        assert!(missing(&ready(), Purpose::Run).is_empty());
        check(&ready(), Purpose::Test, "vulkan-validationlayers xvfb spirv-tools");
    }

    #[test]
    fn a_vendors_driver_counts_only_where_there_is_a_gpu() {
        let vendor = vec!["/usr/share/vulkan/icd.d/nvidia_icd.json".into()];
        let with_gpu = System { drivers: vendor.clone(), gpu: true, ..ready() };
        check(&with_gpu, Purpose::Run, "");
        let without_gpu = System { drivers: vendor, ..ready() };
        check(&without_gpu, Purpose::Run, "mesa-vulkan-drivers");
        let gpu_without_driver = System { drivers: Vec::new(), gpu: true, ..ready() };
        check(&gpu_without_driver, Purpose::Run, "mesa-vulkan-drivers");
    }

    #[test]
    fn pictures_are_compared_on_lavapipe_even_where_there_is_a_gpu() {
        let drivers = vec!["/usr/share/vulkan/icd.d/radeon_icd.x86_64.json".into()];
        let system = System { drivers, gpu: true, ..ready() };
        check(&system, Purpose::Test, "mesa-vulkan-drivers vulkan-validationlayers xvfb spirv-tools");
    }

    #[test]
    fn an_unknown_distribution_lacks_the_same_but_no_package_is_named() {
        let system = bare(Platform::Linux(None));
        check(&system, Purpose::Run, "");
        assert_eq!(missing(&system, Purpose::Run).len(), 7);
    }

    #[test]
    fn elsewhere_only_the_toolchain_is_ours_to_complete() {
        for platform in [Platform::MacOs, Platform::Windows, Platform::Other] {
            let mut system = bare(platform);
            assert!(missing(&system, Purpose::Test).is_empty());
            system.cargo_tools.clear();
            assert_eq!(components(&missing(&system, Purpose::Test)), ["rustfmt", "clippy"]);
            assert!(missing(&system, Purpose::Run).is_empty());
        }
    }

    #[test]
    fn any_of_the_compilers_will_do() {
        for compiler in ["cc", "gcc", "clang"] {
            check(&System { programs: [compiler.to_owned()].into(), ..ready() }, Purpose::Run, "");
        }
    }

    #[test]
    fn what_is_looked_for_covers_the_table() {
        assert_eq!(looked_for(Purpose::Run), (vec!["cc", "gcc", "clang"], vec![]));
        let (programs, tools) = looked_for(Purpose::Test);
        assert_eq!(programs, ["cc", "gcc", "clang", "Xvfb", "spirv-val"]);
        assert_eq!(tools, ["fmt", "clippy"]);
    }
}
