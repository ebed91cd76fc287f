# SPDX-License-Identifier: GPL-3.0-or-later
"""The words and numbers of an NFF file, as columns: what a record means is `nff.py`'s affair.

Every record is one keyword and the numbers after it, over as many lines as it likes. So the file is a list of
keywords and one flat array of numbers, which numpy can take apart a kind of record at a time: no object is
made per record. A line is looked for only when there is something wrong with it.
"""

import re
from pathlib import Path

import numpy as np

from .errors import SceneError

#: What follows each keyword. Polygons (p, pp) give their number of vertices first.
FIELDS = {
    "b": "r g b",
    "v": "",
    "from": "x y z",
    "at": "x y z",
    "up": "x y z",
    "angle": "degrees",
    "hither": "distance",
    "resolution": "width height",
    "l": "x y z [r g b]",
    "f": "r g b Kd Ks Shine T ior",
    "s": "x y z radius",
    "c": "x y z radius x y z radius",
    "p": "x y z",
    "pp": "x y z nx ny nz",
}
RECORDS = ("b", "v", "l", "f", "s", "c", "p", "pp")
VIEW_FIELDS = ("from", "at", "up", "angle", "hither", "resolution")
KIND = {keyword: number for number, keyword in enumerate(FIELDS)}
_KIND_OF_BYTES = {keyword.encode(): number for keyword, number in KIND.items()}
_POLYGON = {"p": 3, "pp": 6}  # numbers per vertex

#: Single precision squares nothing larger, and nothing smaller without losing digits.
LARGEST = 1e18
SMALLEST = 1e-18

_CHUNK = 1 << 24  # bytes taken apart at once: bounds the memory of the words, which is ten times that of the numbers
_COMMENT = re.compile(rb"#[^\r\n]*")


class NffError(SceneError):
    """Something is wrong in an NFF file; the message is `file:line: what is wrong, what was expected`."""


class _Source:
    """The text of a file, read once: a pipe can be read no second time to find the line of an error."""

    def __init__(self, path):
        self._path = path
        try:
            data = Path(path).read_bytes()
        except OSError as error:
            raise SceneError(f"{path}: cannot be read: {error.strerror or error}") from None
        if b"\0" in data:
            raise NffError(f"{path}:1: this is no text but binary data, expected an NFF scene")
        self.data = data.removeprefix(b"\xef\xbb\xbf")  # the mark that some editors put before UTF-8

    def locate(self, index):
        """Line number of the word number `index`, and the word as a message shows it."""
        passed = 0
        for line, text in enumerate(_COMMENT.sub(b"", self.data).splitlines(), 1):
            words = text.split()
            if index < passed + len(words):
                return line, _quoted(words[index - passed])
            passed += len(words)
        raise IndexError(index)

    def error(self, index, message):
        """An NffError at the line of the word number `index`; `message` may say {word}."""
        line, word = self.locate(index)
        return NffError(f"{self._path}:{line}: {message.replace('{word}', word)}")

    def error_at_end(self, message):
        return NffError(f"{self._path}:{max(len(self.data.splitlines()), 1)}: {message}")


class Records:
    """The records of a file in order: `kind` (n,) int, index into FIELDS, and the flat `numbers` (m,)
    float64.

    `start` (n + 1,): where the numbers of each record begin; they end where the next record's begin.
    """

    def __init__(self, source, kind, start, numbers):
        self._source, self.kind, self.start, self.numbers = source, kind, start, numbers

    def __len__(self):
        return len(self.kind)

    def rows(self, keyword):
        """Which records begin with `keyword`: (k,) int, in the order of the file."""
        return np.flatnonzero(self.kind == KIND[keyword])

    def columns(self, rows, count, first=0):
        """The numbers `first` to `first + count` of each of `rows`: (k, count)."""
        return self.numbers[self.start[rows][:, None] + np.arange(first, first + count)]

    def counts(self, rows):
        """How many numbers each of `rows` has: (k,) int."""
        return self.start[rows + 1] - self.start[rows]

    def error(self, row, message):
        """An NffError at the line where record `row` begins; after the last record at the file's end."""
        if row == len(self):
            return self._source.error_at_end(message)
        return self._source.error(self.start[row] + row, message)

    def refuse(self, bad, rows, message):
        """Raise an NffError for the first of `rows` where `bad` (k,) bool; `message` may be a function of its
        place in rows."""
        if bad.any():
            first = int(np.argmax(bad))
            raise self.error(rows[first], message(first) if callable(message) else message)

    def _number_error(self, index):
        row = int(np.searchsorted(self.start, index, side="right")) - 1
        return self._source.error(
            index + row + 1, f"the number {{word}} is not finite, or larger than {LARGEST:g} in size"
        )


