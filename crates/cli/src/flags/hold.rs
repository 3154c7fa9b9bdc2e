//! `--hold` and `--deviation`: how far numbers of links may be from the device file's.

use clap::Args;
use haptical::files::shell_word;

use crate::arguments::above_zero;

/// Numbers that are kept, in addition to the device file's own `hold`.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct HoldOptions {
    /// Keep these numbers of the links: lengths, twists, offsets, or a, b, d, alpha, theta, beta of all rows but the
    /// base's; or one row's, such as a3
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub(crate) hold: Vec<String>,
    /// How far such numbers may plausibly be off, in m or rad, as in offsets=0.06; 5 mm and 0.02 rad unless stated. What
    /// the log fixes no better than to half of this is kept
    #[arg(long, value_name = "NUMBERS=SIZE", value_delimiter = ',', value_parser = deviation)]
    pub(crate) deviation: Vec<(String, f64)>,
}

impl HoldOptions {
    /// The flags as one would type them, a blank before each.
    pub(crate) fn typed(&self) -> String {
        let flag = |name: &str, words: &[String]| match words.is_empty() {
            true => String::new(),
            false => format!(" --{name} {}", shell_word(&words.join(","))),
        };
        let sizes = self.deviation.iter();
        let sizes: Vec<String> = sizes.map(|(word, size)| format!("{word}={size}")).collect();
        flag("hold", &self.hold) + &flag("deviation", &sizes)
    }
}

fn deviation(text: &str) -> Result<(String, f64), String> {
    let wanted = "as in offsets=0.06, the size in m or rad and above 0";
    let (word, size) = text.split_once('=').ok_or(wanted)?;
    Ok((word.to_owned(), above_zero(size).map_err(|_| wanted)?))
}
