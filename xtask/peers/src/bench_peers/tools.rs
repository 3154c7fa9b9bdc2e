//! Finds and builds the peers that this machine has; of the others it says what to install.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use xtask_output::said;

use super::peer::Program;

/// A peer that can be started, or why not and what to do about it.
pub(crate) type Found = Result<Program, String>;

/// Optimisation of the C++ peers: the processor that the bars speak of, so that both sides have AVX2.
const OPTIMISED: [&str; 4] = ["-std=c++17", "-O3", "-march=x86-64-v3", "-DNDEBUG"];
/// What Pinocchio's own CMake file defines for users of its headers.
const FOR_PINOCCHIO: [&str; 4] = [
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];
/// Where Debian has Eigen, if pkg-config is not there to say it.
const EIGEN: &str = "/usr/include/eigen3";

/// Builds below one folder.
#[derive(Debug)]
pub(crate) struct Tools {
    folder: PathBuf,
    /// Whether Python packages may be installed below the folder.
    install: bool,
    compiler: String,
}

pub(crate) fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn runs(program: impl AsRef<OsStr>, arguments: &[&str]) -> Option<String> {
    said(Command::new(program).args(arguments).stdin(Stdio::null())).ok()
}

impl Tools {
    pub(crate) fn new(folder: &Path, install: bool) -> Result<Self> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        Ok(Self {
            folder: folder.canonicalize()?,
            install,
            compiler: std::env::var("CXX").unwrap_or_else(|_| "g++".to_owned()),
        })
    }

    pub(crate) fn ceres(&self) -> Found {
        const ADVICE: &str = "apt-get install libceres-dev g++";
        let flags = eigen();
        self.needs(&flags, "ceres/ceres.h", ADVICE)?;
        self.build("ceres_distance", &flags, &["-lceres", "-lglog"])
    }

    /// Pinocchio from PyPI, from its headers alone: the library that comes with them is built for any
    /// x86-64, and its types have another layout than with AVX.
    pub(crate) fn pinocchio(&self) -> Found {
        const ADVICE: &str = "apt-get install g++ libeigen3-dev, and python3 -m pip install pin";
        let mut flags = eigen();
        if let Ok(python) = self.python("pinocchio", &["pin"]) {
            let where_from = "import sysconfig; print(sysconfig.get_paths()['purelib'])";
            if let Some(packages) = runs(&python, &["-c", where_from]) {
                flags.push(format!("-isystem{packages}/cmeel.prefix/include"));
            }
        }
        flags.extend(FOR_PINOCCHIO.map(str::to_owned));
        self.needs(&flags, "pinocchio/algorithm/jacobian.hpp", ADVICE)?;
        self.build("pinocchio_kinematics", &flags, &[])
    }

    /// SciPy from PyPI, or the system's.
    pub(crate) fn scipy(&self) -> Found {
        let path = self.python("scipy", &["numpy", "scipy"])?;
        let built = runs(&path, &["--version"]).unwrap_or_default();
        Ok(Program {
            path,
            arguments: vec![source("scipy_distance.py")],
            built,
        })
    }

    /// A Python that can import `module`: the scratch environment's, after an attempt to install
    /// `packages` there, else the system's.
    pub(crate) fn python(&self, module: &str, packages: &[&str]) -> Result<PathBuf, String> {
        let environment = self.folder.join("python");
        let scratch = environment.join("bin").join("python");
        let import = format!("import {module}");
        let imports = |python: &Path| runs(python, &["-c", &import]).is_some();
        if imports(&scratch) {
            return Ok(scratch);
        }
        let system = PathBuf::from("python3");
        if runs(&system, &["--version"]).is_none() {
            return Err("python3 is not there: apt-get install python3-venv".to_owned());
        }
        if self.install {
            println!(
                "installing {} into {}",
                packages.join(", "),
                environment.display()
            );
            let folder = environment.to_string_lossy();
            if !scratch.exists() {
                let _ = runs(&system, &["-m", "venv", &folder]);
            }
            let mut arguments = vec!["-m", "pip", "install", "--quiet"];
            arguments.extend(packages);
            let _ = runs(&scratch, &arguments);
            if imports(&scratch) {
                return Ok(scratch);
            }
        }
        if imports(&system) {
            return Ok(system);
        }
        let packages = packages.join(" ");
        Err(format!(
            "no Python here imports {module} and none could be installed: python3 -m pip install {packages}"
        ))
    }

    /// Says what to install where the compiler does not find a header.
    fn needs(&self, flags: &[String], header: &str, advice: &str) -> Result<(), String> {
        let found = || -> std::io::Result<bool> {
            let mut child = Command::new(&self.compiler)
                .args(["-M", "-x", "c++"])
                .args(OPTIMISED)
                .args(flags)
                .arg("-")
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()?;
            if let Some(mut input) = child.stdin.take() {
                writeln!(input, "#include <{header}>")?;
            }
            Ok(child.wait()?.success())
        };
        match found() {
            Ok(true) => Ok(()),
            Ok(false) => Err(format!("{} finds no <{header}>: {advice}", self.compiler)),
            Err(_) => Err(format!("{} is not there: {advice}", self.compiler)),
        }
    }

    /// Compiles a peer unless the program there is of the same source and command.
    fn build(&self, name: &str, flags: &[String], libraries: &[&str]) -> Found {
        let source = source(&format!("{name}.cpp"));
        let path = self.folder.join(name);
        let stamp = path.with_extension("built");
        let mut command = Command::new(&self.compiler);
        command.args(OPTIMISED).args(flags).arg(&source);
        command.arg("-o").arg(&path).args(libraries);
        let text = std::fs::read_to_string(&source).map_err(|error| format!("{error}"))?;
        let version = runs(&self.compiler, &["--version"]).unwrap_or_default();
        let made_by = format!("{version}\n{command:?}\n{text}");
        let first = version.lines().next().unwrap_or(&self.compiler);
        let program = Program {
            path: path.clone(),
            arguments: Vec::new(),
            built: format!("{first} {}", OPTIMISED.join(" ")),
        };
        if path.exists() && std::fs::read_to_string(&stamp).is_ok_and(|before| before == made_by) {
            return Ok(program);
        }
        println!("compiling {name}.cpp");
        let output = command
            .output()
            .map_err(|error| format!("{}: {error}", self.compiler))?;
        if !output.status.success() {
            let messages = String::from_utf8_lossy(&output.stderr);
            let first = messages.lines().find(|line| line.contains("error"));
            let first = first.unwrap_or("does not compile");
            return Err(format!("{name}.cpp: {first}"));
        }
        // without the stamp it is built again next time
        let _ = std::fs::write(&stamp, made_by);
        Ok(program)
    }
}

fn eigen() -> Vec<String> {
    let said = runs("pkg-config", &["--cflags-only-I", "eigen3"]);
    let said = said.filter(|flags| !flags.is_empty());
    let flags = said.unwrap_or_else(|| format!("-I{EIGEN}"));
    flags.split_whitespace().map(str::to_owned).collect()
}
