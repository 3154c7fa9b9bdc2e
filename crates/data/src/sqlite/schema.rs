//! Columns of a table by the statement that made it.

/// Words that begin what is no column.
const CONSTRAINTS: [&str; 5] = ["CONSTRAINT", "PRIMARY", "UNIQUE", "CHECK", "FOREIGN"];

/// Names of the columns, and which of them is the row's number: an `INTEGER PRIMARY KEY` (sqlite.org/rowidtable.html). None of a statement
/// without columns, and of a table without such numbers.
pub(super) fn columns(sql: &str) -> Option<(Vec<String>, Option<usize>)> {
    let parts = parts(sql)?;
    let (mut names, mut row_id) = (Vec::new(), None);
    for part in parts {
        let (name, rest) = name(part.trim())?;
        let is_plain = part
            .trim_start()
            .starts_with(|first: char| first.is_alphanumeric());
        if is_plain && CONSTRAINTS.iter().any(|own| name.eq_ignore_ascii_case(own)) {
            continue;
        }
        let words: Vec<String> = rest.split_whitespace().map(str::to_uppercase).collect();
        let is_key = words.windows(2).any(|pair| pair == ["PRIMARY", "KEY"]);
        if is_key && words.first().is_some_and(|kind| kind == "INTEGER") {
            row_id = Some(names.len());
        }
        names.push(name);
    }
    Some((names, row_id))
}

/// What is between the commas of the first parentheses.
fn parts(sql: &str) -> Option<Vec<&str>> {
    let open = sql.find('(')? + 1;
    let (mut depth, mut quote, mut from) = (1, None, open);
    let mut found = Vec::new();
    for (at, sign) in sql[open..]
        .char_indices()
        .map(|(at, sign)| (at + open, sign))
    {
        match (quote, sign) {
            (Some(end), sign) => quote = Some(end).filter(|end| *end != sign),
            (None, '"' | '\'' | '`') => quote = Some(sign),
            (None, '[') => quote = Some(']'),
            (None, '(') => depth += 1,
            (None, ')') => depth -= 1,
            _ => {}
        }
        let ends = depth == 0 || (depth == 1 && sign == ',' && quote.is_none());
        if ends {
            found.push(&sql[from..at]);
            from = at + 1;
        }
        if depth == 0 {
            let rest = sql[from..].to_uppercase();
            return (!rest.contains("WITHOUT")).then_some(found);
        }
    }
    None
}

/// A name, which may be in quotes, and what follows it.
fn name(part: &str) -> Option<(String, &str)> {
    let first = part.chars().next()?;
    let end = match first {
        '"' | '\'' | '`' => first,
        '[' => ']',
        _ => {
            let end = part.find(|sign: char| sign.is_whitespace() || sign == '(');
            let (name, rest) = part.split_at(end.unwrap_or(part.len()));
            return Some((name.to_owned(), rest));
        }
    };
    let (name, rest) = part[first.len_utf8()..].split_once(end)?;
    Some((name.to_owned(), rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_the_statement() {
        let found = |sql| columns(sql).map(|(names, row_id)| (names.join(" "), row_id));
        let topics = "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL, type TEXT)";
        assert_eq!(found(topics), Some(("id name type".to_owned(), Some(0))));
        let other = "CREATE TABLE m ([a, b] decimal(4, 2) DEFAULT ')', `c` int primary key, PRIMARY KEY (c))";
        assert_eq!(found(other), Some(("a, b c".to_owned(), None)));
        assert_eq!(
            found("CREATE TABLE m (a INTEGER PRIMARY KEY) WITHOUT ROWID"),
            None
        );
        assert_eq!(found("CREATE TABLE m (a"), None);
    }
}
