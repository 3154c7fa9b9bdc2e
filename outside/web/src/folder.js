// The files of this tab: those that a person chose, and those that commands wrote.

/** A folder alone is the place where commands run. */
function inside(entries) {
  const [first] = entries[0]?.[0].split("/") ?? [];
  const isAlone = entries.length > 0 && entries.every(([path]) => path.startsWith(`${first}/`));
  return isAlone ? entries.map(([path, file]) => [path.slice(first.length + 1), file]) : entries;
}

/** Files of a drop, those of folders with their paths. */
export async function dropped(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return [...transfer.files].map((file) => [file.name, file]);
  const found = [];
  for (const entry of entries) await walk(entry, found);
  return inside(found);
}

async function walk(entry, found) {
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
    found.push([entry.fullPath.replace(/^\//, ""), file]);
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    // a reader gives a hundred at a time
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return;
    for (const below of some) await walk(below, found);
  }
}

/** Files of an input element, those of a folder with their paths. */
export function chosen(input) {
  return inside([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));
}

export function size(bytes) {
  const units = ["B", "kB", "MB", "GB"];
  let unit = 0;
  let value = bytes;
  while (value >= 1000 && unit + 1 < units.length) {
    value /= 1000;
    unit += 1;
  }
  return `${unit === 0 || value >= 100 ? Math.round(value) : value.toFixed(1)} ${units[unit]}`;
}
