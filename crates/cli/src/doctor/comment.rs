//! The findings as Markdown, for the data set's page.

use super::{Examined, text, words};
use crate::failure::Failure;

pub(super) fn comment(examined: &Examined) -> Result<String, Failure> {
    let mut said = format!("**{}**\n\n", text::headline(examined));
    for table in [text::findings(examined)?, text::episodes(examined)?] {
        if !table.rows().is_empty() {
            said += &format!("{}\n", table.to_markdown().trim_start());
        }
    }
    said += "Not tested:\n\n";
    for words in words::not_tested(examined) {
        said += &format!("- {words}\n");
    }
    said += &format!(
        "\nFound by `haptical doctor` {}.\n",
        env!("CARGO_PKG_VERSION")
    );
    Ok(said)
}
