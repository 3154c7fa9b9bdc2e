//! Runs identify and diagnose on every measured set that is there, and `identify --with dynamics` on recordings of moving arms, and writes
//! the tables of docs/real-arms.md.

mod dynamics;
mod page;
mod sets;

use std::path::{Path, PathBuf};

use anyhow::Result;
use xtask_output::{built_command, put_between};

use sets::{HERE, Sets};

const PAGE: &str = "docs/real-arms.md";
/// Lines between which the table is.
const BEGIN: &str = "<!-- table: cargo xtask real-arms -->\n";
const END: &str = "<!-- end of table -->\n";

/// Arguments of `real-arms`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask real-arms --fetched ../fetched")]
pub(crate) struct Arguments {
    /// Folder with the folder `measured` of public data.
    #[arg(long, default_value = "../shared")]
    shared: PathBuf,
    /// Folder of converted data that are fetched and not handed on (docs/real-arms.md, Data).
    #[arg(long, default_value = "../fetched")]
    fetched: PathBuf,
    /// Only sets whose name contains this; the page is not written.
    #[arg(long)]
    only: Option<String>,
    /// Folder for the results.
    #[arg(long, default_value = "target/real-arms")]
    out: PathBuf,
}

impl Arguments {
    /// A path or a flag with the folders in it.
    fn place(&self, text: &str) -> String {
        text.replace("{shared}", &self.shared.to_string_lossy())
            .replace("{fetched}", &self.fetched.to_string_lossy())
            .replace("{here}", HERE)
    }

    /// Whether a name is asked for.
    fn wants(&self, name: &str) -> bool {
        self.only.as_deref().is_none_or(|only| name.contains(only))
    }
}

/// Runs the job.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let sets = Sets::load()?;
    let program = built_command(Path::new("."))?;
    let (mut table, mut remarks) = (page::HEAD.to_owned(), String::new());
    for set in sets.set.iter().filter(|set| arguments.wants(&set.name)) {
        let line = match set.answers(&program, arguments)? {
            Ok(answers) => page::line(set, &answers),
            Err(missing) => {
                println!("{}: not run, no {}", set.name, missing.display());
                page::absent(set)
            }
        };
        print!("{line}");
        table.push_str(&line);
        remarks.push_str(&format!(
            "- **{}** ({}). {}\n",
            set.name, set.source, set.remark
        ));
    }
    let of_dynamics = dynamics::table(&program, arguments)?;
    if arguments.only.is_none() {
        let page = Path::new(PAGE);
        put_between(page, [dynamics::BEGIN, dynamics::END], &of_dynamics)?;
        put_between(page, [BEGIN, END], &format!("{table}\n{remarks}"))?;
    }
    Ok(())
}
