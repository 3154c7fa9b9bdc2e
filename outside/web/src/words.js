// Words of a command line as a POSIX shell splits them, without variables and patterns.

/** @throws {Error} where a quotation mark is not closed */
export function split(line) {
  const words = [];
  let word = null;
  let quote = null;
  for (let index = 0; index < line.length; index += 1) {
    const c = line[index];
    if (quote) {
      if (c === quote) quote = null;
      else if (c === "\\" && quote === '"' && '"\\$`'.includes(line[index + 1] ?? "")) word += line[(index += 1)];
      else word += c;
    } else if (c === "'" || c === '"') {
      quote = c;
      word ??= "";
    } else if (c === "\\" && index + 1 < line.length) {
      word = (word ?? "") + line[(index += 1)];
    } else if (/\s/.test(c)) {
      if (word !== null) words.push(word);
      word = null;
    } else {
      word = (word ?? "") + c;
    }
  }
  if (quote) throw new Error(`the quotation mark ${quote} is not closed`);
  if (word !== null) words.push(word);
  return words;
}

/** A word for a shell, quoted where it needs be. */
export function quoted(word) {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}
