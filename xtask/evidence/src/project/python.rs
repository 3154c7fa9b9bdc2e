//! The Python package: its wheel built in a virtual environment below `target/`, its tests, its fleet example.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};
use xtask_output::{Output, Progress, said};

/// What the environment needs besides the wheel, with the versions that were tried.
const PACKAGES: &str = "maturin>=1.9,<2 numpy>=1.24 pytest>=8 mypy>=1.10 dask[bag]>=2024.1 distributed>=2024.1 \
    pandas>=2 polars>=1 pyarrow>=15 matplotlib>=3.8 nbclient>=0.10 ipykernel>=6 ray>=2.9";

/// Oldest Python that the wheel is for.
const OLDEST: (u32, u32) = (3, 10);

/// Devices of the fleet example.
const DEVICES: &str = "1000";

/// Writes the section; where there is no Python it says so on the terminal and writes none.
pub(crate) fn section(output: &mut Output, root: &Path) -> Result<()> {
    let Some(python) = python() else {
        let (major, minor) = OLDEST;
        output.terminal(format!(
            "Python package: not run: no Python {major}.{minor} or later with venv"
        ));
        return Ok(());
    };
    let progress = Progress::new("python", 6);
    let target = root.join("target").join("python");
    let environment = target.join("environment");
    said(Command::new(python).args(["-m", "venv"]).arg(&environment))?;
    let inside = environment_python(&environment);
    let pip = "-m pip install --quiet --disable-pip-version-check".split(' ');
    said(
        Command::new(&inside)
            .args(pip.clone())
            .args(PACKAGES.split(' ')),
    )?;
    progress.step();
    let wheel = wheel(root, &target, &inside)?;
    said(
        Command::new(&inside)
            .args(pip)
            .args(["--force-reinstall", "--no-deps"])
            .arg(&wheel),
    )?;
    progress.step();
    let command = xtask_output::built_command(root)?;
    progress.step();
    let package = root.join("outside").join("python");
    let tests = said(
        Command::new(&inside)
            .current_dir(&package)
            .env("HAPTICAL_COMMAND", &command)
            .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]),
    )?;
    progress.step();
    let fleet = said(
        Command::new(&inside)
            .arg(package.join("examples").join("fleet.py"))
            .args(["--devices", DEVICES]),
    )?;
    progress.step();
    let notebook =
        said(Command::new(&inside).arg(package.join("examples").join("run_notebook.py")))?;
    progress.step();
    drop(progress);
    describe(output, &wheel, (&tests, &fleet, &notebook));
    Ok(())
}

/// Largest wheel that counts as small \[bytes\].
const LARGEST_WHEEL: u64 = 10_000_000;

fn describe(output: &mut Output, wheel: &Path, (tests, fleet, notebook): (&str, &str, &str)) {
    let name = wheel.file_name().unwrap_or_default().to_string_lossy();
    let is_abi3 = name.contains("-abi3-");
    let summary = tests.lines().last().unwrap_or_default();
    let identified = format!("{DEVICES} of {DEVICES} devices identified");
    output.section("Python package");
    output.words(
        "`outside/python` as a wheel, built by maturin in a virtual environment below `target/python`. Its tests \
         compare forward kinematics with closed forms and a product of matrices, and identification, diagnosis and plans \
         with the command's JSON on the same input, number by number.",
    );
    output.verdict(is_abi3, "one wheel for every Python from 3.10 on (abi3)");
    output.verdict(
        summary.contains(" passed") && !summary.contains("failed") && !summary.contains("skipped"),
        "`pytest`: every test passed, none was skipped",
    );
    let text = format!("`examples/fleet.py --devices {DEVICES}`: Dask identified every device");
    output.verdict(fleet.contains(&identified), text);
    let bytes = std::fs::metadata(wheel).map_or(u64::MAX, |wheel| wheel.len());
    output.verdict(bytes <= LARGEST_WHEEL, "the wheel has at most 10 MB");
    match notebook.starts_with("skipped") {
        true => output.terminal(format!("notebook: {notebook}")),
        false => output.verdict(
            notebook.contains("cells ran"),
            "`examples/from-log-to-robot.ipynb`: every cell ran",
        ),
    }
    // times and counts are this run's: not for the document
    output.terminal(format!(
        "     {name}, {bytes} bytes\n     {summary}\n{fleet}{notebook}"
    ));
}

/// Builds the wheel; returns where it is.
fn wheel(root: &Path, target: &Path, inside: &Path) -> Result<PathBuf> {
    let wheels = target.join("wheels");
    // an older wheel of another version must not be taken for this one
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels)?;
    }
    said(
        Command::new(inside)
            .current_dir(root.join("outside").join("python"))
            .env("CARGO_TARGET_DIR", target.canonicalize()?.join("build"))
            .args(["-m", "maturin", "build", "--release", "--locked"])
            .args(["--quiet", "--out"])
            .arg(target.canonicalize()?.join("wheels")),
    )?;
    let mut found = std::fs::read_dir(&wheels)?.collect::<std::io::Result<Vec<_>>>()?;
    match (found.pop(), found.pop()) {
        (Some(wheel), None) => Ok(wheel.path()),
        _ => bail!(
            "maturin wrote no wheel, or several, into {}",
            wheels.display()
        ),
    }
}

/// A Python that is new enough and can make virtual environments.
fn python() -> Option<&'static str> {
    let (major, minor) = OLDEST;
    let asks =
        format!("import sys, venv, ensurepip; sys.exit(sys.version_info < ({major}, {minor}))");
    ["python3", "python"].into_iter().find(|python| {
        let done = Command::new(python).args(["-c", &asks]).output();
        done.is_ok_and(|done| done.status.success())
    })
}

fn environment_python(environment: &Path) -> PathBuf {
    if cfg!(windows) {
        environment.join("Scripts").join("python.exe")
    } else {
        environment.join("bin").join("python")
    }
}
