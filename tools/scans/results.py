"""Tables of runs: a CSV file that goes on where it was left, and Markdown."""
import csv
import os
import pathlib


class Rows:
    """The rows of a CSV file, by their first column. Rows that are there are kept."""

    def __init__(self, file, columns):
        self.file, self.columns, self.rows = pathlib.Path(file), list(columns), {}
        if self.file.exists():
            with open(self.file, newline="", encoding="utf8") as f:
                for row in csv.DictReader(f):
                    self.rows[row[self.columns[0]]] = {k: row.get(k) or "" for k in self.columns}

    def __contains__(self, key):
        return key in self.rows

    def __iter__(self):
        return iter(self.rows.values())

    def add(self, row):
        """Writes all rows anew beside the file and renames: a run that is killed leaves whole tables."""
        self.rows[row[self.columns[0]]] = {k: str(row.get(k, "")) for k in self.columns}
        self.file.parent.mkdir(parents=True, exist_ok=True)
        new = self.file.with_suffix(".new")
        with open(new, "w", newline="", encoding="utf8") as f:
            writer = csv.DictWriter(f, self.columns)
            writer.writeheader()
            writer.writerows(self.rows.values())
        os.replace(new, self.file)

    def markdown(self):
        lines = ["| " + " | ".join(self.columns) + " |", "|" + "---|" * len(self.columns)]
        for row in self:
            lines.append("| " + " | ".join(row[k].replace("|", "/") or "-" for k in self.columns) + " |")
        return "\n".join(lines) + "\n"


def shown(value, form=""):
    """A number for a cell; empty where there is none."""
    return "" if value is None or value != value else format(value, form)
