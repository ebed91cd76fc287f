"""Results as text that is read in a terminal and as Markdown."""


class Table:
    """Rows of cells under a head; numbers are given as text already. The first column is of names."""

    def __init__(self, title, head):
        self.title, self.head, self.rows, self.notes = title, [*map(str, head)], [], []

    def add(self, *cells):
        """Raises ValueError where there are more or fewer cells than columns."""
        if len(cells) != len(self.head):
            raise ValueError(f"{len(cells)} cells for {len(self.head)} columns of {self.title!r}")
        self.rows.append([*map(str, cells)])

    def text(self):
        widths = [max(map(len, column)) for column in zip(self.head, *self.rows, strict=True)]
        lines = [self.title]
        for row in (self.head, *self.rows):
            cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
            lines.append("  ".join(cells).rstrip())
        return "\n".join([*lines, *(f"- {note}" for note in self.notes)])

    def markdown(self):
        rule = ["---"] + ["---:"] * (len(self.head) - 1)
        lines = [f"**{self.title}**", ""]
        lines += [
            "| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in (self.head, rule, *self.rows)
        ]
        return "\n".join([*lines, *([""] if self.notes else []), *(f"- {note}" for note in self.notes)])


def digits(value, count=3):
    """A positive number with so many digits that count, without an exponent."""
    if value == 0:
        return "0"
    whole = len(str(int(abs(value)))) if abs(value) >= 1 else 0
    if whole:
        return f"{value:.{max(count - whole, 0)}f}"
    return f"{value:.{count}g}" if abs(value) >= 1e-4 else f"{value:.1e}"
