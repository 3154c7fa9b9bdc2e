//! What was not identified, in lines.

use crate::identify::result::NotIdentified;
use crate::lines::labelled;

/// Numbers of a status that have a line each; of more their names are in one sentence.
const FEW: usize = 6;
/// Width of the status before a reason.
const INDENT: usize = 13;

/// Lines of what kept its value: one each, but a sentence for many of one status, where the first of them stands.
pub(crate) fn lines(refused: &[NotIdentified]) -> String {
    let mut told: Vec<&str> = Vec::new();
    let mut text = String::new();
    for entry in refused {
        let alike = refused.iter().filter(|other| other.status == entry.status);
        let alike: Vec<&NotIdentified> = alike.collect();
        let label = format!("  {}", entry.status);
        if alike.len() <= FEW {
            text += &labelled(&label, &entry.reason, INDENT);
        } else if !told.contains(&entry.status) {
            told.push(entry.status);
            text += &labelled(&label, &together(entry.status, &alike), INDENT);
        }
    }
    text
}

/// Several numbers in a sentence.
fn together(status: &str, own: &[&NotIdentified]) -> String {
    let names: Vec<&str> = own.iter().map(|entry| entry.name.as_str()).collect();
    let meaning = match status {
        "dependent" => " act like combinations of others, which stand for them".to_owned(),
        "weak" => " are fixed no better than to half of what is plausible".to_owned(),
        _ => {
            // what is said of each of them alike
            let said =
                |entry: &&NotIdentified| entry.reason.strip_prefix(&entry.name).map(str::to_owned);
            let mut all = own.iter().map(said);
            match all.next().flatten() {
                Some(first) if all.all(|other| other.as_deref() == Some(&first)) => plural(&first),
                _ => " keep their values".to_owned(),
            }
        }
    };
    format!("{} numbers{meaning}: {}", own.len(), names.join(", "))
}

/// What is said of one number, of several.
fn plural(said: &str) -> String {
    let (one, several) = [(" is ", " are "), (" has ", " have ")]
        .into_iter()
        .find(|(one, _)| said.starts_with(one))
        .unwrap_or(("", ", each"));
    several.trim_end().to_owned() + &said[one.trim_end().len()..]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &str, status: &'static str, why: &str) -> NotIdentified {
        NotIdentified {
            name: name.to_owned(),
            status,
            reason: format!("{name} {why}"),
        }
    }

    #[test]
    fn many_numbers_are_one_sentence_and_few_have_their_own() {
        let mut refused: Vec<NotIdentified> = (0..24)
            .map(|row| {
                entry(
                    &format!("a{row}"),
                    "dependent",
                    &format!("acts like +{row}.0 b{row}"),
                )
            })
            .collect();
        refused.push(entry(
            "alpha7",
            "invisible",
            "has no effect on any measurement",
        ));
        refused.extend((0..8).map(|row| {
            entry(
                &format!("x{row}"),
                "held",
                "is held: the samples support a form without it",
            )
        }));
        let said = lines(&refused);
        let words: Vec<&str> = said.split_whitespace().collect();
        let words = words.join(" ");
        assert!(words.contains("dependent 24 numbers act like combinations of others, which stand for them: a0, a1, "), "{said}");
        assert!(
            words.contains("a23 invisible alpha7 has no effect on any measurement"),
            "{said}"
        );
        assert!(
            words.contains(
                "held 8 numbers are held: the samples support a form without it: x0, x1,"
            ),
            "{said}"
        );
        assert!(said.lines().count() <= 7, "{said}");
        let few = lines(&refused[22..25]);
        assert!(
            few.contains("  dependent  a22 acts like +22.0 b22\n  dependent  a23 acts"),
            "{few}"
        );
    }
}
