"""The program in README.md runs as it stands there."""

import pathlib
import re

README = pathlib.Path(__file__).resolve().parents[1] / "README.md"


def test_the_program_of_the_readme_runs(capsys):
    programs = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert len(programs) == 1
    exec(compile(programs[0], str(README), "exec"), {})
    verdict, *parameters = capsys.readouterr().out.splitlines()
    assert verdict in {"no-gap", "named", "ambiguous", "unknown"}
    statuses = {line.split()[1] for line in parameters}
    assert "identifiable" in statuses and statuses <= {"identifiable", "combination", "weak", "dependent", "invisible", "held"}
