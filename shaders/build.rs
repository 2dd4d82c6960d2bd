//! The package's build script: compiles each WGSL shader of this folder to SPIR-V.
//!
//! `view.wgsl` is not a shader but what the shaders of the world share; it is appended to each of them. WGSL does not
//! mind the order of declarations, so the shader's own line numbers stay true. A shader that does not compile stops the
//! build with its file, line and a caret.

use std::{env, fs, path::Path};

use naga::{
    back::spv,
    valid::{Capabilities, ValidationFlags, Validator},
};

/// What the shaders of the world share.
const SHARED: &str = "view.wgsl";

fn main() {
    let out = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR for build scripts");
    println!("cargo::rerun-if-changed=shaders");
    let shared = read(Path::new("shaders").join(SHARED).as_path());
    // Compiled alone first, so that a mistake in it is shown in its own file.
    let mut failures: Vec<String> = compile(&format!("shaders/{SHARED}"), &shared).err().into_iter().collect();
    for file in shader_files() {
        let name = file.file_name().and_then(|n| n.to_str()).expect("shader names are plain text").to_owned();
        if name == SHARED || !failures.is_empty() {
            continue;
        }
        let source = format!("{}\n{shared}", read(&file));
        match compile(&format!("shaders/{name}"), &source) {
            Ok(words) => {
                let bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
                let target = Path::new(&out).join(&name).with_extension("spv");
                fs::write(&target, bytes).unwrap_or_else(|e| panic!("{}: {e}", target.display()));
            }
            Err(text) => failures.push(text),
        }
    }
    if !failures.is_empty() {
        eprintln!("{}", failures.join("\n"));
        std::process::exit(1);
    }
}

/// The shader files in a fixed order.
fn shader_files() -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir("shaders").expect("the folder of this script is readable");
    let mut files: Vec<_> = entries.map(|e| e.expect("a readable entry").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "wgsl"));
    files.sort();
    files
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Compiles a module with all its entry points; the error is ready to print.
fn compile(path: &str, source: &str) -> Result<Vec<u32>, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string_with_path(source, path))?;
    // Immediates are Vulkan's push constants.
    let info = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES)
        .validate(&module)
        .map_err(|e| e.emit_to_string_with_path(source, path))?;
    let binding_map = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| variable.binding)
        .map(|at| {
            let place = spv::BindingInfo { descriptor_set: at.group, binding: at.binding, binding_array_size: None };
            (at, place)
        })
        .collect();
    let options = spv::Options {
        // What Vulkan 1.1 and later read; newer versions only lengthen the interface lists.
        lang_version: (1, 3),
        // The default flips y, but our projection matrices are Vulkan's own.
        flags: spv::WriterFlags::LABEL_VARYINGS,
        // The default invents a place for a binding that has none.
        fake_missing_bindings: false,
        // No shader here loops without a constant bound.
        force_loop_bounding: false,
        binding_map,
        ..spv::Options::default()
    };
    spv::write_vec(&module, &info, &options, None).map_err(|e| format!("{path}: {e}"))
}