def read_records(path):
    """The `Records` of an NFF file. Raises NffError where a word, a record's length or a number is wrong."""
    source = _Source(path)
    kinds, marks, numbers, words = [], [], [], 0
    for text in _chunks(source.data):
        tokens = text.split()
        chunk_marks = [i for i, token in enumerate(tokens) if token in _KIND_OF_BYTES]
        kinds.append(np.fromiter((_KIND_OF_BYTES[tokens[i]] for i in chunk_marks), np.int8, len(chunk_marks)))
        marks.append(np.array(chunk_marks, np.int64) + words)
        for i in chunk_marks:
            tokens[i] = b"0"
        numbers.append(np.delete(_to_floats(source, tokens, words, b"_" in text), chunk_marks))
        words += len(tokens)
    if not words:
        raise source.error_at_end(f"the file is empty, expected an NFF scene (records {' '.join(RECORDS)})")
    mark = np.concatenate(marks)
    if not len(mark) or mark[0] != 0:
        raise source.error(0, f"the file begins with {{word}}, expected a record: {' '.join(RECORDS)}")
    start = np.append(mark, words) - np.arange(len(mark) + 1)
    records = Records(source, np.concatenate(kinds), start, np.concatenate(numbers))
    _check_numbers(records)
    _check_counts(records)
    return records


def _chunks(data):
    """Pieces of the text that end with a line, without comments."""
    begin = 0
    while begin < len(data):
        end = data.find(b"\n", begin + _CHUNK) + 1 or len(data)
        yield _COMMENT.sub(b"", data[begin:end])
        begin = end


def _to_floats(source, tokens, words, suspicious):
    """The tokens' values (n,); `words` stand before them. Python reads 1_0 as 10: where `suspicious`, that is
    looked for."""
    try:
        if suspicious:
            raise ValueError
        return np.fromiter(map(float, tokens), np.float64, len(tokens))
    except ValueError:
        bad = next((i for i, token in enumerate(tokens) if not _is_number(token)), None)
        if bad is None:
            raise
    if re.match(rb"[-+.\d]", tokens[bad]):
        raise source.error(words + bad, "{word} is not a number")
    raise source.error(words + bad, f"unknown record {{word}}, expected one of {' '.join(RECORDS)} or a number")


def _is_number(token):
    try:
        float(token)
    except ValueError:
        return False
    return b"_" not in token


def _check_numbers(records):
    bad = ~(np.abs(records.numbers) <= LARGEST)  # written so that NaN is bad
    if bad.any():
        raise records._number_error(int(np.argmax(bad)))


def _check_counts(records):
    """Each record has as many numbers as its kind wants."""
    found = np.diff(records.start)
    wanted = np.array([len(fields.split()) for fields in FIELDS.values()])[records.kind]
    wanted[records.kind == KIND["l"]] = 3
    with_color = (records.kind == KIND["l"]) & (found > 3)
    wanted[with_color] = 6
    for keyword, width in _POLYGON.items():
        rows = records.rows(keyword)
        told = np.zeros(len(rows))
        told[found[rows] > 0] = records.numbers[records.start[rows[found[rows] > 0]]]
        wanted[rows] = 1
        records.refuse(
            (told != np.floor(told)) | (told < 3.0) & (found[rows] > 0),
            rows,
            lambda i, told=told, keyword=keyword: (
                f"{keyword!r} is to have {told[i]:g} vertices, expected a whole number from 3 up"
            ),
        )
        wanted[rows] += (width * np.maximum(told, 3.0)).astype(np.int64)
    wrong = np.flatnonzero(found != wanted)
    if len(wrong):
        raise records.error(int(wrong[0]), _count_message(records, int(wrong[0]), found, wanted))


def _count_message(records, row, found, wanted):
    keyword = list(FIELDS)[records.kind[row]]
    fields = FIELDS[keyword]
    if keyword in _POLYGON:
        what = f"{wanted[row]} (the number of vertices, then {fields} of each)"
    elif keyword == "l":
        what = f"3 or 6 ({fields})"
    else:
        what = f"{wanted[row]}{f' ({fields})' if fields else ''}"
    if found[row] < wanted[row] and row == len(records) - 1:
        return f"the file ends within this {keyword!r}: it has {found[row]} numbers, expected {what}"
    return f"{keyword!r} has {found[row]} numbers, expected {what}"


def _quoted(word):
    """A word as a message can show it: printable and not too long."""
    text = word.decode("utf-8", "replace")
    return repr(text if len(text) <= 40 else text[:37] + "...")
